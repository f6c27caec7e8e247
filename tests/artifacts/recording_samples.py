"""Series to record."""

from pathlib import Path

import numpy as np

from slidepipe.artifacts import topics
from slidepipe.artifacts.recording import (
    Event,
    PlanarSeries,
    RecordingWriter,
    Series,
    write_series,
)
from slidepipe.series import ClockSync, FrameSeries, JointSeries, MocapSeries, PoseSeries

PROVENANCE = {"slidepipe": "0.1.0", "seed": "1"}
ATTACHMENTS = {"plan.yaml": b"schema: slidepipe.plan/1\n", "experiment.yaml": b"name: a\n"}


def poses(count: int, seed: int = 0, first: int = 0) -> PoseSeries:
    rng = np.random.default_rng(seed)
    sequence = np.arange(first, first + count)
    return PoseSeries(
        stamp_ns=sequence * 2_777_778 + 5,
        position_m=rng.normal(size=(count, 3)),
        quaternion_xyzw=rng.normal(size=(count, 4)),
        sequence=sequence,
    )


def joints(count: int, seed: int = 0) -> JointSeries:
    rng = np.random.default_rng(seed)
    return JointSeries(np.arange(count) * 2_000_000, *(rng.normal(size=(count, 7)) for _ in range(3)))


def mocap(count: int) -> MocapSeries:
    frame = np.arange(1, count + 1)
    received = frame * 2_777_778 + 6_000_000
    hand, body = poses(count, 1, first=1), poses(max(count - 2, 0), 2, first=1)
    frames = FrameSeries(frame, frame * 27_777 + 123_456_789, received, frame > 0, frame <= count - 2)
    stamps = np.arange(1, 6) * 100_000_000
    clock = ClockSync(stamps, stamps // 100, stamps + 700_000, 1e7)
    return MocapSeries(frames, hand, body, clock)


def write(path: Path, series: Series) -> Path:
    with RecordingWriter(path, PROVENANCE, ATTACHMENTS) as writer:
        write_series(writer, series)
    return path


def everything(count: int = 200) -> Series:
    planar = PlanarSeries(np.arange(count), *(np.random.default_rng(4).normal(size=(count, 3)) for _ in range(3)))
    return Series(
        mocap=mocap(count),
        poses={"/truth/object": poses(count, 5)},
        joints={topics.COMMANDED: joints(count, 6), topics.MEASURED: joints(count, 7)},
        planar={"/smoothed/object": planar},
        events=[Event(0, "info", "lab", "begun"), Event(9, "warning", "lab", "the block was lost")],
    )
