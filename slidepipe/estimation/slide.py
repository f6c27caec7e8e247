"""When the object slid in the hand: the main piece of sliding, and how sure its ends are."""

from dataclasses import dataclass

import numpy as np

from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.series import BoolArray, FloatArray, IntArray

SLIDING_SPEED_M_S = 0.006
SLIDING_SIGMAS = 5.0
SHORTEST_TRAVEL_M = 0.0004
TRAVEL_SIGMAS = 4.0
BRIDGED_FRAMES = 3
RAMP_FROM, RAMP_TO = 0.2, 0.6
EARLIEST_S, LATEST_S = -0.02, 0.01


@dataclass(frozen=True, slots=True)
class Slide:
    """The main piece of sliding.

    Attributes
    ----------
    start_s, stop_s : float
        Seconds since the first frame, where the speed extrapolates to zero.
    start_sd_s, stop_sd_s : float
        Standard deviations of these.
    peak_speed_m_s : float
        Largest sliding speed; spin counts with rho.
    travel_m : float
        Path of the piece, spin counted with rho.
    pieces : int
        How many pieces of sliding there were in all.
    """

    start_s: float
    stop_s: float
    start_sd_s: float
    stop_sd_s: float
    peak_speed_m_s: float
    travel_m: float
    pieces: int


@dataclass(frozen=True, slots=True)
class SlideFinding:
    """The slide, or the reason why there is none to speak of; ``threshold_m_s`` is the largest of the speed's."""

    slide: Slide | None
    threshold_m_s: float
    reason: str | None


def sliding_speed(relative: SmoothedSeries, rho_m: float) -> FloatArray:
    """(T,) size of the sliding velocity, m/s; spin counts with rho, as on the limit surface."""
    return np.asarray(np.linalg.norm(relative.velocity * [1.0, 1.0, rho_m], axis=1))


def find_slide(time_s: FloatArray, relative: SmoothedSeries, rho_m: float, searched: BoolArray) -> SlideFinding:
    """Find the piece of sliding with the longest path.

    An object slides where its smoothed relative speed exceeds five of its standard deviations and 6 mm/s (a contact
    that sticks may creep slower than that); a slide travels further than four of the pose's and 0.4 mm.

    Parameters
    ----------
    searched : (T,) bool
        Frames of the motion in which the contact is on the object.
    """
    scale = np.array([1.0, 1.0, rho_m])
    speed = sliding_speed(relative, rho_m)
    threshold = np.maximum(SLIDING_SIGMAS * np.max(relative.velocity_sd * scale, axis=1), SLIDING_SPEED_M_S)
    highest = float(np.max(threshold[searched])) if searched.any() else SLIDING_SPEED_M_S
    pieces = _runs((speed > threshold) & searched)
    if not pieces:
        return SlideFinding(None, highest, f"no slide: the relative speed stayed below {highest * 1e3:.1f} mm/s")
    travels = [float(np.trapezoid(speed[piece], time_s[piece])) for piece in pieces]
    main = pieces[int(np.argmax(travels))]
    needed = max(SHORTEST_TRAVEL_M, TRAVEL_SIGMAS * float(np.max(relative.pose_sd[main] * scale)))
    if max(travels) < needed:
        return SlideFinding(
            None, highest, f"no slide: the longest piece is {max(travels) * 1e3:.2f} mm, below {needed * 1e3:.2f} mm"
        )
    slide = _slide(_profile(time_s, relative, scale), main, max(travels), len(pieces))
    return SlideFinding(slide, highest, None)


def _runs(mask: BoolArray) -> list[IntArray]:
    """Stretches of consecutive true entries, gaps of up to three bridged."""
    rows = np.flatnonzero(mask)
    if not len(rows):
        return []
    pieces = np.split(rows, np.flatnonzero(np.diff(rows) > BRIDGED_FRAMES + 1) + 1)
    return [np.arange(piece[0], piece[-1] + 1) for piece in pieces]


def _slide(profile: "_Profile", rows: IntArray, travel: float, pieces: int) -> Slide:
    speed = profile.speed
    top = int(rows[np.argmax(speed[rows])])
    start, stop = _end(profile, rows[rows <= top]), _end(profile, rows[rows >= top][::-1])
    return Slide(start.time, stop.time, start.sd, stop.sd, float(speed[top]), travel, pieces)


def _profile(time_s: FloatArray, relative: SmoothedSeries, scale: FloatArray) -> "_Profile":
    """Speed over time; the smoother's width is that of the axis that carries most of the sliding."""
    scaled = relative.velocity * scale
    axis = int(np.argmax(np.sum(scaled**2, axis=0)))
    frame = float(np.median(np.diff(time_s)))
    width = (relative.noise[axis] ** 2 * frame / relative.process_noise[axis]) ** (1.0 / 6.0)
    sd = np.max(relative.velocity_sd * scale, axis=1)
    return _Profile(time_s, np.asarray(np.linalg.norm(scaled, axis=1)), sd, float(max(width, frame)))


@dataclass(frozen=True, slots=True)
class _Profile:
    """Sliding speed and its sd, and the time over which the smoother rounds a corner off."""

    time_s: FloatArray
    speed: FloatArray
    sd: FloatArray
    width_s: float


@dataclass(frozen=True, slots=True)
class _End:
    time: float
    sd: float


def _end(profile: _Profile, rows: IntArray) -> _End:
    """Where the ramp of the speed extrapolates to zero; ``rows`` run from the end of the slide to its top."""
    time_s, speed = profile.time_s, profile.speed
    peak, crossing = speed[rows[-1]], float(time_s[rows[0]])
    rough = _End(crossing, profile.width_s)
    ramp = rows[(speed[rows] >= RAMP_FROM * peak) & (speed[rows] <= RAMP_TO * peak)]
    if len(ramp) < 3:
        return rough
    slope, offset = (float(number) for number in np.polyfit(time_s[ramp] - crossing, speed[ramp], 1))
    inwards = float(np.sign(time_s[rows[-1]] - crossing))
    if slope * inwards <= 0.0:
        return rough
    shift = float(np.clip(-offset / slope * inwards, EARLIEST_S, LATEST_S)) * inwards
    noise = float(np.mean(profile.sd[ramp])) / abs(slope)
    return _End(crossing + shift, float(np.hypot(noise, profile.width_s / 2.0)))
