"""The report as a file: what is on it, and that it needs nothing from elsewhere."""

import base64
import html
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from slidepipe.errors import InputError, NotFoundError
from slidepipe.figures.report import render_report
from slidepipe.stages import report
from slidepipe.stages.report_scene import scene
from slidepipe.stages.report_trials import find_subject


@pytest.fixture(scope="module")
def text(regrasp_report) -> str:
    return regrasp_report.path.read_text()


def test_it_needs_nothing_from_elsewhere(text, regrasp_report):
    pictures = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', text)
    assert len(pictures) == len(re.findall(r"<img ", text)) == 4
    assert all(base64.b64decode(one).startswith(b"<?xml") for one in pictures)
    assert re.findall(r"(?:src|href)=\"(?!data:)[^\"]*\"", text) == []
    assert re.findall(r"https?://|@import|url\(", text) == []
    assert "default-src 'none'" in text
    assert regrasp_report.size == len(text.encode()) < 2_000_000


def test_every_trial_estimate_run_and_hash_is_on_it(text, regrasp):
    campaign, store, _ = regrasp
    told = html.unescape(text)
    for row in campaign.document.rows:
        assert f"<td>{row.runs.execute}</td>" in text
        assert f"{1e3 * row.error_m:.2f}</td><td>{1e3 * row.error_rad:.1f}" in text
    named = [campaign.run.id, *(run for row in campaign.document.rows for run in row.runs.model_dump().values())]
    for run in map(store.get, named):
        assert run.id in text
        assert run.manifest.recipe[:12] in text
        assert all(output.sha256 in text for output in run.manifest.outputs)
    mu = campaign.document.rows[0]
    assert f"{mu.estimated_friction:.4f} [{mu.estimated_friction_interval_95[0]:.4f}" in told
    assert text.index('id="warnings"') < text.index("<h2"), "warnings come first"


def test_the_measured_friction_is_the_limit_surface_while_it_slides(regrasp):
    for trial in find_subject(regrasp[1], "regrasp").trials[:1]:
        told = scene(trial)
        time_s, load = np.array(told.time_s), np.linalg.norm(np.array(told.friction) / told.semi_axes_n, axis=1)
        start, stop = told.slide_s
        sliding = (time_s > start + 0.03) & (time_s < stop - 0.03)
        np.testing.assert_allclose(load[sliding], 1.0, atol=0.08)
        assert load[time_s < 0.0].max() < 0.75
        final = trial.estimate.final_relative_pose
        np.testing.assert_allclose(told.relative[-1][:2], [1e3 * final.x_m, 1e3 * final.y_m], atol=1.0)


def test_a_run_tells_of_what_belongs_to_it(regrasp):
    campaign, store, _ = regrasp
    rows = campaign.document.rows
    every = [row.runs.execute for row in rows]
    for reference, trials in (
        (campaign.run.id, every),
        (rows[0].runs.plan, every[:1]),
        (rows[1].runs.execute, every[1:2]),
        (rows[1].runs.estimate, every[1:2]),
    ):
        assert [one.trial_run.id for one in find_subject(store, reference).trials] == trials
    assert len({one.chain for one in find_subject(store, "regrasp").trials}) == 1


def test_words_from_an_experiment_cannot_become_markup(regrasp):
    page = report._page(find_subject(regrasp[1], "regrasp"))
    name = "</script><b>&"
    text = render_report(replace(page, title=name, scenes=(replace(page.scenes[0], name=name),)))
    assert "<b>" not in text
    (scenes,) = re.findall(r'id="scenes">(.*?)</script>', text, re.DOTALL)
    assert json.loads(scenes)[0]["name"] == name


def test_what_cannot_be_reported_is_told(regrasp, tmp_path: Path):
    store = regrasp[1]
    with pytest.raises(
        NotFoundError, match=r"^run nothing: there is none in .*; nor is it an experiment: there is .*$"
    ):
        report.run(report.ReportRequest("nothing", tmp_path / "a.html", store))
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"file: cannot be made a folder: "):
        report.run(report.ReportRequest("regrasp", tmp_path / "file" / "a.html", store))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file"]
