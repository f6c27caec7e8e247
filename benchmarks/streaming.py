"""The 500 Hz stream beside cyclictest: how late ticks begin, how much the recorder takes, and what is lost.

The loop streams to an emulated arm over loopback for a minute, with camera frames at 360 Hz and everything recorded,
while ``cyclictest`` (Debian's rt-tests) wakes up at the same interval, at the same moment, on the other core and in the
same scheduling class: the tails are the machine's, and only such pairs tell. First idle, then with a busy process on
the loop's core. The arm and the cameras are played by a process that computes next to nothing, so that the loop is
measured and not the world.
"""

import argparse
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import tempfile
import time
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from support.lab_player import play

from slidepipe.arm import wam
from slidepipe.lab.clock import SPIN_NS, Beat, RealClock
from slidepipe.lab.course import Course, Leg, Phase
from slidepipe.lab.link import LinkedArm
from slidepipe.lab.loop import Lab, LoopSettings, run
from slidepipe.lab.natnet.client import NatNetClient
from slidepipe.lab.natnet.settings import NatNetSettings, TrackedBody
from slidepipe.lab.realtime import realtime
from slidepipe.lab.safety import Guard, SafetyLimits
from slidepipe.lab.transport import Address, UdpTransport
from slidepipe.lab.wam_codec import CODECS
from slidepipe.stages.recording_process import RecordingProcess, RecordingSetup
from slidepipe.tick import TICK_S

INTERVAL_US = round(1e6 * TICK_S)
CORES = sorted(os.sched_getaffinity(0))
LOOP_CORE, OTHER_CORE = CORES[0], CORES[-1]
PRIORITY = 80
HOST = "127.0.0.1"
OURS, THEIRS = Address(HOST, 45555), Address(HOST, 45556)
CAMERA_PORT = 41510
AIM_RATIO, AIM_RECORDER, LATE_S = 1.5, 0.15, 0.001
HOME = np.array([1.27, -0.65, -1.46, 1.66, 0.94, 0.16, 0.2])
KEYS = ("p50_us", "p99_us", "p999_us", "max_us", "late_share", "cyclictest_p99_us", "p99_vs_cyclictest",
        "recorder_cpu_share", "lost_messages")  # fmt: skip


@dataclass(frozen=True, slots=True)
class Figures:
    """One run: percentiles of the lateness in us, shares of a core, and what never arrived where it should."""

    late_us: np.ndarray
    cyclictest_p99_us: float | None
    loop_cpu_share: float
    recorder_cpu_share: float
    lost_messages: int
    not_permitted: tuple[str, ...]

    @property
    def p99_vs_cyclictest(self) -> float | None:
        """The loop's 99th percentile over that of cyclictest."""
        if not self.cyclictest_p99_us:
            return None
        return float(np.percentile(self.late_us, 99)) / self.cyclictest_p99_us


def settings() -> NatNetSettings:
    """Where the cameras are."""
    return NatNetSettings(
        HOST, HOST, TrackedBody("hand"), TrackedBody("object"), command_port=CAMERA_PORT, data_port=CAMERA_PORT + 1
    )


def measure(seconds: float, *, busy: bool) -> Figures:
    """Stream for so long beside cyclictest."""
    with ExitStack() as around:
        around.enter_context(_playing())
        if busy:
            around.enter_context(_busy_core())
        cyclictest = _Cyclictest(seconds)
        os.sched_setaffinity(0, {LOOP_CORE})
        try:
            return _stream(seconds, cyclictest)
        finally:
            os.sched_setaffinity(0, CORES)


def _stream(seconds: float, cyclictest: "_Cyclictest") -> Figures:
    clock, codec = RealClock(SPIN_NS), CODECS["bridge"]
    course = Course.of([Leg.hold(Phase.MOTION, HOME, seconds)])
    with (
        closing(UdpTransport(OURS, THEIRS)) as transport,
        NatNetClient(settings(), clock) as cameras,
        tempfile.TemporaryDirectory() as directory,
    ):
        beat = Beat(clock, seconds + 1.0)
        arm = LinkedArm(transport, codec, clock, beat=beat)
        arm.connect(5.0)
        arm.prepare(course.commands)
        path = Path(directory) / "trial.mcap"
        with RecordingProcess(RecordingSetup(path, {"run": "benchmark"}, {}, cameras.ticks_per_s)) as recorder:
            os.sched_setaffinity(recorder.pid, CORES)
            guard = Guard(_no_limits())
            lab = Lab(arm, cameras, recorder.recorder, beat, guard, settings=LoopSettings())
            with realtime(PRIORITY) as refused:
                cyclictest.begin()
                before, loop_before = _cpu_s(recorder.pid), time.process_time()
                cameras.take()
                arm.listen_anew()
                missing = cameras.counts.frames.missing
                guard.begin(clock.now_ns())
                run(course, lab)
            loop_s, recorder_s = time.process_time() - loop_before, _cpu_s(recorder.pid) - before
            report = recorder.close()
        frames_missing = cameras.counts.frames.missing - missing
    return Figures(
        late_us=1e-3 * beat.lateness_ns,
        cyclictest_p99_us=cyclictest.p99_us(),
        loop_cpu_share=loop_s / seconds,
        recorder_cpu_share=recorder_s / seconds,
        lost_messages=arm.counts.lost + frames_missing + sum(report.lost.values()),
        not_permitted=refused,
    )


