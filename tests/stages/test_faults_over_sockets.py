"""Every fault of a laboratory at three strengths, over real sockets and in real time, through ``execute`` itself.

The run lands, or it stops in a controlled way for the right reason; its recording tells what happened, and it takes no
longer than its time-outs allow. :mod:`test_faults_virtual` has the same in virtual time, where nothing depends on the
machine. What only a machine that keeps time can show is tried again where it did not, and then skipped with the reason.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from fault_evidence import Seen
from fault_runs import Done, Job, play

from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.store import Store
from slidepipe.lab.faults import Fault, FaultKind
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS, STOPPED
from slidepipe.lab.safety import StopCause
from slidepipe.stages import plan
from slidepipe.stages.plan_files import REFERENCE, REFERENCE_JOINTS

pytestmark = pytest.mark.realtime

WORKERS = 2
ATTEMPTS = 3
APART_M, FAR_APART_M = 0.002, 0.015
"""How far from a sound run one may land; where commands are missing on the slide itself, the block goes on farther."""
TOLD_M = 0.0015
"""What an estimate from a spoilt recording may be away from the truth."""
MOVES_S, SLIDES_S = 0.6, 0.85
"""About the times after linking at which the arm is on its way, and at which the block begins to slide."""
LINK_S, SLACK_S = 0.5, 0.5
STOP_S = 0.3 + 0.2
"""A stop along the path, and the hold after it, as the lab file of these tests has them."""
TIMEOUT_S = {StopCause.LINK: 0.02, StopCause.MOCAP: 0.1, StopCause.SWAP: 0.1, StopCause.OBJECT: 0.15}
"""How long after a fault the run may go on, by the shipped lab file; an arm that stalls must err by 0.1 rad first."""

LANDS = frozenset[StopCause]()
LIMP = frozenset({StopCause.LINK, StopCause.TRACKING})
BEHIND = frozenset({StopCause.TRACKING, StopCause.OBJECT})
Evidence = Callable[[Seen, float], bool]


@dataclass(frozen=True)
class Case:
    """A fault, why the run may stop for it (empty: it must land, about there), and what its recording must say."""

    kind: FaultKind
    strength: float
    start_s: float
    causes: frozenset[StopCause]
    evidence: Evidence
    apart_m: float = APART_M

    @property
    def fault(self) -> Fault:
        """The fault."""
        return Fault(self.kind, self.strength, self.start_s)

    def __str__(self) -> str:
        return f"{self.kind.value}-{self.strength:g}"


def share(count: int, of: int, strength: float) -> bool:
    """Whether so many of so many are about that share; what came before linking was whole."""
    spread = 5.0 * np.sqrt(strength * (1.0 - strength) / max(of, 1)) + 2.0 / max(of, 1)
    return 0.5 * strength - spread < count / max(of, 1) < strength + spread


def lost(seen: Seen, strength: float) -> bool:
    counts = seen.statistics
    states = round(seen.lasted_s / 0.002)
    return share(counts.frames_missing, counts.frames_taken + counts.frames_missing, strength) and share(
        counts.states_lost, states, strength
    )


def cut_off(seen: Seen, _: float) -> bool:
    return seen.longest_gap_s > 0.02 or seen.statistics.states_lost > 1


def doubled(seen: Seen, _: float) -> bool:
    return seen.statistics.frames_repeated > 5 and seen.statistics.states_disordered > 5


def disordered(seen: Seen, _: float) -> bool:
    return seen.statistics.frames_late > 5 and seen.statistics.states_disordered > 5


def delayed(seen: Seen, strength: float) -> bool:
    return seen.spread_s > 3.0 * strength


def no_object(seen: Seen, strength: float) -> bool:
    return 0.4 * strength < seen.no_object - 0.02 < strength + 0.05 and seen.no_hand < 0.06


def unseen_at_last(seen: Seen, _: float) -> bool:
    return seen.no_object > 0.08


def swapped(seen: Seen, _: float) -> bool:
    return seen.statistics.bodies_swapped > 0


def drifted(seen: Seen, strength: float) -> bool:
    return abs(seen.drift_ppm - strength - 20.0) < 150.0 + 0.02 * strength


def stood_still(seen: Seen, strength: float) -> bool:
    return seen.longest_gap_s > 0.7 * min(strength, 0.1) and seen.statistics.frames_repeated >= 4


def fell_behind(seen: Seen, _: float) -> bool:
    return seen.error_rad > 0.08


def nothing(_: Seen, __: float) -> bool:
    """What is so weak leaves no trace."""
    return True


CASES = [
    Case(FaultKind.LOSS, 0.02, 0.0, LANDS, lost),
    Case(FaultKind.LOSS, 0.2, 0.0, LANDS, lost, FAR_APART_M),
    Case(FaultKind.LOSS, 0.95, 0.3, LIMP, cut_off),
    Case(FaultKind.DUPLICATION, 0.05, 0.0, LANDS, doubled),
    Case(FaultKind.DUPLICATION, 0.5, 0.0, LANDS, doubled),
    Case(FaultKind.DUPLICATION, 1.0, 0.0, LANDS, doubled),
    Case(FaultKind.REORDERING, 0.02, 0.0, LANDS, disordered),
    Case(FaultKind.REORDERING, 0.2, 0.0, LANDS, disordered),
    Case(FaultKind.REORDERING, 0.6, 0.0, LANDS, disordered, FAR_APART_M),
    Case(FaultKind.JITTER, 0.0003, 0.0, LANDS, nothing),
    Case(FaultKind.JITTER, 0.001, 0.0, LANDS, delayed, FAR_APART_M),
    Case(FaultKind.JITTER, 0.05, 0.3, LIMP, nothing),
    Case(FaultKind.OCCLUSION, 0.05, 0.0, LANDS, no_object),
    Case(FaultKind.OCCLUSION, 0.5, 0.0, LANDS, no_object),
    Case(FaultKind.OCCLUSION, 1.0, 0.3, frozenset({StopCause.OBJECT}), unseen_at_last),
    Case(FaultKind.SWAP, 0.05, 0.0, LANDS, swapped),
    Case(FaultKind.SWAP, 0.15, 0.0, LANDS, swapped),
    Case(FaultKind.SWAP, 1.0, 0.3, frozenset({StopCause.SWAP}), swapped),
    Case(FaultKind.DRIFT, 50.0, 0.0, LANDS, drifted),
    Case(FaultKind.DRIFT, 1000.0, 0.0, LANDS, drifted),
    Case(FaultKind.DRIFT, 10000.0, 0.0, LANDS, drifted),
    Case(FaultKind.FREEZE, 0.02, 0.3, LANDS, stood_still),
    Case(FaultKind.FREEZE, 0.08, 0.3, LANDS, stood_still),
    Case(FaultKind.FREEZE, 1.0, 0.3, frozenset({StopCause.MOCAP}), nothing),
    Case(FaultKind.STALL, 0.004, MOVES_S, LANDS, nothing),
    Case(FaultKind.STALL, 0.1, SLIDES_S, BEHIND, fell_behind),
    Case(FaultKind.STALL, 1.0, SLIDES_S, BEHIND, fell_behind),
    Case(FaultKind.UNLINK, 0.006, 0.3, LANDS, cut_off),
    Case(FaultKind.UNLINK, 0.05, 0.3, LIMP, cut_off),
    Case(FaultKind.UNLINK, 5.0, SLIDES_S, LIMP, nothing),
]


def test_every_kind_is_tried_at_three_strengths() -> None:
    tried = {kind: sum(case.kind is kind for case in CASES) for kind in FaultKind}
    assert tried.pop(FaultKind.BLINDNESS) == 0, "occlusion of both bodies: in virtual time alone"
    assert set(tried.values()) == {3}


class Runs:
    """Executions, as many at a time as the machine has cores for; one that shows nothing is done again."""

    def __init__(self, room: Path, experiment: Path, pool: ProcessPoolExecutor) -> None:
        store = Store(room / "data")
        planned = plan.run(plan.PlanRequest(experiment, store)).run
        home = read_recording(planned.file(REFERENCE)).joints(REFERENCE_JOINTS).position_rad[0]
        self._job = Job(store.root, planned.id, experiment, room, tuple(home.tolist()), None)
        self._room, self._pool, self._count = room, pool, 0
        self._begun: dict[Fault | None, Future[Done]] = {}

    def begin(self, fault: Fault | None) -> Future[Done]:
        """Begin one, unless it is begun already."""
        if fault not in self._begun:
            self._begun[fault] = self.again(fault)
        return self._begun[fault]

    def again(self, fault: Fault | None) -> Future[Done]:
        """Begin one anew."""
        self._count += 1
        directory = self._room / f"{self._count}"
        directory.mkdir()
        job = self._job
        return self._pool.submit(play, Job(job.store, job.plan, job.experiment, directory, job.home_rad, fault))

    def done(self, fault: Fault | None, sound: Callable[[Done], object]) -> Done:
        """Wait for one that is sound, or that fails on a machine that kept time."""
        future = self.begin(fault)
        for left in reversed(range(ATTEMPTS)):
            done = future.result()
            try:
                sound(done)
            except AssertionError:
                if done.late is None:
                    raise
                if not left:
                    pytest.skip(f"this machine did not keep time in {ATTEMPTS} attempts: {done.late}")
                future = self.again(fault)
            else:
                break
        return done


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory, experiments: Path, request: pytest.FixtureRequest) -> Iterator[Runs]:
    """Everything that the chosen tests need is begun at once."""
    room = tmp_path_factory.mktemp("faults")
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        runs = Runs(room, experiments / "regrasp.yaml", pool)
        runs.begin(None)
        for item in request.session.items:
            if getattr(item, "module", None) is request.module and hasattr(item, "callspec"):
                runs.begin(item.callspec.params["case"].fault)
        yield runs
        pool.shutdown(cancel_futures=True)


def landed(done: Done) -> None:
    """Nothing stopped it."""
    assert done.trial.stopped is None
    assert done.trial.invalid is None
    assert done.state is RunState.COMPLETE
    assert done.seen.events == (MOTION_STARTS, MOTION_ENDS)
    assert done.told is not None, done.refused


def test_a_sound_run_lands_where_its_recording_says(runs: Runs) -> None:
    def right(done: Done) -> None:
        landed(done)
        assert done.told is not None
        assert apart_m(done.told, done.landed) < TOLD_M

    done = runs.done(None, right)
    counts = done.seen.statistics
    assert (counts.frames_missing, counts.states_lost, counts.states_disordered, counts.bodies_swapped) == (0, 0, 0, 0)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_it_lands_or_stops_for_the_right_reason(runs: Runs, case: Case) -> None:
    sound = runs.done(None, landed)

    def right(done: Done) -> None:
        assert done.seen.end == "complete"
        assert case.evidence(done.seen, case.strength), done.seen
        if case.causes:
            stopped(done, case)
        else:
            landed(done)
            assert apart_m(done.landed, sound.landed) < case.apart_m
            assert done.told is not None
            assert apart_m(done.told, done.landed) < TOLD_M

    done = runs.done(case.fault, right)
    apart_mm = 1e3 * apart_m(done.landed, sound.landed)
    print(f"{case}: {done.trial.stopped or f'landed {apart_mm:.1f} mm from the sound run'}")  # noqa: T201


def stopped(done: Done, case: Case) -> None:
    """It stopped in time for one of the causes, says so everywhere, and is not estimated."""
    assert done.trial.stopped is not None
    cause = StopCause(done.trial.stopped.partition(":")[0])
    assert cause in case.causes, done.trial.stopped
    gone = cause is StopCause.OBJECT or done.trial.outcome == "lost"
    assert done.state is (RunState.LOST if gone else RunState.STOPPED)
    assert f"{STOPPED}{done.trial.stopped}" in done.seen.events
    assert 0.0 <= 1e-9 * (done.trial.finished_ns - done.trial.started_ns) < done.seen.lasted_s
    assert done.told is None
    assert "the trial was stopped: " in done.refused
    allowed_s = LINK_S + case.start_s + TIMEOUT_S.get(cause, 0.1) + STOP_S + SLACK_S
    assert done.seen.lasted_s < allowed_s


def apart_m(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    return float(np.hypot(one[0] - other[0], one[1] - other[1]))
