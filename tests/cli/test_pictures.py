"""The verbs that draw: what they ask for, and what they say of it."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from slidepipe.artifacts.store import Store
from slidepipe.errors import NotFoundError


@pytest.fixture(autouse=True)
def drawing(stages, monkeypatch: pytest.MonkeyPatch) -> None:
    for stage in ("figures", "report", "view"):
        monkeypatch.setitem(sys.modules, f"slidepipe.stages.{stage}", stages.module(stage))
    paths = tuple(Path("out") / f"fig07.{kind}" for kind in ("pdf", "svg", "png"))
    stages.answers["figures"] = (SimpleNamespace(name="fig07", title="Friction", caption="A caption.", paths=paths),)
    stages.answer(
        "report", path=Path("r.html"), subject="regrasp", trials=("a", "b"), warnings=("one is lost",), size=812_000
    )
    stages.answer("view", name="trial", poses=10, joints=20)


def test_figures_are_asked_for_by_name_and_told_in_a_table(call, stages) -> None:
    result = call("figures", "fig07", "--to", "out", "--table", "paper.md")
    (request,) = stages.requests
    assert (request.names, request.directory, request.table) == (("fig07",), Path("out"), Path("paper.md"))
    assert (request.experiments, request.store) == (Path("experiments"), Store(Path("data")))
    assert result.stdout == (
        "figure  shows     files\n"
        "─────────────────────────────────────────\n"
        "fig07   Friction  out/fig07.[pdf|svg|png]\n"
        "\n"
        "captions  out/captions.md\n"
        "numbers   paper.md\n"
    )
    told = json.loads(call("figures", "--json").stdout)
    assert told["figures"][0]["files"] == ["out/fig07.pdf", "out/fig07.svg", "out/fig07.png"]
    assert (told["schema"], told["table"]) == ("slidepipe.figures/1", None)


def test_a_figure_that_there_is_not_is_a_slip(call, stages) -> None:
    result = call("figures", "fig09")
    assert result.exit_code == 2
    assert "'fig09' is not one of 'fig01', 'fig02'" in result.stderr
    assert stages.requests == []


def test_a_report_says_where_it_is_and_warns_first(call, stages) -> None:
    result = call("report", "regrasp", "--to", "r.html")
    assert result.stdout == "r.html  2 trials, 0.8 MB\n"
    assert result.stderr == "warning: one is lost\n"
    (request,) = stages.requests
    assert (request.reference, request.path, request.store) == ("regrasp", Path("r.html"), Store(Path("data")))
    told = json.loads(call("report", "regrasp", "--json").stdout)
    assert told["warnings"] == ["one is lost"]
    assert told["trials"] == ["a", "b"]


def test_a_view_that_is_saved_says_what_is_in_it(call, stages) -> None:
    assert call("view", "@latest", "--save", "t.rrd").stdout == "t.rrd  trial: 10 poses, 20 joint states\n"
    assert call("view", "@latest").stdout == ""
    assert [request.save for request in stages.requests] == [Path("t.rrd"), None]


def test_what_is_not_there_ends_with_its_code(call, stages) -> None:
    stages.answers["view"] = NotFoundError("rerun is not installed: pip install 'slidepipe[view]'")
    result = call("view", "@latest")
    assert (result.exit_code, result.stderr) == (4, "error: rerun is not installed: pip install 'slidepipe[view]'\n")
