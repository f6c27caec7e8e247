"""What a person reads of each stage, to the letter."""

import re

import pytest

from cli import samples
from cli.expected import PLAN
from slidepipe.artifacts.values import Pose

TRIAL = """\
trial 20261124T093015Z-m0x7c4td  simulated lab, seed 7
plan            20261124T093012Z-k3f9q2aw
outcome         held
lasted          1.560 s
tracking error  rms 1.23 mm and 2.1 mrad, peak 3.40 mm and 5.6 mrad
frames          562, without the hand 11 (2.0 %), without the object 9 (1.6 %), longest gap 8.3 ms

true pose of the finger on the object    x mm    y mm  theta mrad
─────────────────────────────────────────────────────────────────
before                                 -10.00  -20.00      3141.6
after                                    4.02    8.04      3142.0

true friction  mu 0.4256, kappa 23.13 m/s², rho 10.44 mm
true slide     from 0.312 s to 0.446 s

data/runs/2026-11-24/20261124T093015Z-m0x7c4td/trial.yaml
"""

ESTIMATE = """\
estimate 20261124T093044Z-9zq1h8vn  of trial 20261124T093015Z-m0x7c4td
finger on the object (± one standard deviation)           x mm           y mm    theta mrad
───────────────────────────────────────────────────────────────────────────────────────────
before                                           -10.00 ± 0.03  -20.00 ± 0.02  3141.6 ± 0.4
after                                              4.00 ± 0.03    8.10 ± 0.02  3141.6 ± 0.4

kappa = mu f_N / m    23.1 ± 0.1 m/s², 95 % interval [22.9, 23.3] m/s²
mu                    0.4250, 95 % interval [0.4214, 0.4287]
assumed for mu        f_N 1.25 N, mass 23 g, rho 10.44 mm
± of mu in all        5.1 %: motion 0.4 %, f_N 5 % and mass 1 % if known as well as that
slide                 from 0.311 s to 0.446 s
frames used           542
cameras' clock        offset 12.300012 s, rate 20.1 ppm, residual 0.0123 ms
cameras after joints  0.300 ± 0.020 ms, gravity turned by 1.2 mrad
not told              torsion: this slide hardly turns
note                  two gaps

data/runs/2026-11-24/20261124T093044Z-9zq1h8vn/estimate.yaml
"""

CAMPAIGN = """\
run 20261124T093010Z-7jw2e5rb  regrasp
                                 x      y   theta  error  error          95 %
trial  finger on the object     mm     mm    mrad     mm   mrad      mu  interval
─────────────────────────────────────────────────────────────────────────────────────────
    1  planned, believed     10.00  20.00  3141.6                0.3800
       reached, estimated     4.00   8.10  3141.7  13.33    0.1  0.4250  [0.4214, 0.4287]
       true                   4.02   8.04  3142.0  13.37    0.4  0.4256

    2  planned, believed     10.00  20.00  3141.6                0.3800
       reached, estimated     4.00   8.10  3141.7  13.33    0.1  0.4250  [0.4214, 0.4287]
       true                   4.02   8.04  3142.0  13.37    0.4  0.4256

converged: within tolerance after 2 trials
data/runs/2026-11-24/20261124T093010Z-7jw2e5rb/tracking.png
data/runs/2026-11-24/20261124T093010Z-7jw2e5rb/sliding.png
"""


