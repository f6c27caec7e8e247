"""What the recording of a trial says of what went wrong in it."""

from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts import topics
from slidepipe.artifacts.recording import Recording
from slidepipe.series import ClockSync, StreamStatistics


@dataclass(frozen=True)
class Seen:
    """What the recording of a trial says.

    Attributes
    ----------
    events : tuple of str
    end : str
        How the recording says that it ended.
    statistics : StreamStatistics
    lasted_s : float
        From the first tick to the last.
    no_hand, no_object : float
        Shares of the frames without a body.
    longest_gap_s : float
        Between exposures.
    spread_s : float
        Between the delays of frames that came fast and late: 1 % and 99 %.
    drift_ppm : float
        By how much the cameras' clock is fast, by the echoes.
    error_rad : float
        Largest between what a joint was told and where it was.
    """

    events: tuple[str, ...]
    end: str
    statistics: StreamStatistics
    lasted_s: float
    no_hand: float
    no_object: float
    longest_gap_s: float
    spread_s: float
    drift_ppm: float
    error_rad: float


def look_at(recording: Recording) -> Seen:
    """Read it out of the recording."""
    mocap, ticks = recording.mocap(), recording.ticks().stamp_ns
    (statistics,) = recording.statistics()
    frames, rate = mocap.frames, float(mocap.clock.ticks_per_s)
    exposed_s = (frames.ticks - frames.ticks[0]) / rate
    delay_s = 1e-9 * (frames.received_ns - frames.received_ns[0]) - exposed_s
    commanded, measured = recording.joints(topics.COMMANDED), recording.joints(topics.MEASURED)
    return Seen(
        events=tuple(event.message for event in recording.events()),
        end=recording.metadata["slidepipe.end"]["state"],
        statistics=statistics,
        lasted_s=1e-9 * float(ticks[-1] - ticks[0]),
        no_hand=1.0 - float(np.mean(frames.hand_valid)),
        no_object=1.0 - float(np.mean(frames.object_valid)),
        longest_gap_s=float(np.diff(exposed_s).max()),
        spread_s=float(np.subtract(*np.percentile(delay_s, [99, 1]))),
        drift_ppm=_drift_ppm(mocap.clock),
        error_rad=float(np.abs(commanded.position_rad - measured.position_rad).max()),
    )


def _drift_ppm(clock: ClockSync) -> float:
    """Slope of the cameras' clock over the host's, from the half of the echoes that came back soonest."""
    trip_ns = clock.received_ns - clock.sent_ns
    soon = trip_ns <= np.median(trip_ns)
    host_s = 1e-9 * (clock.sent_ns + trip_ns // 2 - clock.sent_ns[0])[soon]
    theirs_s = ((clock.ticks - clock.ticks[0]) / clock.ticks_per_s)[soon]
    return float(1e6 * (np.polyfit(host_s, theirs_s, 1)[0] - 1.0))
