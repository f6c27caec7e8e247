"""Stages that compute nothing, in the place of those that do: what is tested here is the words around them."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner, Result

from cli import calibration_samples, campaign_samples, pooled_samples, samples, surface_samples
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import Artifact, dump_model
from slidepipe.cli.main import cli

Call = Callable[..., Result]


@dataclass
class FakeStages:
    """Requests that were made, and what each stage answers: a result, or an error to raise."""

    answers: dict[str, Any] = field(default_factory=dict)
    requests: list[SimpleNamespace] = field(default_factory=list)

    def answer(self, stage: str, **result: Any) -> None:
        self.answers[stage] = SimpleNamespace(**result)

    def module(self, stage: str) -> ModuleType:
        module = ModuleType(f"slidepipe.stages.{stage}")
        setattr(module, f"{stage.capitalize()}Request", SimpleNamespace)

        def run(request: SimpleNamespace) -> Any:
            self.requests.append(request)
            answer = self.answers[stage]
            if isinstance(answer, BaseException):
                raise answer
            return answer

        module.run = run  # type: ignore[attr-defined]
        return module


@pytest.fixture(autouse=True)
def stages(monkeypatch: pytest.MonkeyPatch) -> FakeStages:
    fakes = FakeStages()
    for stage in (
        "plan",
        "execute",
        "estimate",
        "iterate",
        "campaign",
        "repeat",
        "sweep",
        "pool",
        "surface",
        "calibrate",
    ):
        monkeypatch.setitem(sys.modules, f"slidepipe.stages.{stage}", fakes.module(stage))
    fakes.answer("plan", run=samples.plan_run(), document=samples.plan(), reused=False)
    fakes.answer("execute", run=samples.run(samples.TRIAL, "execute"), document=samples.trial(), truth=samples.truth())
    fakes.answer("estimate", run=samples.run(samples.ESTIMATE, "estimate"), document=samples.estimate(), reused=False)
    fakes.answer("iterate", run=samples.plan_run(), document=samples.plan(trial=2), why=None, reused=False)
    fakes.answer("repeat", run=samples.run(samples.CAMPAIGN, "repeat"), document=campaign_samples.repeat())
    fakes.answer("sweep", run=samples.run(samples.CAMPAIGN, "sweep"), document=campaign_samples.sweep())
    fakes.answer(
        "pool",
        run=samples.run(pooled_samples.POOLED, "pool"),
        document=pooled_samples.pooled(),
        estimates=(SimpleNamespace(document=samples.estimate()), None),
        reused=False,
    )
    fakes.answer(
        "surface",
        run=samples.run(surface_samples.SURFACE, "surface"),
        document=surface_samples.surface(),
        reused=False,
    )
    fakes.answer(
        "calibrate",
        run=samples.run(calibration_samples.CALIBRATION, "calibrate"),
        document=calibration_samples.calibration(),
        reused=False,
    )
    fakes.answer(
        "campaign",
        run=samples.run(samples.CAMPAIGN, "campaign"),
        document=samples.campaign(samples.row(1), samples.row(2)),
    )
    return fakes


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Call:
    """Call the command line in an empty directory."""
    monkeypatch.chdir(tmp_path)
    for name in ("SLIDEPIPE_DATA", "COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)

    def invoke(*arguments: str, **options: Any) -> Result:
        return CliRunner().invoke(cli, arguments, prog_name="slidepipe", **options)

    return invoke


@pytest.fixture
def publish(tmp_path: Path) -> Callable[..., Run]:
    """Put a run into the store below the directory of :func:`call`."""

    def put(run: Run, **documents: Artifact) -> Run:
        directory = tmp_path / run.directory
        directory.mkdir(parents=True)
        (directory / "run.yaml").write_text(dump_model(run.manifest), encoding="utf-8")
        for name, document in documents.items():
            (directory / f"{name}.yaml").write_text(dump_model(document), encoding="utf-8")
        return run

    return put
