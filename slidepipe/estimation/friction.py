"""Friction of one trial: weak form, then joint fits with and without the sticking, then whether it may be told."""

from dataclasses import dataclass

import numpy as np

from slidepipe.estimation.joint_fit import JointFit, JointStart, joint_fit
from slidepipe.estimation.request import EstimationRequest
from slidepipe.estimation.slide import Slide, sliding_speed
from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.estimation.weak_form import SlideWindow, WeakFit, weak_fit
from slidepipe.series import BoolArray, FloatArray

WINDOW_SHARE = 0.2
FEWEST_FRAMES = 12
SEEN_SHARE = 0.5
LONGEST_WINDOW_S = 0.25
AROUND_S = 0.06
LONGEST_FIT_S = 0.6
WORST_CHI_SQUARE = 2.0
MOST_OUTLIERS = 0.1
LARGEST_SD = 0.10
START_RANGE = 2.0
RHO_TOLD = 0.03
"""Largest standard deviation, over its value, at which rho counts as measured."""
AT_ODDS = 3.5
"""Standard deviations by which the slide alone may differ from the whole, before it is believed alone."""
NORMAL_95 = 1.959964
WIDER = 1.15
"""What the curvature of the likelihood understates the spread of linear slides by; from synthetic trials."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A 95 % interval."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class FrictionEstimate:
    """What the slide tells of friction.

    Attributes
    ----------
    kappa_m_s2 : float
        mu f_N / m: what motion tells.
    kappa_interval_m_s2 : Interval
        95 %; from the noise of both bodies, widened where the residuals are larger than that noise.
    kappa_relative_sd : float
        Standard deviation over value.
    mu : float
        With the assumed normal force and mass.
    mu_interval : Interval
        95 %, with normal force and mass taken as exact.
    rho_m : float
        Torsion constant times contact radius. The assumed value enters with the standard deviation of the request.
    rho_relative_sd : float
        Its standard deviation over its value; near the assumed one the slide said nothing of it.
    rho_told : bool
        Whether the slide turned enough to tell it.
    growth_s_m, growth_sd_s_m : float
        Growth of friction with sliding speed, s/m; zero where it was taken as constant.
    bias : float
        What the noise alone had added to the logarithm of kappa; it was taken off.
    per_growth, per_gravity : float
        How the logarithm of kappa would change for each s/m of such a growth, and each rad that gravity is turned.
    weak_kappa_m_s2 : float
        The weak form's answer, that the joint fit started from.
    chi_square : float
        Mean squared residual of the joint fit over the pose noise; one when the model holds.
    outlier_share : float
        Share of poses that no noise explains; they hardly pull.
    frames : int
        Frames of the object that the fit used.
    sticks_alike : bool
        Whether the sticking around the slide agrees with it, so that both entered the fit.
    window_start_s, window_stop_s : float
        The fit's window, seconds since the first frame.
    """

    kappa_m_s2: float
    kappa_interval_m_s2: Interval
    kappa_relative_sd: float
    mu: float
    mu_interval: Interval
    rho_m: float
    rho_relative_sd: float
    rho_told: bool
    growth_s_m: float
    growth_sd_s_m: float
    bias: float
    per_growth: float
    per_gravity: float
    weak_kappa_m_s2: float
    chi_square: float
    outlier_share: float
    frames: int
    sticks_alike: bool
    window_start_s: float
    window_stop_s: float


@dataclass(frozen=True, slots=True)
class FrictionFinding:
    """Friction, or the reason why it is refused."""

    friction: FrictionEstimate | None
    reason: str | None


def fit_friction(request: EstimationRequest, slide: Slide, window: SlideWindow) -> FrictionFinding:
    """Estimate friction from the window of a slide, or refuse.

    Parameters
    ----------
    window : SlideWindow
        From :func:`sliding_window`.
    """
    rows = np.flatnonzero(window.inside)
    seen = int(np.count_nonzero(window.object.valid[rows]))
    if seen < FEWEST_FRAMES or seen < SEEN_SHARE * len(rows):
        return FrictionFinding(
            None,
            f"friction refused: the object was seen in {seen} of the {len(rows)} frames that slide fast enough, "
            f"at least {FEWEST_FRAMES} and half of them are needed",
        )
    weak = weak_fit(window, request.block, request.rho_m)
    fits = _fits(request, slide, window, _start(request, weak))
    reason = _refusal(fits.told)
    if reason is not None:
        return FrictionFinding(None, reason)
    return FrictionFinding(_report(request, weak, fits), None)


@dataclass(frozen=True, slots=True)
class _Fits:
    """The fit that is told, from when to when, and whether the sticking entered it."""

    told: JointFit
    opens_s: float
    closes_s: float
    sticks_alike: bool


def _fits(request: EstimationRequest, slide: Slide, window: SlideWindow, kappa: float) -> _Fits:
    """Fit the slide with the sticking around it, and from its first sure frame on without; the latter is the check.

    A block that begins to slide otherwise than it slides on, with more static friction say, contradicts the first.
    """
    rows = np.flatnonzero(window.inside)
    top = rows[len(rows) // 2]
    gone = np.flatnonzero(~window.usable)
    first = float(window.time_s[gone[gone < top].max(initial=-1) + 1])
    last = float(window.time_s[gone[gone > top].min(initial=len(window.time_s)) - 1])
    opens, closes = max(slide.start_s - AROUND_S, first), min(slide.stop_s + AROUND_S, last)
    closes = min(closes, opens + LONGEST_FIT_S)
    before = window.relative_smooth.pose[(window.time_s >= opens) & (window.time_s < slide.start_s - AROUND_S / 4.0)]
    grip = before.mean(axis=0) if len(before) else window.relative_smooth.pose[rows[0]]
    body = window.object_smooth
    state = np.concatenate([body.pose[rows[0]], body.velocity[rows[0]]])
    slides = float(window.time_s[rows[0]])
    start = JointStart(kappa, request.rho_m, slides, closes, grip, state)
    alone = joint_fit(window, request.block, start, request.laws)
    if _refusal(alone) is None:
        kappa = alone.kappa
    start = JointStart(kappa, request.rho_m, opens, closes, grip)
    whole = joint_fit(window, request.block, start, request.laws)
    if _refusal(alone) is not None or (_refusal(whole) is None and _agree(whole, alone)):
        return _Fits(whole, opens, closes, sticks_alike=True)
    return _Fits(alone, slides, closes, sticks_alike=False)


def _agree(whole: JointFit, alone: JointFit) -> bool:
    """Whether two fits, one from a part of the other's poses, tell the same kappa."""
    apart = abs(np.log(whole.kappa / alone.kappa))
    return bool(apart <= AT_ODDS * np.sqrt(max(_relative_sd(alone) ** 2 - _relative_sd(whole) ** 2, 1e-6)))


