"""Time smoothing against filterpy, statsmodels, pykalman and simdkalman, and full estimates of one and 1,000 trials.

The smoothers all answer the same question in one process: three axes of constant acceleration, even steps with some
gaps, states and variances. ``--json`` writes the figures. What a peer cannot do in reasonable time it is not asked
for; a peer that is not installed is named.
"""

import argparse
import json
import multiprocessing
import os
import pickle
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from importlib.util import find_spec
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "estimation"))

from support import smoothers
from synthetic import CASE_A, CASE_B, Cameras, request, simulate

from slidepipe.estimation.estimate import estimate
from slidepipe.estimation.request import EstimationRequest

SAMPLES = (1_000, 10_000, 100_000)
SLOWEST_S = 60.0
"""A peer that would take longer than this is not asked."""
TRIALS = 1_000
WORLDS = 20
"""Different motions among the trials; cameras, noise and dropouts differ in every one."""


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="where to write the figures")
    parser.add_argument("--trials", type=int, default=TRIALS, help="full estimates to run")
    options = parser.parse_args()
    figures = _smoothing() | _estimates(options.trials)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


def _smoothing() -> dict[str, float]:
    figures: dict[str, float] = {}
    peers = {name: peer for name, peer in smoothers.PEERS.items() if name == "filterpy" or find_spec(name)}
    for missing in sorted(set(smoothers.PEERS) - set(peers)):
        print(f"{missing} is not installed: `make bench` installs it")
    last = dict.fromkeys(peers, 0.0)
    for warm in peers.values():
        warm(smoothers.Data.of(50))
    print(f"{'smoother':14s}{'samples':>10s}{'ms':>12s}{'times ours':>12s}{'state off':>12s}{'sd off':>12s}")
    for count in SAMPLES:
        data = smoothers.Data.of(count)
        ours = smoothers.ours(data)
        spent = min(_timed(lambda data=data: smoothers.ours(data)) for _ in range(7))
        print(f"{'slidepipe':14s}{count:10d}{1e3 * spent:12.2f}{1.0:12.1f}", flush=True)
        reference = None
        for name, peer in peers.items():
            if last[name] * 10.0 > SLOWEST_S:
                print(f"{name:14s}{count:10d}{'-':>12s}   would take over {SLOWEST_S:g} s")
                continue
            began = time.perf_counter()
            told = peer(data)
            last[name] = time.perf_counter() - began
            reference = told if name == "filterpy" else reference
            off = _largest(told, ours) if name == "filterpy" else _largest(told, reference)
            print(
                f"{name:14s}{count:10d}{1e3 * last[name]:12.1f}{last[name] / spent:12.1f}{off[0]:12.1e}{off[1]:12.1e}",
                flush=True,
            )
            if name == "filterpy":
                figures["smooth_max_diff"] = max(figures.get("smooth_max_diff", 0.0), *off)
                if count == 10_000:
                    figures["smooth_vs_filterpy_10k"] = last[name] / spent
    print("(filterpy's row: its distance from ours; the others': theirs from filterpy's, nan where it was not asked)\n")
    return figures


def _largest(told: smoothers.Answer, other: smoothers.Answer | None) -> tuple[float, float]:
    if other is None:
        return np.nan, np.nan
    return float(np.max(np.abs(told.state - other.state))), float(np.max(np.abs(told.sd - other.sd)))


def _estimates(count: int) -> dict[str, float]:
    _told(_kept((0, 0)))
    alone = [_timed(lambda seed=seed: _estimated(seed)) for seed in range(12)]
    workers = os.cpu_count() or 1
    # The trials share the cores: numpy's own threads would only wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        # Trials are made beforehand and stored as bytes: what is timed is to read and estimate them.
        kept = list(pool.map(_kept, [(index % WORLDS, index) for index in range(count)], chunksize=WORLDS))
        list(pool.map(_told, kept[: 4 * workers]))
        began = time.perf_counter()
        told = list(pool.map(_told, kept, chunksize=4))
        spent = time.perf_counter() - began
    print(f"{'figure':34s}{'reached':>10s}   aim")
    print(f"{'full estimate of a trial, warm, s':34s}{np.median(alone):10.3f}   below 1")
    print(f"{f'{count} trials on {workers} cores, s':34s}{spent:10.1f}   of which {sum(told)} told their friction")
    figures = {"estimate_trial_s": float(np.median(alone))}
    if count == TRIALS:
        figures["estimate_1000_s"] = spent
    return figures


def _request(world: int, seed: int) -> EstimationRequest:
    """Ask for the estimate of one trial."""
    case = (CASE_A, CASE_B)[world % 2]
    rng = np.random.default_rng([world, 13])
    motion = _world(world, case, 0.38 * rng.uniform(0.95, 1.05))
    return request(motion, Cameras(seed=seed, dropout_share=0.05, outlier_share=0.01))


_WORLDS: dict[int, object] = {}


def _world(world: int, case: object, friction: float) -> object:
    if world not in _WORLDS:
        _WORLDS[world] = simulate(case, friction, world)
    return _WORLDS[world]


def _kept(job: tuple[int, int]) -> bytes:
    """One recorded trial."""
    return pickle.dumps(_request(*job))


def _told(kept: bytes) -> bool:
    """Whether the estimate of one trial tells its friction."""
    return estimate(pickle.loads(kept)).friction is not None  # noqa: S301  # what _kept wrote


def _estimated(seed: int) -> float:
    """Seconds of one estimate alone."""
    asked = _request(seed, seed)
    began = time.perf_counter()
    estimate(asked)
    return time.perf_counter() - began


def _timed(run: Callable[[], object]) -> float:
    began = time.perf_counter()
    told = run()
    return told if isinstance(told, float) else time.perf_counter() - began


if __name__ == "__main__":
    main()
