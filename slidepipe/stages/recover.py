"""Recover: what a killed process left becomes a run, and a recording that was cut off becomes sound."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.abandoned import Abandoned
from slidepipe.artifacts.recovery import Recovery, recover_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.wording import one_of
from slidepipe.errors import InputError, NotFoundError

MCAP = ".mcap"


@dataclass(frozen=True, slots=True)
class RecoverRequest:
    """What to recover: an interrupted run, the path of a recording, or everything that is there to be recovered."""

    what: str | None
    store: Store


@dataclass(frozen=True, slots=True)
class Recovered:
    """What was recovered: a run with its recordings, or a recording alone.

    Attributes
    ----------
    run : Run, optional
    recordings : tuple of Recovery
    faults : tuple of str
        One line for each recording of which nothing could be read.
    """

    run: Run | None
    recordings: tuple[Recovery, ...]
    faults: tuple[str, ...] = ()


def run(request: RecoverRequest) -> tuple[Recovered, ...]:
    """Make recordings sound that were cut off, and publish the runs that they belong to as interrupted.

    Raises
    ------
    NotFoundError
        There is no such file or interrupted run.
    InputError
        The file is no recording, or nothing of it can be read.
    BusyError
        It is still being written.
    """
    if request.what is not None and Path(request.what).suffix == MCAP:
        return (Recovered(None, (recover_recording(Path(request.what)),)),)
    return tuple([_recover(one) for one in _chosen(request)])


def _chosen(request: RecoverRequest) -> Iterable[Abandoned]:
    there = request.store.abandoned()
    if request.what is None:
        return there
    found = [one for one in there if one.run_id.startswith(request.what)]
    if not found:
        others = one_of([one.run_id for one in there]) or "none"
        raise NotFoundError(f"run {request.what}: is not interrupted, or not known; there are: {others}")
    if len(found) > 1:
        raise NotFoundError(f"run {request.what}: may be {one_of([one.run_id for one in found])}")
    return found


def _recover(one: Abandoned) -> Recovered:
    recordings, faults = [], []
    for path in sorted(one.staging.glob(f"*{MCAP}")):
        if path.name.startswith("."):
            continue
        try:
            recordings.append(recover_recording(path))
        except InputError as error:
            faults.append(str(error))
    published = one.publish()
    moved = [Recovery(published.directory / one.path.name, one.fault, one.messages) for one in recordings]
    return Recovered(published, tuple(moved), tuple(faults))
