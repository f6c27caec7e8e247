"""Where a trial's recording lies, and what it says that it was recorded for."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.manifest import InputRef
from slidepipe.artifacts.overrides import apply_overrides
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.recording_reader import Recording, read_recording
from slidepipe.artifacts.recording_writer import PROVENANCE
from slidepipe.artifacts.run import outside_input
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import loads
from slidepipe.errors import InputError
from slidepipe.stages.trial_facts import RECORDING

SETTABLE = "estimation"
"""Section of the experiment that may still be set when a trial was run."""


@dataclass(frozen=True, slots=True)
class TrialSource:
    """A recording: where it lies, which run made it, for which experiment."""

    path: Path
    trial: str
    experiment: str
    input: InputRef


def trial_source(trial: str, store: Store) -> TrialSource:
    """Find the recording of a trial, which is a run or the path of a recording.

    Raises
    ------
    NotFoundError
        There is no such run or file, or the run holds no recording.
    InputError
        The recording is damaged, or none of a trial.
    """
    path = Path(trial)
    if path.suffix == ".mcap":
        provenance = read_recording(path).metadata.get(PROVENANCE, {})
        if not {"run", "experiment"} <= provenance.keys():
            raise InputError(f"{path}: does not say which run recorded it for which experiment: not a recorded trial")
        return TrialSource(path, provenance["run"], provenance["experiment"], outside_input(RECORDING, path))
    run = store.get(trial)
    return TrialSource(run.file(RECORDING), run.id, run.manifest.experiment, run.input(RECORDING))


@dataclass(frozen=True, slots=True)
class Purpose:
    """What a recording says that it was recorded for."""

    experiment: Experiment
    plan: PlanDocument


def purpose_of(recording: Recording, overrides: Iterable[str] = ()) -> Purpose:
    """Read the plan and the experiment that a recording begins with.

    Raises
    ------
    InputError
        They are damaged, or ``overrides`` set something that the trial was already run with.
    """
    path = recording.path
    for override in overrides:
        if override.partition("=")[0].partition(".")[0].strip() != SETTABLE:
            raise InputError(
                f"--set {override}: the trial was run with the rest of the experiment, only {SETTABLE} can be set"
            )
    experiment = loads(_text(recording, "experiment.yaml"), f"{path}: experiment.yaml")
    return Purpose(
        parse(Experiment, apply_overrides(experiment, overrides)),
        parse(PlanDocument, loads(_text(recording, "plan.yaml"), f"{path}: plan.yaml")),
    )


def _text(recording: Recording, name: str) -> str:
    try:
        return recording.attachment(name).decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{recording.path}: {name}: is not UTF-8 at byte {error.start}") from None
