"""What repeats, sweeps and explanations look like, and what is asked of their stages."""

import json
from pathlib import Path

import pytest

from cli import campaign_samples, samples
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.strict_yaml import loads
from slidepipe.cli import render
from slidepipe.cli.views.why import arm_view, why_view

REPEAT = """\
run 20261124T093010Z-7jw2e5rb  regrasp
error of the final pose from the goal; plan 20261124T093012Z-k3f9q2aw
repetition   x mm  y mm  theta mrad  true x mm  true y mm  true mrad
────────────────────────────────────────────────────────────────────
         1  -1.23  4.00        12.3          -          -          -
         2   lost     -           -          -          -          -

      mean  -1.23  4.00        12.3          -          -          -
       std      -     -           -          -          -          -

2 repetitions, 1 lost the object
data/runs/2026-11-24/20261124T093010Z-7jw2e5rb/repeat.yaml
"""
SWEEP = """\
run 20261124T093010Z-7jw2e5rb  regrasp
worlds     20, in the simulated lab, whole loop
drawn      lab.friction=0.36..0.44
worked on  15 in 12.3 s on 2 processes; 5 were there before
numbers    sha256 abababababababab

setting              worlds  converged   lost  error after           x mm          y mm  theta mrad
───────────────────────────────────────────────────────────────────────────────────────────────────
motion.slide_s=0.14      20     90.0 %  5.0 %  trial 1      -1.00 ± 10.00  2.00 ± 20.00  3.0 ± 30.0
                                               the last                 -             -           -
"""


def test_repeat(call, stages) -> None:
    result = call("run", "e.yaml", "--repeat", "2", "--set", "lab.seed=2", "--resume")
    assert (result.exit_code, result.stdout) == (0, REPEAT)
    asked = stages.requests[-1]
    assert (asked.experiment, asked.count, asked.resume, asked.overrides) == (
        Path("e.yaml"), 2, True, ("lab.seed=2",),
    )  # fmt: skip


def test_sweep(call, stages) -> None:
    result = call("sweep", "e.yaml", "--set", "lab.friction=0.36..0.44", "--trials", "20", "--workers", "2")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.startswith(SWEEP)
    asked = stages.requests[-1]
    assert (asked.sets, asked.trials, asked.workers, asked.world, asked.scheduler, asked.seed, asked.force) == (
        ("lab.friction=0.36..0.44",), 20, 2, "lab", None, 1, False,
    )  # fmt: skip


@pytest.mark.parametrize(("verb", "more"), [("sweep", ()), ("run", ("--repeat", "2"))])
def test_json(call, verb: str, more: tuple[str, ...]) -> None:
    told = json.loads(call(verb, "e.yaml", *more, "--json").stdout)
    assert list(told) == ["schema", "run", "directory", "document"]
    assert told["document"]["experiment"] == "regrasp"


def test_why_says_what_was_wrong_what_is_expected_and_what_changed(call, stages, capsys) -> None:
    stages.answers["iterate"].why = campaign_samples.why()
    shown = call("iterate", "x").stdout.splitlines()[:5]
    assert shown == [
        "why this plan  trial 2, iteration.way: learned",
        "error before    5.00 mm and 12.0 mrad (x -3.00 mm, y 4.00 mm, theta -12.0 mrad)",
        "expected after  0.40 mm, 95 % [0.10, 1.50]; 3.0 mrad, 95 % [0.2, 10.0]",
        "                within tolerance 75 %, lost 0 % of 400 worlds; the model misses by 2.1 % of a slide",
        "changed         friction 0.3800 -> 0.4200: 1 trial",
    ]
    render.put(why_view(campaign_samples.why(lost=True)))
    assert "error before    the object was lost" in capsys.readouterr().out


def test_arm_as_learned(capsys) -> None:
    render.put(arm_view(campaign_samples.arm()))
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "the arm as learned  from 1 trial"
    assert lines[3].split() == ["moving", "mass", *(["+5", "±", "1"] * 7)]


@pytest.mark.parametrize(
    "document",
    [
        campaign_samples.repeat(),
        campaign_samples.sweep(),
        campaign_samples.why(),
        campaign_samples.arm(),
        samples.campaign(),
    ],
    ids=lambda one: one.SCHEMA,
)
def test_documents_come_back_equal(document) -> None:
    assert parse(type(document), loads(dump_model(document), "a.yaml")) == document