def _no_limits() -> SafetyLimits:
    far = np.full(wam.JOINT_COUNT, 10.0)
    return SafetyLimits(far, -far, far, 10.0, 10.0, 10.0, 10.0)


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def _playing():
    """The arm and the cameras, in a process of their own on the other core."""
    context = multiprocessing.get_context("spawn")
    over, ready = context.Event(), context.Event()
    process = context.Process(target=play, args=(THEIRS, OURS, settings(), HOME, (over, ready, OTHER_CORE)))
    process.start()
    try:
        if not ready.wait(30.0):
            raise SystemExit("the player did not begin within 30 s")
        yield
    finally:
        over.set()
        process.join()


@contextmanager
def _busy_core():
    """One ordinary process that computes all the time, on the loop's core."""
    context = multiprocessing.get_context("spawn")
    process = context.Process(target=_burn, args=(LOOP_CORE,), daemon=True)
    process.start()
    try:
        yield
    finally:
        process.kill()
        process.join()


def _burn(core: int) -> None:
    os.sched_setaffinity(0, {core})
    while True:
        sum(range(10_000))


class _Cyclictest:
    """cyclictest on the other core, in the loop's scheduling class as far as that is permitted."""

    def __init__(self, seconds: float) -> None:
        self._loops = round(seconds / TICK_S)
        self._process: subprocess.Popen[str] | None = None

    def begin(self) -> None:
        """Start it; nothing where it is not installed."""
        program = shutil.which("cyclictest") or shutil.which("cyclictest", path="/usr/sbin:/usr/bin")
        if program is None:
            return
        command = [program, "--quiet", f"--interval={INTERVAL_US}", f"--loops={self._loops}", "--histogram=20000",
                   f"--affinity={OTHER_CORE}", "--threads=1"]  # fmt: skip
        if os.sched_getscheduler(0) == os.SCHED_FIFO:
            command += [f"--priority={PRIORITY}", "--policy=fifo", "--mlockall"]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    def p99_us(self) -> float | None:
        """99th percentile of its lateness, us."""
        if self._process is None:
            return None
        text = self._process.communicate()[0]
        rows = [line.split()[:2] for line in text.splitlines() if re.match(r"^\d+ \d+", line)]
        late = np.array([int(row[0]) for row in rows])
        counts = np.cumsum([int(row[1]) for row in rows])
        if not len(counts) or not counts[-1]:
            return None
        return float(late[np.searchsorted(counts, 0.99 * counts[-1])])


def summary(runs: list[Figures]) -> dict[str, float | None]:
    """Medians over the runs, but for what was lost, which adds up."""

    def median(values: list[float | None]) -> float | None:
        known = [value for value in values if value is not None]
        return float(np.median(known)) if known else None

    p50, p99, p999, top = (
        median([float(np.percentile(one.late_us, share)) for one in runs]) for share in (50, 99, 99.9, 100)
    )
    values = (
        p50,
        p99,
        p999,
        top,
        median([float(np.mean(one.late_us > 1e6 * LATE_S)) for one in runs]),
        median([one.cyclictest_p99_us for one in runs]),
        median([one.p99_vs_cyclictest for one in runs]),
        median([one.recorder_cpu_share for one in runs]),
        sum(one.lost_messages for one in runs),
    )
    return dict(zip(KEYS, values, strict=True))


def show(name: str, told: dict[str, float | None], runs: list[Figures]) -> None:
    """Print a table: figure, peer, ratio, aim."""

    def text(key: str, digits: int = 1) -> str:
        value = told[key]
        return "-" if value is None else f"{value:.{digits}f}"

    loop = np.median([one.loop_cpu_share for one in runs])
    print(f"\n{name}: median of {len(runs)}{'':18}figure   cyclictest   ratio   aim")
    print(f"  wake-up p99, us{'':22}{text('p99_us'):>8}{text('cyclictest_p99_us'):>13}"
          f"{text('p99_vs_cyclictest', 2):>8}   <= {AIM_RATIO}")  # fmt: skip
    print(f"  wake-up p50, p99.9, max, us{'':10}{text('p50_us'):>8}, {text('p999_us')}, {text('max_us')}")
    print(f"  ticks later than 1 ms{'':16}{text('late_share', 6):>8}")
    print(f"  recorder, share of a core{'':12}{text('recorder_cpu_share', 3):>8}{'':21}   <= {AIM_RECORDER}")
    print(f"  loop, share of a core{'':16}{loop:8.3f}")
    print(f"  messages lost{'':24}{text('lost_messages', 0):>8}{'':21}   0")
    for line in sorted({line for one in runs for line in one.not_permitted}):
        print(f"  not permitted here: {line}")
    if told["cyclictest_p99_us"] is None:
        print("  cyclictest is not installed: make bench installs Debian's rt-tests where apt-get is permitted")


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--seconds", type=float, default=60.0, help="of each run (60)")
    parser.add_argument("--runs", type=int, default=5, help="pairs, idle and busy each (5)")
    asked = parser.parse_args()
    found: dict[str, float | None] = {}
    for name, busy in (("idle", False), ("busy", True)):
        runs = [measure(asked.seconds, busy=busy) for _ in range(asked.runs)]
        told = summary(runs)
        show(name, told, runs)
        found |= {f"{key}_{name}": value for key, value in told.items()}
    if asked.json:
        asked.json.write_text(json.dumps(found, indent=2) + "\n")


if __name__ == "__main__":
    main()
