"""What a person reads of runs in the store, to the letter."""

from pathlib import Path

import pytest

from cli import samples
from cli.expected import PLAN

LIST = """\
run                        stage    experiment  state     seed  results
────────────────────────────────────────────────────────────────────────────────────────────────────
20261124T093012Z-k3f9q2aw  plan     regrasp     complete     -  peak_hand_speed 1.235 m/s,
                                                                stick_load 0.8123
20261124T093015Z-m0x7c4td  execute  regrasp     failed       7
"""

MANIFEST = """\
run 20261124T093012Z-k3f9q2aw
stage       plan (version 1)
experiment  regrasp
state       complete
started     2026-11-24T09:30:12.000000Z
finished    2026-11-24T09:30:14.500000Z
seed        -
code        slidepipe 0.1.0, commit 7deb79600000
recipe      5e5e5e5e5e5e5e5e
command     slidepipe plan experiments/regrasp.yaml
directory   data/runs/2026-11-24/20261124T093012Z-k3f9q2aw

input       from                        size  sha256
──────────────────────────────────────────────────────────────
experiment  experiments/regrasp.yaml  2.5 kB  abababababababab

output     file                size  sha256
─────────────────────────────────────────────────────
plan       plan.yaml         3.1 kB  cdcdcdcdcdcdcdcd
reference  reference.mcap  203.4 kB  efefefefefefefef

result             value   std  unit
────────────────────────────────────
peak_hand_speed    1.235     -  m/s
stick_load        0.8123     -
peak_elbow_speed     0.5  0.01  m/s

"""

FAILED = """\
run 20261124T093015Z-m0x7c4td
stage       execute (version 1)
experiment  regrasp
state       failed
error       LabError: joint 4: is 0.3 rad away from its command
started     2026-11-24T09:30:15.000000Z
finished    2026-11-24T09:30:16.000000Z
seed        7
code        slidepipe 0.1.0, no commit known, changed or not: not known
recipe      5e5e5e5e5e5e5e5e
command     slidepipe execute
directory   data/runs/2026-11-24/20261124T093015Z-m0x7c4td
"""


def test_list(call, publish) -> None:
    publish(samples.plan_run())
    publish(samples.failed_run())
    result = call("ls")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == LIST


@pytest.mark.parametrize(
    ("arguments", "ids"),
    [
        (["--stage", "execute"], [samples.TRIAL]),
        (["--experiment", "regrasp"], [samples.PLAN, samples.TRIAL]),
        (["--experiment", "regrasp", "--stage", "plan"], [samples.PLAN]),
    ],
)
def test_filtered_list(call, publish, arguments: list[str], ids: list[str]) -> None:
    publish(samples.plan_run())
    publish(samples.failed_run())
    lines = call("ls", *arguments).stdout.splitlines()[2:]
    assert [line.split()[0] for line in lines if line.startswith("2")] == ids


def test_empty_list(call, publish) -> None:
    assert (call("ls").stdout, call("ls").stderr) == ("", "no runs in data\n")
    publish(samples.plan_run())
    result = call("ls", "--experiment", "other")
    assert (result.exit_code, result.stdout, result.stderr) == (
        0,
        "",
        "no runs with --experiment other among the 1 in data; of experiments there is regrasp\n",
    )
    filters = ("--experiment", "regrsp", "--stage", "plan", "--state", "lost", "--since", "2030-01-01")
    ended = "2026-11-24T09:30Z"
    assert call("ls", *filters).stderr == (
        "no runs with --experiment regrsp --stage plan --state lost --since 2030-01-01T00:00Z among the 1 in data"
        "; of experiments there is regrasp; did you mean regrasp?; of states there is complete"
        f"; the first ended {ended}, the last {ended}\n"
    )


def test_list_with_a_damaged_run(call, publish, tmp_path: Path) -> None:
    publish(samples.plan_run())
    damaged = publish(samples.failed_run())
    (tmp_path / damaged.directory / "run.yaml").write_text("schema: slidepipe.run/1\nrun: 5\n")
    result = call("ls")
    assert result.exit_code == 5
    assert samples.PLAN in result.stdout
    assert result.stderr.startswith(f"error: {damaged.directory}/run.yaml:")
    assert result.stderr.count("\n") == 1


def test_show_the_manifest_and_then_what_the_stage_said(call, publish) -> None:
    publish(samples.plan_run(), plan=samples.plan())
    for reference in (samples.PLAN, "20261124T09", "k3f9", "@latest", "@latest:plan"):
        result = call("show", reference)
        assert (result.exit_code, result.stderr) == (0, "")
        assert result.stdout == MANIFEST + PLAN


def test_show_a_failed_run(call, publish) -> None:
    publish(samples.failed_run())
    result = call("show", "@latest")
    assert (result.exit_code, result.stdout) == (0, FAILED)


@pytest.mark.parametrize(
    ("stage", "documents", "words"),
    [
        ("execute", {"trial": samples.trial(), "truth": samples.truth()}, ["tracking error", "true friction"]),
        ("estimate", {"estimate": samples.estimate()}, ["95 % interval [0.4214, 0.4287]"]),
        ("campaign", {"campaign": samples.campaign(samples.row(1))}, ["converged: within tolerance", "tracking.png"]),
    ],
)
def test_show_each_stage(call, publish, stage: str, documents, words: list[str]) -> None:
    outputs = [samples.output(name, f"{name}.yaml") for name in documents]
    publish(samples.run(samples.TRIAL, stage, outputs=tuple(outputs)), **documents)
    result = call("show", "@latest")
    assert (result.exit_code, result.stderr) == (0, "")
    assert [word for word in words if word not in result.stdout] == []


@pytest.mark.parametrize("text", [None, "schema: slidepipe.plan/1\n"])
def test_show_a_run_whose_document_is_damaged(call, publish, tmp_path: Path, text: str | None) -> None:
    run = publish(samples.plan_run())
    if text is not None:
        (tmp_path / run.directory / "plan.yaml").write_text(text)
    result = call("show", "@latest")
    assert (result.exit_code, result.stdout) == (5, "")
    assert result.stderr.startswith(f"error: {run.directory}/plan.yaml:")
