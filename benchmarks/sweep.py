"""Sweep 2,000 worlds on one process, on all cores and on a local Dask cluster that loses a worker midway; compare.

The worlds are of the exact mechanics with a perfect hand: friction -20 to +20 % of the belief, normal force +-5 %,
first grasp +-2 mm and +-30 mrad. In the simulated lab a world takes seconds: three times 2,000 would be
hours.
The times are of the whole command: drawing, planning, simulating, and publishing every world as a run of the store.
"""

import argparse
import json
import os
import signal
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from distributed import LocalCluster

from slidepipe.artifacts.store import Store
from slidepipe.stages.sweep import SweepRequest, SweepResult, run

EXPERIMENT = Path(__file__).resolve().parents[1] / "experiments" / "regrasp.yaml"
SETS = (
    "lab.friction=0.304..0.456",
    "lab.normal_force_per_finger_n=0.59375..0.65625",
    "lab.grasp_error.x_m=-0.002..0.002",
    "lab.grasp_error.y_m=-0.002..0.002",
    "lab.grasp_error.theta_rad=-0.03..0.03",
)


@dataclass(slots=True)
class Killer:
    """Ends one worker of a cluster, without a word, when half of the worlds are done."""

    cluster: Any
    killed: int | None = None

    def __call__(self, done: int, total: int) -> None:
        """Look whether it is time."""
        if self.killed is None and 2 * done >= total:
            worker = next(iter(self.cluster.workers.values()))
            self.killed = worker.pid
            os.kill(self.killed, signal.SIGKILL)


def main() -> None:
    """Print the three times, and whether all numbers are the same."""
    options = _options()
    print(f"{options.worlds} worlds of the exact mechanics; {os.cpu_count()} cores")
    _sweep(options.worlds // 20, 1)  # compiled code is loaded, as it is for whoever sweeps twice
    one = _sweep(options.worlds, 1)
    _tell("one process", one)
    cores = _sweep(options.worlds, os.cpu_count() or 1)
    _tell("all cores", cores)
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        killer = Killer(cluster)
        dask = _sweep(options.worlds, 1, scheduler=cluster.scheduler_address, report=killer)
    _tell(f"Dask, two workers, process {killer.killed} killed midway", dask)
    hashes = {result.document.numbers_sha256 for result in (one, cores, dask)}
    print("all numbers identical" if len(hashes) == 1 else f"NUMBERS DIFFER: {sorted(hashes)}")
    if options.json:
        told = {
            "sweep_worlds": options.worlds,
            "sweep_one_process_s": one.document.seconds,
            "sweep_all_cores_s": cores.document.seconds,
            "sweep_cluster_one_killed_s": dask.document.seconds,
            "sweep_identical": len(hashes) == 1,
        }
        options.json.write_text(json.dumps(told, indent=2) + "\n", encoding="utf-8")
    if len(hashes) != 1 or killer.killed is None:
        raise SystemExit(1)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worlds", type=int, default=2000)
    parser.add_argument("--json", type=Path)
    return parser.parse_args()


def _sweep(
    worlds: int, workers: int, *, scheduler: str | None = None, report: Any = lambda _done, _all: None
) -> SweepResult:
    with tempfile.TemporaryDirectory(prefix="slidepipe-bench-") as place:
        return run(
            SweepRequest(
                experiment=EXPERIMENT,
                store=Store(Path(place) / "data"),
                report=report,
                sets=SETS,
                trials=worlds,
                world="mechanics",
                workers=workers,
                scheduler=scheduler,
            )
        )


def _tell(name: str, result: SweepResult) -> None:
    told = result.document
    setting = told.settings[0]
    print(f"{name:55s} {told.seconds:7.2f} s  lost {100 * setting.lost_share:.2f} %  sha256 {told.numbers_sha256[:16]}")


if __name__ == "__main__":
    main()
