"""The ring between the loop and the recorder, both ends in one process."""

import os
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidepipe.lab.protocols import (
    BodyPose,
    ClockExchange,
    JointCommand,
    JointState,
    MocapFrame,
    Recorder,
)
from slidepipe.lab.ring import MOST_TEXT_BYTES, Kind, Ring, RingReader, RingRecorder
from slidepipe.series import StreamStatistics


@dataclass
class Notes:
    """Implements ``Recorder`` by remembering copies, since the ring's records are overwritten."""

    told: list[tuple] = field(default_factory=list)

    def joints(self, command: JointCommand, state: JointState) -> None:
        arrays = (command.position_rad, command.velocity_rad_s, command.feedforward_n_m)
        arrays += (state.position_rad, state.velocity_rad_s, state.effort_n_m)
        self.told.append(("joints", state.stamp_ns, *(array.tolist() for array in arrays)))

    def frame(self, frame: MocapFrame) -> None:
        poses = [
            body and (body.position_m.tolist(), body.quaternion_xyzw.tolist()) for body in (frame.hand, frame.object)
        ]
        self.told.append(("frame", frame.frame, frame.ticks, frame.received_ns, *poses))

    def clock(self, exchange: ClockExchange) -> None:
        self.told.append(("clock", exchange))

    def event(self, stamp_ns: int, text: str) -> None:
        self.told.append(("event", stamp_ns, text))

    def tick(self, stamp_ns: int, late_ns: int) -> None:
        self.told.append(("tick", stamp_ns, late_ns))

    def statistics(self, statistics: StreamStatistics) -> None:
        self.told.append(("statistics", statistics))


@pytest.fixture
def ring() -> Iterator[Ring]:
    one = Ring.make(slots=8)
    yield one
    os.close(one.descriptor)


def say_everything(recorder: Recorder, number: int) -> None:
    rng = np.random.default_rng(number)
    command, state = JointCommand(*rng.normal(size=(3, 7))), JointState(number, *rng.normal(size=(3, 7)))
    recorder.joints(command, state)
    body = BodyPose(rng.normal(size=3), rng.normal(size=4))
    for hand, thing in ((body, None), (None, body), (body, body), (None, None)):
        recorder.frame(MocapFrame(number, 2**62 + number, number + 1, hand, thing))
    recorder.clock(ClockExchange(1, number, 3))
    recorder.tick(number, -5)
    recorder.event(number, f"event {number}: µ = 0.4")


def test_what_goes_in_comes_out_round_and_round(ring: Ring) -> None:
    recorder, reader, heard, expected = RingRecorder(ring), RingReader(ring), Notes(), Notes()
    for number in range(20):
        say_everything(recorder, number)
        say_everything(expected, number)
        assert reader.replay(heard) == 8
    recorder.statistics(StreamStatistics(*range(10)))
    expected.statistics(StreamStatistics(*range(10)))
    reader.replay(heard)
    assert heard.told == expected.told
    assert ring.dropped == {}
    assert ring.waiting == 0


def test_a_full_ring_drops_and_counts_by_kind(ring: Ring) -> None:
    recorder, heard = RingRecorder(ring), Notes()
    for stamp in range(11):
        recorder.tick(stamp, 0)
    recorder.event(99, "too late")
    assert ring.dropped == {Kind.TICK: 3, Kind.EVENT: 1}
    assert RingReader(ring).replay(heard) == 8
    assert [one[1] for one in heard.told] == list(range(8)), "what was there first is kept"
    recorder.tick(100, 0)
    RingReader(ring).replay(heard)
    assert heard.told[-1] == ("tick", 100, 0)


def test_another_mapping_of_the_same_memory_sees_it(ring: Ring) -> None:
    other, heard = Ring(ring.descriptor), Notes()
    RingRecorder(ring).tick(1, 2)
    ring.close()
    assert other.closed
    assert other.waiting == 1
    RingReader(other).replay(heard)
    assert ring.waiting == 0
    assert heard.told == [("tick", 1, 2)]


@given(text=st.text(max_size=600))
def test_texts_of_any_length(text: str) -> None:
    ring, heard = Ring.make(slots=1), Notes()
    os.close(ring.descriptor)
    RingRecorder(ring).event(7, text)
    RingReader(ring).replay(heard)
    ((_, stamp, told),) = heard.told
    assert stamp == 7
    encoded = text.encode("utf-8", "replace")
    if len(encoded) <= MOST_TEXT_BYTES:
        assert told == encoded.decode()
    else:
        assert told.endswith(" ...")
        assert text.startswith(told[:-4])
        assert len(told.encode()) > MOST_TEXT_BYTES - 8