def test_plan(call) -> None:
    result = call("plan", "e.yaml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == PLAN


def test_plan_with_all_limits(call) -> None:
    lines = call("plan", "e.yaml", "--all").stdout.splitlines()
    assert [line[:14] for line in lines if line.startswith("joint")] == [
        f"joint {number} torque" for number in range(1, 8)
    ]
    shown = [line[:14] for line in PLAN.splitlines() if line.startswith("joint")]
    assert shown == [f"joint {number} torque" for number in (7, 6, 5, 4, 3)]


def test_iterate(call) -> None:
    result = call("iterate", "@latest")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines()[:4] == [
        "plan 20261124T093012Z-k3f9q2aw  regrasp, trial 2",
        "reason                          13.42 mm and 0.4 mrad remain; friction from the estimate",
        "from estimate                   20261124T093044Z-9zq1h8vn",
        "believed                        mu 0.3800 ± 0.0019, kappa 20.65 m/s², rho 10.44 mm",
    ]
    assert result.stdout.splitlines()[4:] == PLAN.splitlines()[3:], "then the same view as a first plan's"


def test_nothing_left_to_iterate(call, stages) -> None:
    stages.answer("iterate", run=None, document=None, why=None, reused=False)
    result = call("iterate", "@latest")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == "within tolerance: the finger is where it was wanted, there is nothing left to plan\n"


@pytest.mark.parametrize("verb", ["plan", "estimate", "iterate"])
def test_reuse_is_said(call, stages, verb: str) -> None:
    stages.answers[verb].reused = True
    result = call(verb, "x")
    assert result.exit_code == 0
    assert result.stderr == (
        f"reused run {stages.answers[verb].run.id}: same inputs, parameters and code of the stage "
        "(--force computes it anew)\n"
    )


def test_trial(call) -> None:
    result = call("execute", "@latest")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == TRIAL


def test_trial_of_a_real_lab(call, stages) -> None:
    stages.answers["execute"].truth = None
    document = samples.trial().model_copy(update={"lab": "wam", "seed": None, "tracking_error": None})
    stages.answers["execute"].document = document
    result = call("execute", "@latest")
    assert result.stdout.splitlines()[0] == "trial 20261124T093015Z-m0x7c4td  wam lab"
    assert "\ntracking error  -\n" in result.stdout
    assert "true" not in result.stdout


def test_trial_that_lost_the_object(call, stages) -> None:
    stages.answers["execute"].document = samples.trial("lost")
    result = call("execute", "@latest")
    assert result.exit_code == 1
    assert "\noutcome         lost\n" in result.stdout
    assert result.stderr == "lost: the fingers did not hold the object to the end of trial 20261124T093015Z-m0x7c4td\n"


def test_estimate(call) -> None:
    result = call("estimate", "@latest")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == ESTIMATE


def test_estimate_without_friction(call, stages) -> None:
    stages.answers["estimate"].document = samples.estimate(friction=False)
    result = call("estimate", "@latest")
    assert result.exit_code == 0
    assert re.search(r"^friction +not estimated: the object did not slide$", result.stdout, re.MULTILINE)
    assert re.search(r"^slide +nothing slid$", result.stdout, re.MULTILINE)
    assert "mu" not in result.stdout


def test_estimate_of_a_lost_object(call, stages) -> None:
    stages.answers["estimate"].document = samples.estimate(friction=False, lost="the object fell at 0.5 s")
    result = call("estimate", "@latest")
    assert (result.exit_code, result.stderr) == (1, "lost: the object fell at 0.5 s\n")
    assert re.search(r"^after +- +- +-$", result.stdout, re.MULTILINE)


def test_campaign(call) -> None:
    result = call("run", "e.yaml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == CAMPAIGN


def test_campaign_of_a_real_lab(call, stages) -> None:
    stages.answers["campaign"].document = samples.campaign(samples.row(1, simulated=False))
    blocks = [line[7:26].strip() for line in call("run", "e.yaml").stdout.splitlines()[4:7]]
    assert blocks == ["planned, believed", "reached, estimated", ""]


@pytest.mark.parametrize(
    ("document", "verdict"),
    [
        (
            samples.campaign(samples.row(1), outcome="out of trials"),
            "not converged: still out of tolerance after 1 trial",
        ),
        (
            samples.campaign(samples.row(1), samples.lost_row(2), outcome="lost"),
            "lost: the fingers did not hold the object to the end of trial 2",
        ),
        (
            samples.campaign(samples.row(1), samples.row(2), outcome="no plan", because="no motion within the limits"),
            "no plan: stopped after 2 trials: no motion within the limits",
        ),
    ],
)
def test_campaign_that_did_not_converge(call, stages, document, verdict: str) -> None:
    stages.answers["campaign"].document = document
    result = call("run", "e.yaml")
    assert result.exit_code == 1
    assert verdict in result.stdout.splitlines()


def test_lost_trial_in_a_campaign_and_no_number_is_cut(call, stages) -> None:
    far = samples.lost_row(1).model_copy(
        update={"true_relative_pose": Pose(x_m=-98765.4321, y_m=-1234.5, theta_rad=-987.6)}
    )
    stages.answers["campaign"].document = samples.campaign(far, outcome="lost")
    lost, true = call("run", "e.yaml").stdout.splitlines()[5:7]
    assert lost.split() == ["lost", *("-" * 7)]
    assert true.split()[:3] == ["true", "-98765432.10", "-1234500.00"]
    assert "…" not in true


def test_everything_fits(call, publish) -> None:
    publish(samples.plan_run(), plan=samples.plan())
    for arguments in (
        ["plan", "x"],
        ["execute", "x"],
        ["estimate", "x"],
        ["iterate", "x"],
        ["run", "x"],
        ["ls"],
        ["show", "@latest"],
    ):
        assert max(map(len, call(*arguments).stdout.splitlines())) <= 100
