"""Time the run store beside signac and MLflow's file store, on the same work.

A run is ten parameters, three results and a file of 1 kB. *Publish* makes runs one after the other. *List* is a new
process that prints the hundred runs that ended last, with state and results, from a full store.

What a publication is worth differs. slidepipe waits until the run is on the disk (fsync of its files and directories),
and shows it whole or not at all. signac and MLflow's file store write files without waiting, which a power failure may
lose, and a reader sees runs that are half written. ``publish_vs_*`` compares at the same durability: after each of the
peer's runs, all that it wrote and its directories are synced by the same function. What a peer does as shipped, without
waiting, is told beside it, with ours without waiting.

``ls_s`` and ``rebuild_s`` are of the full store (``--runs``); ``ls_vs_*`` compares equal counts (``--peer-runs``), for
MLflow would take an hour to make a hundred thousand runs.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from multiprocessing import get_context
from pathlib import Path

import slidepipe.artifacts.draft as drafts
from slidepipe.artifacts.index import Index
from slidepipe.artifacts.store import Store

TURNS = 5
"""In which we and the peers publish in alternation."""
SHOWN = 100
LISTINGS = 3
LIST_SIGNAC = """
import sys, signac
jobs = sorted(signac.get_project(sys.argv[1]), key=lambda job: job.doc["finished"])[-100:]
for job in jobs:
    print(job.id, job.doc["state"], dict(job.doc["results"]))
"""
LIST_MLFLOW = """
import sys
from mlflow.tracking import MlflowClient
client = MlflowClient(sys.argv[1])
for run in client.search_runs(["0"], order_by=["attributes.end_time DESC"], max_results=100):
    print(run.info.run_id, run.info.status, run.data.metrics)
