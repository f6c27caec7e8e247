"""Camera ticks to host time from echo exchanges.

An exchange leaves the host at ``sent``, is answered at ``ticks`` and returns at ``received``. The answer lies between
the two; a short trip says more than a long one, so only the shortest of each stretch of time are used.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import EstimationError, InputError
from slidepipe.series import ClockSync, FloatArray, IntArray

EXCHANGES_PER_STRETCH = 20
KEPT_SHARE = 0.25
FEWEST_EXCHANGES = 3


@dataclass(frozen=True, slots=True)
class ClockFit:
    """A straight line from camera ticks to host nanoseconds.

    Attributes
    ----------
    ticks_per_s : float
        Nominal rate of the cameras' clock.
    reference_ticks, reference_ns : int
        A tick in the middle of the exchanges and the host time that belongs to it.
    drift_ppm : float
        How much longer a camera second is on the host's clock than nominal, parts per million.
    exchanges_used : int
        Number of exchanges with a short trip that the line was fitted to.
    residual_ns : float
        Root mean square distance of the used exchanges from the line.
    sd_ns : float
        Standard deviation of the line at the reference.
    bound_ns : float
        Half of the shortest round trip: an uneven way there and back could hide an error up to this.
    """

    ticks_per_s: float
    reference_ticks: int
    reference_ns: int
    drift_ppm: float
    exchanges_used: int
    residual_ns: float
    sd_ns: float
    bound_ns: float

    @property
    def offset_s(self) -> float:
        """How far the cameras' clock is ahead of the host's at the reference, s."""
        return self.reference_ticks / self.ticks_per_s - self.reference_ns * 1e-9

    def to_host(self, ticks: IntArray) -> IntArray:
        """Host time of camera ticks, ns.

        Examples
        --------
        >>> fit = ClockFit(1e3, 5000, 2_000_000_000, 0.0, 3, 0.0, 0.0, 0.0)
        >>> fit.to_host(np.array([5000, 5001]))
        array([2000000000, 2001000000])
        """
        since = (np.asarray(ticks, dtype=np.int64) - self.reference_ticks).astype(float)
        elapsed = since * (1e9 / self.ticks_per_s) * (1.0 + self.drift_ppm * 1e-6)
        return np.asarray(self.reference_ns + np.round(elapsed).astype(np.int64))


def fit_clock(sync: ClockSync) -> ClockFit:
    """Fit the line from ticks to host time through the exchanges with the shortest round trips.

    Raises
    ------
    InputError
        Exchanges that contradict themselves: lengths that differ, a clock that goes back, an answer before its
        question.
    EstimationError
        Too few exchanges.
    """
    _check(sync)
    trip = sync.received_ns - sync.sent_ns
    kept = _shortest(trip)
    middle = sync.sent_ns[kept] + trip[kept] // 2
    reference_ticks, reference_ns = int(np.median(sync.ticks[kept])), int(np.median(middle))
    since_ns = (sync.ticks[kept] - reference_ticks) * (1e9 / sync.ticks_per_s)
    late_ns = (middle - reference_ns).astype(float) - since_ns
    line = _line(np.asarray(since_ns, dtype=np.float64), late_ns, trip[kept].astype(np.float64))
    return ClockFit(
        ticks_per_s=sync.ticks_per_s,
        reference_ticks=reference_ticks,
        reference_ns=reference_ns + round(line.offset),
        drift_ppm=line.slope * 1e6,
        exchanges_used=len(kept),
        residual_ns=line.residual,
        sd_ns=line.sd,
        bound_ns=float(np.min(trip)) / 2.0,
    )


@dataclass(frozen=True, slots=True)
class _Line:
    offset: float
    slope: float
    residual: float
    sd: float


def _line(since: FloatArray, late: FloatArray, trip: FloatArray) -> _Line:
    """Weighted line ``late = offset + slope * since``; an exchange weighs by what its trip exceeds the shortest by."""
    excess = trip - trip.min()
    sd = np.hypot(np.maximum(excess / 4.0, 1.0), max(float(np.median(excess)) / 4.0, 1.0))
    columns = np.stack([np.ones_like(since), since / 1e9], axis=1) / sd[:, None]
    solution = np.linalg.lstsq(columns, late / sd, rcond=None)[0]
    offset, slope = float(solution[0]), float(solution[1]) / 1e9
    misfit = (late - offset - slope * since) / sd
    scale = max(1.0, float(np.sqrt(misfit @ misfit / max(len(since) - 2, 1))))
    covariance = np.linalg.pinv(columns.T @ columns)
    residual = float(np.sqrt(np.mean((misfit * sd) ** 2)))
    return _Line(offset, slope, residual, scale * float(np.sqrt(covariance[0, 0])))


def _shortest(trip: IntArray) -> IntArray:
    """Indices of the shortest trips of each stretch of consecutive exchanges, so that all times are represented."""
    stretches = np.array_split(np.arange(len(trip)), max(1, len(trip) // EXCHANGES_PER_STRETCH))
    kept = []
    for stretch in stretches:
        count = min(len(stretch), max(FEWEST_EXCHANGES, round(KEPT_SHARE * len(stretch))))
        kept.append(stretch[np.argsort(trip[stretch], kind="stable")[:count]])
    return np.asarray(np.sort(np.concatenate(kept)))


def _check(sync: ClockSync) -> None:
    sizes = {len(sync.sent_ns), len(sync.ticks), len(sync.received_ns)}
    if len(sizes) != 1:
        raise InputError(f"clock exchanges: sent_ns, ticks and received_ns must be of one length, got {sorted(sizes)}")
    if not (np.isfinite(sync.ticks_per_s) and sync.ticks_per_s > 0.0):
        raise InputError(f"clock exchanges: ticks_per_s must be a positive number, got {sync.ticks_per_s!r}")
    if len(sync.sent_ns) < FEWEST_EXCHANGES:
        raise EstimationError(
            f"clock exchanges: at least {FEWEST_EXCHANGES} are needed to map camera time, got {len(sync.sent_ns)}"
        )
    for name in ("sent_ns", "ticks"):
        back = np.flatnonzero(np.diff(getattr(sync, name)) <= 0)
        if len(back):
            raise InputError(f"clock exchanges: {name} goes back at exchange {back[0] + 1}; it must increase")
    early = np.flatnonzero(sync.received_ns < sync.sent_ns)
    if len(early):
        raise InputError(f"clock exchanges: exchange {early[0]} was received before it was sent")
