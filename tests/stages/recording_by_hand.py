"""A loop that records as fast as a real one, in a process of its own: to be killed.

Called with the store's directory and how long to go on; it tells the recorder's process id, then every tick's number.
"""

import sys
import time
from pathlib import Path

import numpy as np

from slidepipe.artifacts.store import Store
from slidepipe.lab.protocols import BodyPose, ClockExchange, JointCommand, JointState, MocapFrame
from slidepipe.stages.recording_process import RecordingProcess, RecordingSetup

ATTACHMENTS = {"plan.yaml": b"schema: slidepipe.plan/1\n", "experiment.yaml": b"name: a\n"}
TICK_S = 0.002


def main() -> None:
    store, lasts_s = Store(Path(sys.argv[1])), float(sys.argv[2])
    with store.draft(stage="execute", stage_version=1, experiment="a", parameters={"a": 1}, seed=7) as draft:
        path = draft.add("recording", "trial.mcap")
        setup = RecordingSetup(path, {"run": draft.run_id, "experiment": "a"}, ATTACHMENTS, 1e7)
        with RecordingProcess(setup) as process:
            print(process.pid, flush=True)  # noqa: T201  # the test reads it
            for number in range(round(lasts_s / TICK_S)):
                now_ns = time.time_ns()
                say(process, number, now_ns)
                print(now_ns, flush=True)  # noqa: T201
                time.sleep(TICK_S)
            if process.fault is not None:
                raise SystemExit(process.fault)


def say(process: RecordingProcess, number: int, now_ns: int) -> None:
    numbers = np.random.default_rng(number).normal(size=(6, 7))
    process.recorder.joints(JointCommand(*numbers[:3]), JointState(now_ns, *numbers[3:]))
    process.recorder.tick(now_ns, 1000)
    body = BodyPose(numbers[0, :3], numbers[0, :4])
    process.recorder.frame(MocapFrame(number, number * 20_000, now_ns, body, body))
    if number % 50 == 0:
        process.recorder.clock(ClockExchange(now_ns - 200_000, number * 20_000, now_ns))


if __name__ == "__main__":
    main()
