"""Friction of one trial: weak form, then joint fits with and without the sticking, then whether it may be told."""

from dataclasses import dataclass

import numpy as np

from slidepipe.estimation.friction_fits import NORMAL_95, WIDER, Fits, make_fits, refusal, too_vague
from slidepipe.estimation.joint_fit import JointFit
from slidepipe.estimation.placement import placement_leverage
from slidepipe.estimation.profile import Told
from slidepipe.estimation.request import EstimationRequest
from slidepipe.estimation.slide import Slide, sliding_speed
from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.estimation.stage_kernel import PHYSICS
from slidepipe.estimation.weak_form import SlideWindow, WeakFit, weak_fit
from slidepipe.series import BoolArray, FloatArray

WINDOW_SHARE = 0.2
FEWEST_FRAMES = 12
SEEN_SHARE = 0.5
LONGEST_WINDOW_S = 0.25
START_RANGE = 2.0
GROWTH_TOLD = 0.5
"""Share of what was thought possible of the growth at which its standard deviation tells something."""
RHO_TOLD = 0.03
"""Largest standard deviation, over its value, at which rho counts as measured."""


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
    growth : Told or None
        Growth of friction with sliding speed, s/m. None where it was taken as constant.
    static_share : Told or None
        mu_s / mu_k; None where it was taken as one.
    inverse_exponent : Told or None
        1/k of the pressure's exponent k: 0 is even pressure, 0.5 Hertz's, 1 a cone. None where the limit surface was
        taken as an ellipsoid.
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
    growth: Told | None
    static_share: Told | None
    inverse_exponent: Told | None
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
    fits = make_fits(request, slide, window, _start(request, weak))
    placed = _placed(request, fits, window)
    reason = refusal(fits.told) or too_vague(float(np.hypot(fits.kappa_relative_sd, placed.kappa)))
    if reason is not None:
        return FrictionFinding(None, reason)
    return FrictionFinding(_report(request, weak, fits, placed), None)


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


@dataclass(frozen=True, slots=True)
class _Placed:
    """Relative standard deviations that come of where the finger is on the hand."""

    kappa: float
    rho: float


def _placed(request: EstimationRequest, fits: Fits, window: SlideWindow) -> _Placed:
    if request.hand_place_sd is None:
        return _Placed(0.0, 0.0)
    moved = placement_leverage(fits.told, window)[-PHYSICS:] * request.hand_place_sd
    kappa, rho = np.linalg.norm(moved[:2], axis=1)
    return _Placed(float(kappa), float(rho))


def _report(request: EstimationRequest, weak: WeakFit, fits: Fits, placed: _Placed) -> FrictionEstimate:
    joint = fits.told
    rho_sd = float(np.hypot(WIDER * joint.rho_log_sd * max(1.0, joint.chi_square) ** 0.5, placed.rho))
    kappa, sd = fits.kappa, float(np.hypot(fits.kappa_relative_sd, placed.kappa))
    low, high = kappa * np.exp(-NORMAL_95 * sd), kappa * np.exp(NORMAL_95 * sd)
    per_kappa = request.block.m / request.normal_force_n
    return FrictionEstimate(
        kappa_m_s2=kappa,
        kappa_interval_m_s2=Interval(float(low), float(high)),
        kappa_relative_sd=sd,
        mu=kappa * per_kappa,
        mu_interval=Interval(float(low * per_kappa), float(high * per_kappa)),
        rho_m=joint.rho_m,
        rho_relative_sd=rho_sd,
        rho_told=bool(rho_sd < RHO_TOLD),
        growth=_growth(request, joint),
        static_share=fits.static_share,
        inverse_exponent=fits.inverse_exponent,
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


def _growth(request: EstimationRequest, joint: JointFit) -> Told | None:
    if request.laws.growth_sd_s_m == 0.0:
        return None
    value, sd = joint.growth_s_m, WIDER * joint.growth_sd_s_m * max(1.0, joint.chi_square) ** 0.5
    reach = NORMAL_95 * sd
    return Told(value, sd, value - reach, value + reach, GROWTH_TOLD * request.laws.growth_sd_s_m)
