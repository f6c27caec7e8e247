"""Time the simulation against scipy and MuJoCo: one process, one core, the turns taken in alternation.

(a) a trial of Section VIII-A with less than a micrometre of error, (b) one implicit step, (c) 100,000 trials with
different frictions on all cores. ``--json`` writes the figures.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np
from support.motions import Case, linear
from support.plain_python import PlainTrial

from slidepipe.lab.grip_model import ContactSettings
from slidepipe.lab.planar_rig import PlanarRig, planar_rig, roll, step_times
from slidepipe.mechanics.parameters import ParameterSets
from slidepipe.mechanics.planar import relative_pose
from slidepipe.mechanics.simulate import simulate, simulate_many
from slidepipe.mechanics.stepping import step_through
from slidepipe.series import FloatArray

ALLOWED_M = 1e-6
ROUNDS = 9
TRIALS = 200
"""Of ours in one turn."""
SPREAD = 0.05
"""Frictions of the batch lie within this share of the planned one."""
BATCH_TOLERANCE = 1e-7
METHODS = ("RK45", "DOP853", "LSODA", "Radau")
FIRST_CALL = """
import time, numpy as np
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.simulate import simulate
hand = HandMotion(np.array([0.0, 1.0]), np.zeros((1, 3, 3)), np.array([True, True]))
began = time.perf_counter()
simulate(hand, Block(0.06, 0.1, 0.02), SoftFinger(0.4, 2.0, 0.02, 0.6), np.zeros(3))
print(time.perf_counter() - began)
"""


@dataclass(frozen=True, slots=True)
class Peer:
    """A way to run the trial: what it is, its error in m, and one run of it."""

    name: str
    error_m: float
    run: Callable[[], object]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="where to write the figures")
    options = parser.parse_args()
    first_s, cached_s = _first_calls()
    print(f"first call of a process: {first_s:.1f} s compiling, {1e3 * cached_s:.0f} ms from the cache on disk\n")
    case = linear()
    # The batch first: the others leave their own mark on the peak of memory.
    batch = _batch(case)
    figures = _trial(case) | _step(case) | batch
    _print(figures)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


def _trial(case: Case) -> dict[str, float]:
    truth = simulate(case.hand, case.block, case.lone, case.r_f_b, tolerance=1e-12).r_f_b
    print(f"trial: the reference ends {_error(truth, np.array([0.01, 0.02, np.pi])):.1e} m from the plan's goal")
    for share in (0.97, 1.05):
        _print_rubbed(case.with_friction(share), share)
    ours, scipy, mujoco = _ours(case, truth), _scipy(case, truth), _mujoco(case, truth)
    for peer in (ours, scipy, mujoco):
        print(f"trial: {peer.name}: error {peer.error_m:.1e} m")
    alone = _peer_kernel(case)
    spent = _alternate([(ours.run, TRIALS), (scipy.run, 3), (mujoco.run, 1), (alone, 1)])
    print(f"trial: {1e6 * float(np.median(spent[:, 3])):.1f} us in a batch on one core, without the call from Python\n")
    return {
        "trial_us": 1e6 * float(np.median(spent[:, 0])),
        "trial_error_m": ours.error_m,
        "trial_vs_scipy": float(np.median(spent[:, 1] / spent[:, 0])),
        "trial_vs_mujoco": float(np.median(spent[:, 2] / spent[:, 0])),
    }


def _print_rubbed(case: Case, share: float) -> None:
    """The same hand with another friction: then the slide turns, and its end is slow."""
    truth = simulate(case.hand, case.block, case.lone, case.r_f_b, tolerance=1e-12).r_f_b
    ours = _ours(case, truth)
    spent = float(np.median(_alternate([(ours.run, TRIALS)])))
    print(f"trial: friction {share:g} of the plan's: {1e6 * spent:.1f} us, {ours.name}, error {ours.error_m:.1e} m")


def _ours(case: Case, truth: FloatArray) -> Peer:
    """At the loosest tolerance that is good enough."""
    for tolerance in 10.0 ** np.arange(-3.0, -12.0, -1.0):

        def run(tolerance: float = float(tolerance)) -> FloatArray:
            return simulate(case.hand, case.block, case.lone, case.r_f_b, tolerance=tolerance).r_f_b

        error = _error(run(), truth)
        if error < ALLOWED_M:
            break
    return Peer(f"simulate, tolerance {tolerance:g}", error, run)


def _peer_kernel(case: Case) -> Callable[[], object]:
    """One trial's share of a batch on one core, at the same tolerance as the batch."""
    sets = _sets(case, np.full(TRIALS, case.lone.mu))

    def run() -> object:
        return simulate_many(case.hand, sets, tolerance=BATCH_TOLERANCE)

    def share() -> float:
        threads = numba.get_num_threads()
        numba.set_num_threads(1)
        began = time.perf_counter()
        run()
        spent = time.perf_counter() - began
        numba.set_num_threads(threads)
        return spent / TRIALS

    return share


def _scipy(case: Case, truth: FloatArray) -> Peer:
    """The fastest of scipy's methods that is good enough."""
    good = []
    for method in METHODS:
        for rtol in 10.0 ** np.arange(-3.0, -9.0, -1.0):
            trial = PlainTrial(case, method, float(rtol), stop_m_s=1e-4)
            error = _error(trial.run(), truth)
            if error < ALLOWED_M:
                spent = min(_timed(trial.run) for _ in range(3))
                good.append((spent, Peer(f"solve_ivp, {method}, rtol {rtol:g}", error, trial.run)))
                break
    return min(good, key=lambda one: one[0])[1]


