"""Whole series into a recording, merged in the order in which the host received them."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from operator import itemgetter

from slidepipe.artifacts import messages, topics
from slidepipe.artifacts.recording_reader import Event, PlanarSeries
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.errors import StoreError
from slidepipe.series import IntArray, JointSeries, MocapSeries, PoseSeries

_Entry = tuple[int, Callable[[], None]]
"""When the host received a message, and what records it."""


@dataclass(frozen=True, slots=True)
class Series:
    """What goes into one recording; series and events count as received at their own stamps.

    Attributes
    ----------
    mocap : MocapSeries or None
        Poses count as received with their frames.
    poses, joints, planar : Mapping
        By topic.
    events : Iterable[Event]
    """

    mocap: MocapSeries | None = None
    poses: Mapping[str, PoseSeries] = field(default_factory=dict)
    joints: Mapping[str, JointSeries] = field(default_factory=dict)
    planar: Mapping[str, PlanarSeries] = field(default_factory=dict)
    events: Iterable[Event] | None = None


def write_series(writer: RecordingWriter, series: Series) -> None:
    """Record whole series; a topic without samples is announced all the same."""
    entries: list[_Entry] = []
    if series.mocap is not None:
        entries += _mocap(writer, series.mocap)
    for topic, poses in series.poses.items():
        entries += _poses(writer, topic, poses, poses.stamp_ns)
    for topic, joints in series.joints.items():
        entries += _joints(writer, topic, joints)
    for topic, planar in series.planar.items():
        entries += _planar(writer, topic, planar)
    if series.events is not None:
        entries += _events(writer, series.events)
    for _, record in sorted(entries, key=itemgetter(0)):
        record()


def _mocap(writer: RecordingWriter, mocap: MocapSeries) -> Iterator[_Entry]:
    frames = mocap.frames
    received = dict(zip(frames.frame.tolist(), frames.received_ns.tolist(), strict=True))
    exposed = received | {
        frame: stamp
        for body in (mocap.object, mocap.hand)
        for frame, stamp in zip(body.sequence.tolist(), body.stamp_ns.tolist(), strict=True)
    }
    writer.announce(topics.FRAME, messages.FRAME)
    for index, (frame, log_ns) in enumerate(received.items()):
        record = partial(
            writer.frame,
            stamp_ns=exposed[frame],
            received_ns=log_ns,
            frame=frame,
            ticks=int(frames.ticks[index]),
            hand_valid=bool(frames.hand_valid[index]),
            object_valid=bool(frames.object_valid[index]),
        )
        yield log_ns, record
    for topic, body in ((topics.HAND, mocap.hand), (topics.OBJECT, mocap.object)):
        yield from _poses(writer, topic, body, _received(topic, body, received))
    yield from _clock(writer, mocap)


def _received(topic: str, body: PoseSeries, received: Mapping[int, int]) -> list[int]:
    unknown = [frame for frame in body.sequence.tolist() if frame not in received]
    if unknown:
        raise StoreError(f"{topic}: pose of frame {unknown[0]}, which the cameras never sent")
    return [received[frame] for frame in body.sequence.tolist()]


def _clock(writer: RecordingWriter, mocap: MocapSeries) -> Iterator[_Entry]:
    clock = mocap.clock
    writer.announce(topics.CLOCK, messages.CLOCK)
    columns = (clock.sent_ns.tolist(), clock.ticks.tolist(), clock.received_ns.tolist())
    for sent_ns, ticks, received_ns in zip(*columns, strict=True):
        yield (
            received_ns,
            partial(writer.clock, sent_ns=sent_ns, ticks=ticks, received_ns=received_ns, ticks_per_s=clock.ticks_per_s),
        )


def _poses(
    writer: RecordingWriter, topic: str, series: PoseSeries, log_ns: IntArray | Iterable[int]
) -> Iterator[_Entry]:
    writer.announce(topic, messages.POSE)
    columns = (
        series.stamp_ns.tolist(),
        log_ns,
        series.sequence.tolist(),
        series.position_m.tolist(),
        series.quaternion_xyzw.tolist(),
    )
    for stamp, log, sequence, position, quaternion in zip(*columns, strict=True):
        record = partial(
            writer.pose,
            topic,
            stamp_ns=stamp,
            log_ns=int(log),
            position_m=position,
            quaternion_xyzw=quaternion,
            sequence=sequence,
        )
        yield int(log), record


def _joints(writer: RecordingWriter, topic: str, series: JointSeries) -> Iterator[_Entry]:
    writer.announce(topic, messages.JOINTS)
    columns = (
        series.stamp_ns.tolist(),
        series.position_rad.tolist(),
        series.velocity_rad_s.tolist(),
        series.effort_n_m.tolist(),
    )
    for sequence, (stamp, position, velocity, effort) in enumerate(zip(*columns, strict=True)):
        record = partial(
            writer.joints,
            topic,
            stamp_ns=stamp,
            log_ns=stamp,
            position_rad=position,
            velocity_rad_s=velocity,
            effort_n_m=effort,
            sequence=sequence,
        )
        yield stamp, record


def _planar(writer: RecordingWriter, topic: str, series: PlanarSeries) -> Iterator[_Entry]:
    writer.announce(topic, messages.PLANAR)
    columns = (series.stamp_ns.tolist(), series.pose.tolist(), series.velocity.tolist(), series.std.tolist())
    for stamp, pose, velocity, std in zip(*columns, strict=True):
        yield stamp, partial(writer.planar, topic, stamp_ns=stamp, log_ns=stamp, pose=pose, velocity=velocity, std=std)


def _events(writer: RecordingWriter, events: Iterable[Event]) -> Iterator[_Entry]:
    writer.announce(topics.EVENTS, messages.EVENT)
    for event in events:
        record = partial(
            writer.event,
            stamp_ns=event.stamp_ns,
            log_ns=event.stamp_ns,
            name=event.name,
            message=event.message,
            level=event.level,
        )
        yield event.stamp_ns, record
