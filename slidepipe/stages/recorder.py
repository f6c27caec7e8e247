"""What the loop says, into a recording."""

from dataclasses import asdict

from slidepipe.artifacts import messages, topics
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.lab.camera_clock import CameraClock
from slidepipe.lab.protocols import ClockExchange, JointCommand, JointState, MocapFrame
from slidepipe.series import StreamStatistics


class TrialRecorder:
    """Implements the loop's ``Recorder`` on a recording.

    A frame's time on the host's clock is told by the echo with the shortest round trip of late; the raw ticks and every
    echo are recorded as well, so that an estimate can do better.

    Attributes
    ----------
    latest_ns : int
        Stamp of the arm's last tick.
    """

    def __init__(self, writer: RecordingWriter, ticks_per_s: float) -> None:
        self._writer, self._ticks_per_s = writer, ticks_per_s
        self._clock = CameraClock(ticks_per_s)
        self._ticks = self.latest_ns = 0

    def joints(self, command: JointCommand, state: JointState) -> None:
        """Record one tick of the arm."""
        self.latest_ns = state.stamp_ns
        self._writer.joints(
            topics.COMMANDED,
            stamp_ns=state.stamp_ns,
            log_ns=state.stamp_ns,
            position_rad=command.position_rad,
            velocity_rad_s=command.velocity_rad_s,
            effort_n_m=command.feedforward_n_m,
            sequence=self._ticks,
        )
        self._writer.joints(
            topics.MEASURED,
            stamp_ns=state.stamp_ns,
            log_ns=state.stamp_ns,
            position_rad=state.position_rad,
            velocity_rad_s=state.velocity_rad_s,
            effort_n_m=state.effort_n_m,
            sequence=self._ticks,
        )
        self._ticks += 1

    def frame(self, frame: MocapFrame) -> None:
        """Record one camera frame and the bodies that were seen in it."""
        known_ns = self._clock.host_ns(frame.ticks)
        stamp_ns = frame.received_ns if known_ns is None else known_ns
        self._writer.frame(
            stamp_ns=stamp_ns,
            received_ns=frame.received_ns,
            frame=frame.frame,
            ticks=frame.ticks,
            hand_valid=frame.hand is not None,
            object_valid=frame.object is not None,
        )
        for topic, body in ((topics.HAND, frame.hand), (topics.OBJECT, frame.object)):
            if body is not None:
                self._writer.pose(
                    topic,
                    stamp_ns=stamp_ns,
                    log_ns=frame.received_ns,
                    position_m=body.position_m,
                    quaternion_xyzw=body.quaternion_xyzw,
                    sequence=frame.frame,
                )

    def clock(self, exchange: ClockExchange) -> None:
        """Record one echo."""
        self._clock.take(exchange)
        self._writer.clock(
            sent_ns=exchange.sent_ns,
            ticks=exchange.ticks,
            received_ns=exchange.received_ns,
            ticks_per_s=self._ticks_per_s,
        )

    def event(self, stamp_ns: int, text: str, level: str = "info") -> None:
        """Record that something happened."""
        self._writer.event(stamp_ns=stamp_ns, log_ns=stamp_ns, name="loop", message=text, level=level)

    def tick(self, stamp_ns: int, late_ns: int) -> None:
        """Record that a tick was due, and how late it began."""
        self._writer.counts(topics.TICKS, messages.TICK, stamp_ns=stamp_ns, late_ns=late_ns)

    def statistics(self, statistics: StreamStatistics) -> None:
        """Record the statistics so far."""
        self._writer.counts(topics.STATISTICS, messages.STATISTICS, **asdict(statistics))
