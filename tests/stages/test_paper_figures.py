import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from slidepipe.artifacts.store import Store
from slidepipe.errors import NotFoundError
from slidepipe.figures.paper import FORMATS
from slidepipe.stages import paper_given, paper_motions, paper_runs, paper_theory
from slidepipe.stages.figure_names import TITLES
from slidepipe.stages.figures import DRAW, FiguresRequest, FigureWritten, run
from slidepipe.stages.paper_claims import claims
from slidepipe.stages.paper_page import claims_page
from slidepipe.stages.paper_repeats import friction_for_miss, repeat_error
from slidepipe.stages.paper_runs import PaperRuns

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"
MAGIC = {"pdf": b"%PDF-", "svg": b"<?xml", "png": b"\x89PNG"}


@pytest.fixture(scope="module")
def two_repeats() -> Iterator[None]:
    """Fig. 12 from two trials, which is enough to see that it is made of trials."""
    patch = pytest.MonkeyPatch()
    patch.setattr(paper_runs, "REPEATS", 2)
    yield
    patch.undo()


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("paper")


@pytest.fixture(scope="module")
def told() -> list[str]:
    return []


@pytest.fixture(scope="module")
def written(place: Path, told: list[str], two_repeats: None) -> tuple[FigureWritten, ...]:  # noqa: ARG001
    request = FiguresRequest((), place / "figures", EXPERIMENTS, Store(place / "data"), told.append, place / "paper.md")
    return run(request)


@pytest.fixture
def runs(place: Path, written: tuple[FigureWritten, ...]) -> PaperRuns:  # noqa: ARG001
    """The runs that the figures were drawn from; making any more of them fails."""
    return PaperRuns(EXPERIMENTS, Store(place / "data"), pytest.fail)


def test_every_figure_is_written_in_every_format_with_its_caption(written, place):
    assert [one.name for one in written] == list(TITLES) == list(DRAW)
    captions = (place / "figures" / "captions.md").read_text()
    for one in written:
        assert [path.suffix[1:] for path in one.paths] == list(FORMATS)
        assert all(path.read_bytes().startswith(MAGIC[path.suffix[1:]]) for path in one.paths)
        assert f"## {one.name}: {one.title}\n\n![{one.title}]({one.name}.png)\n\n{one.caption}" in captions
    assert not list(place.rglob("*.tmp"))


def test_what_the_store_lacks_is_run_once_and_then_taken_from_it(written, told, runs, place):
    assert [line.split()[0] for line in told].count("executed") == 3
    assert [line.split()[0] for line in told].count("planned") == 2
    before = {path: path.read_bytes() for path in (place / "figures").glob("fig0[67]*")}
    run(FiguresRequest(("fig06", "fig07"), place / "figures", EXPERIMENTS, Store(place / "data"), pytest.fail))
    assert {path: path.read_bytes() for path in before} == before
    assert runs.nominal.runs.execute.id in next(one.caption for one in written if one.name == "fig10")


def test_a_trial_in_another_world_is_not_taken_for_this_one(runs):
    first, second = runs.repeats
    assert first.runs.plan.id == second.runs.plan.id == runs.nominal.runs.plan.id
    assert len({first.runs.execute.id, second.runs.execute.id, runs.nominal.runs.execute.id}) == 3
    assert first.experiment.lab.friction != second.experiment.lab.friction
    assert first.runs.execute.manifest.parameters["lab"]["friction"] == first.experiment.lab.friction


def test_the_friction_of_figure_7_lies_on_the_surface_and_turns_by_45_degrees(runs):
    for planned, turn in ((runs.linear, 0.0), (runs.rotational, np.pi / 4)):
        panel = paper_motions._friction(planned)
        np.testing.assert_allclose(np.linalg.norm(panel.f / panel.semi_axes, axis=1), 1.0, rtol=1e-12)
        assert np.all(np.einsum("ti,ti->t", panel.f, panel.dv) > 0.0)
        assert paper_motions._spread_rad(panel) == pytest.approx(turn, abs=1e-3)


def test_the_areas_of_figure_2_are_the_distances_in_its_caption(runs):
    drawn = paper_theory.fig02(runs)
    (axes,) = drawn.figure.axes
    for area, label in zip(axes.collections, ("d1 = 87.7 mm", "d2 = 12.3 mm", "d3 = 14.5 mm"), strict=True):
        outline = area.get_paths()[0].vertices
        x, y = outline[:, 0], outline[:, 1]
        size = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
        assert 1e3 * size == pytest.approx(float(label.split()[2]), abs=0.06)
        assert label in drawn.caption


def test_the_numbers_stand_beside_the_papers(runs, place):
    rows = claims(runs)
    assert (place / "paper.md").read_text() == claims_page(rows)
    found = {(row.where, row.what): row for row in rows}
    assert found["VIII-B", "T4"].ours == "0.3 s"
    assert found["VIII-B", "start of the finger in {b}"].ours == "-0.01 m, 0.04 m, 0.75 π"
    assert {row.difference for row in rows if row.reason == paper_given.FILE} == {"none"}
    assert found["IX", "gripper with the object"].ours == "0.105 kg"
    rms_mm = 1e3 * runs.nominal.trial.tracking_error.position_rms_m
    assert found["IX", "tracking error of the hand"].ours == f"{rms_mm:.2f} mm rms"
    assert found["VIII-B", "relative acceleration, θ"].difference == "none"
    assert found["III-D, Theorem 1", "3: largest ε"].ours == "0.6923"
    assert all(cell for row in rows for cell in (row.where, row.what, row.paper, row.ours, row.difference, row.reason))
    error = repeat_error(runs)
    assert found["IX", "final error, y"].ours == f"{1e3 * error.mean[1]:.1f} ± {1e3 * error.sd[1]:.1f} mm"


def test_the_friction_that_explains_a_miss_is_the_one_that_makes_it(runs):
    one = max(runs.repeats, key=lambda tried: tried.experiment.lab.friction)
    goal = np.array(one.experiment.goal.relative_pose.vector)
    miss_m = float(np.hypot(*(goal - np.array(one.estimate.final_relative_pose.vector))[:2]))
    ratio = one.experiment.lab.friction / one.experiment.friction
    assert friction_for_miss(runs.linear, miss_m) == pytest.approx(ratio, abs=0.005)


def test_the_page_in_the_docs_has_the_rows_that_are_made_now(runs):
    page = (EXPERIMENTS.parent / "docs" / "paper.md").read_text()
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| ")][2:]
    assert [row[:3] for row in rows] == [
        [f"| {one.where}", one.what.replace("|", "\\|"), one.paper] for one in claims(runs)
    ]


def test_a_folder_without_the_papers_experiments_is_told(tmp_path):
    request = FiguresRequest(("fig04",), tmp_path / "out", tmp_path, Store(tmp_path / "data"), pytest.fail)
    said = r": must hold paper_linear\.yaml, paper_rotational\.yaml \(--experiments PATH\)$"
    with pytest.raises(NotFoundError, match=said):
        run(request)


def test_captions_name_only_runs_that_exist(written, place):
    store = Store(place / "data")
    ids = {run.id for run in store.runs()}
    words = {word.strip("(),.") for one in written for word in one.caption.split()}
    named = {word for word in words if len(word) == 25 and word[8] == "T"}
    assert named
    assert named <= ids
    assert json.dumps([one.caption for one in written]).count("None") == 0
