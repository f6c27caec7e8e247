"""Friction of one trial: weak form, then joint fit, then whether the answer may be given."""

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
WORST_CHI_SQUARE = 3.0
LARGEST_SD = 0.10
START_RANGE = 2.0
NORMAL_95 = 1.959964


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
        Torsion constant times contact radius. The assumed value enters with a standard deviation of 5 %.
    rho_relative_sd : float
        Its standard deviation over its value; near 0.05 the slide said nothing of it.
    weak_kappa_m_s2 : float
        The weak form's answer, that the joint fit started from.
    chi_square : float
        Mean squared residual of the joint fit over the pose noise; one when the model holds.
    frames : int
        Frames of the object that the fit used.
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
    weak_kappa_m_s2: float
    chi_square: float
    frames: int
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
    slowest = WINDOW_SHARE * slide.peak_speed_m_s
    joint = joint_fit(window, request.block, JointStart(_start(request, weak), request.rho_m, slowest))
    reason = _refusal(joint)
    if reason is not None:
        return FrictionFinding(None, reason)
    span = (float(window.time_s[rows[0]]), float(window.time_s[rows[-1]]))
    return FrictionFinding(_report(request, weak, joint, span), None)


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
    return float(joint.kappa_log_sd * np.sqrt(max(1.0, joint.chi_square)))


def _report(request: EstimationRequest, weak: WeakFit, joint: JointFit, span: tuple[float, float]) -> FrictionEstimate:
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
        rho_relative_sd=joint.rho_log_sd * max(1.0, joint.chi_square) ** 0.5,
        weak_kappa_m_s2=weak.kappa,
        chi_square=joint.chi_square,
        frames=joint.frames,
        window_start_s=span[0],
        window_stop_s=span[1],
    )