def sliding_window(time_s: FloatArray, relative: SmoothedSeries, slide: Slide, rho_m: float) -> BoolArray:
    """(T,) the stretch around the top of a slide in which the speed exceeds a fifth of its peak.

    It stays clear of the uncertain ends: the direction of sliding is lost in the noise there. No longer than a
    quarter of a second: the rest would add little and take long.
    """
    speed = sliding_speed(relative, rho_m)
    first_s, last_s = slide.start_s + slide.start_sd_s / 2.0, slide.stop_s - slide.stop_sd_s / 2.0
    during = (time_s >= first_s) & (time_s <= last_s)
    top = int(np.argmax(np.where(during, speed, 0.0)))
    during &= np.abs(time_s - time_s[top]) <= LONGEST_WINDOW_S / 2.0
    slow = np.flatnonzero(~(during & (speed >= WINDOW_SHARE * slide.peak_speed_m_s)))
    first = slow[slow < top].max(initial=-1) + 1
    last = slow[slow > top].min(initial=len(speed))
    inside = np.zeros(len(speed), dtype=bool)
    inside[first:last] = True
    return inside


def _start(request: EstimationRequest, weak: WeakFit) -> float:
    """The weak form's kappa, or the believed one where the weak form is nonsense."""
    believed = request.believed_kappa
    sane = believed / START_RANGE < weak.kappa < believed * START_RANGE
    return weak.kappa if sane else believed


def _refusal(joint: JointFit) -> str | None:
    sd = _relative_sd(joint)
    if not joint.converged:
        return "friction refused: the joint fit did not converge"
    if not joint.outlier_share <= MOST_OUTLIERS:
        return (
            f"friction refused: {100.0 * joint.outlier_share:.0f} % of the poses do not fit a sliding block, "
            f"at most {100.0 * MOST_OUTLIERS:g} % are accepted"
        )
    if not joint.chi_square <= WORST_CHI_SQUARE:
        return (
            f"friction refused: the poses do not fit a sliding block, chi-square {joint.chi_square:.2f} per degree of "
            f"freedom, at most {WORST_CHI_SQUARE:g} is accepted"
        )
    if not sd <= LARGEST_SD:
        told = f"to {100.0 * sd:.0f} % only" if sd < 1.0 else "not even to 100 %"
        return (
            f"friction refused: the slide tells kappa {told} (standard deviation), "
            f"at most {100.0 * LARGEST_SD:.0f} % is accepted"
        )
    return None


def _relative_sd(joint: JointFit) -> float:
    return float(WIDER * joint.kappa_log_sd * np.sqrt(max(1.0, joint.chi_square)))


def _report(request: EstimationRequest, weak: WeakFit, fits: _Fits) -> FrictionEstimate:
    joint = fits.told
    rho_sd = WIDER * joint.rho_log_sd * max(1.0, joint.chi_square) ** 0.5
    sd = _relative_sd(joint)
    low, high = joint.kappa * np.exp(-NORMAL_95 * sd), joint.kappa * np.exp(NORMAL_95 * sd)
    per_kappa = request.block.m / request.normal_force_n
    return FrictionEstimate(
        kappa_m_s2=joint.kappa,
        kappa_interval_m_s2=Interval(float(low), float(high)),
        kappa_relative_sd=sd,
        mu=joint.kappa * per_kappa,
        mu_interval=Interval(float(low * per_kappa), float(high * per_kappa)),
        rho_m=joint.rho_m,
        rho_relative_sd=rho_sd,
        rho_told=bool(rho_sd < RHO_TOLD),
        growth_s_m=joint.growth_s_m,
        growth_sd_s_m=joint.growth_sd_s_m,
        bias=joint.bias,
        per_growth=joint.per_growth,
        per_gravity=joint.per_gravity,
        weak_kappa_m_s2=weak.kappa,
        chi_square=joint.chi_square,
        outlier_share=joint.outlier_share,
        frames=joint.frames,
        sticks_alike=fits.sticks_alike,
        window_start_s=fits.opens_s,
        window_stop_s=fits.closes_s,
    )