"""

Publish = Callable[[int], None]


@dataclass(frozen=True, slots=True)
class Peer:
    """Another store: its name, how it publishes runs with and without a sync, and the command that lists the last."""

    name: str
    publish: Publish
    publish_synced: Publish
    listing: list[str]


def main() -> None:
    """Measure and print."""
    asked = _arguments()
    with tempfile.TemporaryDirectory(dir=asked.directory) as scratch:
        figures = _measure(asked, Path(scratch))
    _print(figures, asked)
    if asked.json:
        asked.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


def publish(root: Path, count: int) -> None:
    """Publish runs of ours."""
    store = Store(root)
    for _ in range(count):
        with store.draft(stage="plan", stage_version=1, experiment="bench", parameters=_parameters()) as draft:
            draft.add("plan", "plan.yaml").write_text("x" * 1000, encoding="utf-8")
            for name, value in _results().items():
                draft.report(name, value, unit="m")


def publish_unsynced(root: Path, count: int) -> None:
    """Publish without waiting for the disk, which the peers do not either."""
    waits, drafts.sync = drafts.sync, lambda _: None
    try:
        publish(root, count)
    finally:
        drafts.sync = waits


def _measure(asked: argparse.Namespace, scratch: Path) -> dict[str, float]:
    figures = _publishing(asked, scratch)
    root = scratch / "full"
    _fill(root, asked.runs)
    index = Index(root)
    began = time.perf_counter()
    count = index.rebuild()
    figures["rebuild_s"] = time.perf_counter() - began
    figures["runs"] = count
    time.sleep(4.0)  # until the directories are settled, as they are when somebody looks
    figures["ls_s"] = _listed(_ls(root))
    equal = scratch / "equal"
    _fill(equal, asked.peer_runs)
    figures["ls_equal_s"] = _listed(_ls(equal))
    for peer in _peers(scratch / "listed"):
        _share(peer.publish, asked.peer_runs)
        figures[f"ls_{peer.name}_s"] = _listed(peer.listing)
        figures[f"ls_vs_{peer.name}"] = figures[f"ls_{peer.name}_s"] / figures["ls_equal_s"]
    return figures


def _ls(root: Path) -> list[str]:
    return [str(Path(sys.executable).parent / "slidepipe"), "--data", str(root), "ls"]


def _publishing(asked: argparse.Namespace, scratch: Path) -> dict[str, float]:
    """Runs per second, each the median of turns in alternation."""
    ways: dict[str, Publish] = {
        "publish_per_s": lambda count: publish(scratch / "ours", count),
        "publish_unsynced_per_s": lambda count: publish_unsynced(scratch / "ours", count),
    }
    peers = _peers(scratch)
    ways |= {f"publish_{peer.name}_per_s": peer.publish for peer in peers}
    ways |= {f"publish_{peer.name}_synced_per_s": peer.publish_synced for peer in peers}
    spent: dict[str, list[float]] = {name: [] for name in ways}
    for way in ways.values():
        way(2)  # imports and first directories are not counted
    for _ in range(TURNS):
        for name, way in ways.items():
            began = time.perf_counter()
            way(asked.published)
            spent[name].append(time.perf_counter() - began)
    figures = {name: asked.published / sorted(times)[TURNS // 2] for name, times in spent.items()}
    for peer in peers:
        synced, unsynced = figures[f"publish_{peer.name}_synced_per_s"], figures[f"publish_{peer.name}_per_s"]
        figures[f"publish_vs_{peer.name}"] = figures["publish_per_s"] / synced
        figures[f"publish_unsynced_vs_{peer.name}"] = figures["publish_unsynced_per_s"] / unsynced
        figures[f"publish_as_shipped_vs_{peer.name}"] = figures["publish_per_s"] / unsynced
    return figures


def _fill(root: Path, runs: int) -> None:
    _share(lambda count: publish_unsynced(root, count), runs)


def _share(publish: Publish, runs: int) -> None:
    """Publish so many runs with all cores; the first one, which makes the directories, alone."""
    publish(1)
    fork, cores = get_context("fork"), os.cpu_count() or 1
    shares = [(runs - 1) // cores + (core < (runs - 1) % cores) for core in range(cores)]
    workers = [fork.Process(target=publish, args=(share,)) for share in shares]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
        if worker.exitcode != 0:
            raise SystemExit("a process that fills a store has failed")


def _settle(written: Sequence[Path], above: Path) -> None:
    """Wait for what a peer wrote, as our store does for its own: all of it at once, then the directory above."""
    drafts.sync(written)
    drafts.sync([above])


def _peers(scratch: Path) -> list[Peer]:
    found = []
    for name, make in (("signac", _signac), ("mlflow", _mlflow)):
        if find_spec(name) is None:
            sys.stderr.write(f"{name} is not installed (make bench installs it): left out\n")
        else:
            found.append(make(scratch / name))
    return found


def _signac(root: Path) -> Peer:
    import signac  # noqa: PLC0415  # a peer that may not be installed

    def publish_jobs(count: int, *, synced: bool = False) -> None:
        root.mkdir(parents=True, exist_ok=True)
        project = signac.init_project(str(root))
        for _ in range(count):
            job = project.open_job({"stage": "plan", "experiment": "bench", **_parameters()}).init()
            Path(job.fn("plan.yaml")).write_text("x" * 1000, encoding="utf-8")
            job.doc.update({"state": "complete", "finished": time.time(), "results": _results()})
            if synced:
                made = Path(job.path)
                _settle([made, *made.iterdir()], made.parent)

    return Peer(
        "signac", publish_jobs, partial(publish_jobs, synced=True), [sys.executable, "-c", LIST_SIGNAC, str(root)]
    )


def _mlflow(root: Path) -> Peer:
    os.environ |= {"MLFLOW_ALLOW_FILE_STORE": "true", "MLFLOW_DISABLE_TELEMETRY": "true", "DO_NOT_TRACK": "true"}
    from mlflow.entities import Metric, Param, RunTag  # noqa: PLC0415  # a peer that may not be installed
    from mlflow.tracking import MlflowClient  # noqa: PLC0415

    def publish_runs(count: int, *, synced: bool = False) -> None:
        client = MlflowClient(root.as_uri())
        for _ in range(count):
            run = client.create_run("0", tags={"stage": "plan", "experiment": "bench"}).info
            client.log_batch(
                run.run_id,
                [Metric(name, value, int(1e3 * time.time()), 0) for name, value in _results().items()],
                [Param(name, str(value)) for name, value in _parameters().items()],
                [RunTag("state", "complete")],
            )
            client.log_text(run.run_id, "x" * 1000, "plan.yaml")
            client.set_terminated(run.run_id)
            if synced:
                made = root / "0" / run.run_id
                _settle([made, *made.rglob("*")], made.parent)

    return Peer(
        "mlflow", publish_runs, partial(publish_runs, synced=True), [sys.executable, "-c", LIST_MLFLOW, root.as_uri()]
    )


def _parameters() -> dict[str, float]:
    """Ten numbers, different for every run, as signac takes equal parameters for the same job."""
    now = time.time_ns() + os.getpid()
    return {f"parameter_{index}": 0.1 * index + now * 1e-9 for index in range(10)}


def _results() -> dict[str, float]:
    return {"error": 0.00123, "friction": 0.4273, "duration": 0.84}


def _listed(command: list[str]) -> float:
    """Median seconds of a command from its start to its end; once before, for the disk's cache."""
    spent = []
    for _ in range(LISTINGS + 1):
        began = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        spent.append(time.perf_counter() - began)
    if len(done.stdout.splitlines()) < SHOWN:
        raise SystemExit(f"{command[0]} listed {len(done.stdout.splitlines())} runs, {SHOWN} were expected")
    return sorted(spent[1:])[LISTINGS // 2]


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Time the run store beside signac and MLflow's file store.")
    parser.add_argument("--runs", type=int, default=100_000, help="in the store that is listed")
    parser.add_argument("--peer-runs", type=int, default=10_000, help="where listing is compared")
    parser.add_argument("--published", type=int, default=100, help="runs in each of the turns of publishing")
    parser.add_argument("--directory", type=Path, help="where the stores are made: on the disk to be measured")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    return parser.parse_args()


def _print(figures: dict[str, float], asked: argparse.Namespace) -> None:
    rows = (
        ("publish, runs/s, on the disk", "publish_per_s", ""),
        ("publish, runs/s, not waited for", "publish_unsynced_per_s", ""),
        ("  signac, runs/s, on the disk", "publish_signac_synced_per_s", ""),
        ("  signac, runs/s, not waited for", "publish_signac_per_s", ""),
        ("  MLflow, runs/s, on the disk", "publish_mlflow_synced_per_s", ""),
        ("  MLflow, runs/s, not waited for", "publish_mlflow_per_s", ""),
        ("  both on the disk, times signac", "publish_vs_signac", ""),
        ("  both on the disk, times MLflow", "publish_vs_mlflow", ""),
        ("  neither waited for, times signac", "publish_unsynced_vs_signac", ""),
        ("  neither waited for, times MLflow", "publish_unsynced_vs_mlflow", ""),
        ("  each as shipped, times signac", "publish_as_shipped_vs_signac", ""),
        ("  each as shipped, times MLflow", "publish_as_shipped_vs_mlflow", ""),
        (f"slidepipe ls of {asked.runs} runs, s", "ls_s", "below 0.3"),
        (f"  slidepipe ls of {asked.peer_runs} runs, s", "ls_equal_s", ""),
        (f"  signac, of {asked.peer_runs} runs, s", "ls_signac_s", ""),
        (f"  MLflow, of {asked.peer_runs} runs, s", "ls_mlflow_s", ""),
        ("  times faster than signac, equal counts", "ls_vs_signac", ""),
        ("  times faster than MLflow, equal counts", "ls_vs_mlflow", ""),
        (f"index of {asked.runs} runs made anew, s", "rebuild_s", ""),
    )
    print(f"{'figure':42s}{'reached':>12s}   aim")
    for name, key, aim in rows:
        if key in figures:
            print(f"{name:42s}{figures[key]:12.4g}   {aim}")


if __name__ == "__main__":
    main()