def _mujoco(case: Case, truth: FloatArray) -> Peer:
    """At the time step where its own error is smallest; only the motion, without a rest after it."""
    best = None
    for timestep in (2e-4, 1e-4, 5e-5, 2e-5, 1e-5):
        rig, q_f = _rig(case, timestep)
        last = roll(rig, q_f, case.r_f_b)[-1]
        error = _error(_relative(rig, last), truth)
        print(f"MuJoCo, timestep {timestep:g} s: error {error:.1e} m")
        if best is None or error < best.error_m:
            best = Peer(f"MuJoCo, timestep {timestep:g} s", error, lambda rig=rig, q_f=q_f: roll(rig, q_f, case.r_f_b))
    return best


def _rig(case: Case, timestep: float) -> tuple[PlanarRig, FloatArray]:
    rig = planar_rig(case.block, case.fingers, ContactSettings(timestep, 4.0 * timestep, 1000.0))
    time_s = step_times(rig, case.hand)
    return rig, case.hand.at(time_s[time_s <= case.hand.breaks[-1] + 0.01])


def _relative(rig: PlanarRig, state: FloatArray) -> FloatArray:
    at = 1 + int(rig.model.joint("block").qposadr[0])
    q_o = np.array([*state[at : at + 2], 2.0 * np.arctan2(state[at + 6], state[at + 3])])
    return relative_pose(q_o, state[1:4])


def _step(case: Case) -> dict[str, float]:
    """One step of the same rig and the same hand."""
    rig, q_f = _rig(case, 1e-4)
    time_s = 1e-4 * np.arange(len(q_f))
    steps = len(q_f) - 1
    spent = _alternate(
        [
            (lambda: step_through(time_s, q_f, case.block, case.fingers, case.r_f_b), 5),
            (lambda: roll(rig, q_f, case.r_f_b), 1),
        ]
    )
    return {
        "step_ns": 1e9 * float(np.median(spent[:, 0])) / steps,
        "step_vs_mujoco": float(np.median(spent[:, 1] / spent[:, 0])),
    }


def _batch(case: Case) -> dict[str, float]:
    frictions = case.lone.mu * np.random.default_rng(1).uniform(1.0 - SPREAD, 1.0 + SPREAD, 100_000)
    simulate_many(case.hand, _sets(case, frictions[:100]))
    before = _peak_mb()
    spent = {}
    for count in (25_000, 50_000, 100_000):
        sets = _sets(case, frictions[:count])
        spent[count] = _timed(lambda sets=sets: simulate_many(case.hand, sets, tolerance=BATCH_TOLERANCE))
    peak = _peak_mb() - before
    some = _sets(case, frictions[:500])
    rough = simulate_many(case.hand, some, tolerance=BATCH_TOLERANCE)
    fine = simulate_many(case.hand, some, tolerance=1e-11)
    print(
        "batch: "
        + ", ".join(f"{count}: {taken:.2f} s" for count, taken in spent.items())
        + f"; {numba.get_num_threads()} "
        f"threads, tolerance {BATCH_TOLERANCE:g}, worst error {np.max(np.abs(rough.r_f_b - fine.r_f_b)[:, :2]):.1e} m\n"
    )
    return {"batch_100k_s": spent[100_000], "batch_peak_mb": peak}


def _sets(case: Case, frictions: FloatArray) -> ParameterSets:
    return ParameterSets.of(case.block, case.lone, case.r_f_b, mu=frictions)


def _error(r_f_b: FloatArray, truth: FloatArray) -> float:
    return float(np.hypot(*(r_f_b - truth)[:2]))


def _timed(run: Callable[[], object]) -> float:
    began = time.perf_counter()
    run()
    return time.perf_counter() - began


def _alternate(turns: list[tuple[Callable[[], object], int]]) -> FloatArray:
    """Seconds of one run each, (rounds, turns); what a run returns as a float is taken for its time."""
    spent = np.empty((ROUNDS, len(turns)))
    for row in spent:
        for column, (run, repeats) in enumerate(turns):
            began, told = time.perf_counter(), None
            for _ in range(repeats):
                told = run()
            row[column] = told if isinstance(told, float) else (time.perf_counter() - began) / repeats
    return spent


def _first_calls() -> tuple[float, float]:
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | {"NUMBA_CACHE_DIR": cache}
        runs = [
            subprocess.run(
                [sys.executable, "-c", FIRST_CALL], env=environment, check=True, capture_output=True, text=True
            )
            for _ in range(2)
        ]
    return float(runs[0].stdout), float(runs[1].stdout)


def _peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def _print(figures: dict[str, float]) -> None:
    rows = (
        ("accurate trial, us", "trial_us", "at most 100"),
        ("  its error, m", "trial_error_m", "below 1e-6"),
        ("  times faster than scipy", "trial_vs_scipy", "200"),
        ("  times faster than MuJoCo", "trial_vs_mujoco", "1000"),
        ("implicit step, ns", "step_ns", ""),
        ("  times faster than MuJoCo", "step_vs_mujoco", "100"),
        ("100,000 trials, s", "batch_100k_s", "below 10"),
        ("  memory on top, MB", "batch_peak_mb", "below 1000"),
    )
    print(f"{'figure':30s}{'reached':>12s}   aim")
    for name, key, aim in rows:
        print(f"{name:30s}{figures[key]:12.4g}   {aim}")


if __name__ == "__main__":
    main()
