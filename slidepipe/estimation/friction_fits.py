"""The joint fits of one slide: with the sticking around it or without, and over what else may be left open."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from slidepipe.estimation.joint_fit import JointFit, JointStart, joint_fit
from slidepipe.estimation.profile import Profile, Told, profile_of
from slidepipe.estimation.request import EstimationRequest
from slidepipe.estimation.slide import Slide
from slidepipe.estimation.static_friction import sticking_share
from slidepipe.estimation.weak_form import SlideWindow
from slidepipe.mechanics.patch_curve import patch_curve
from slidepipe.series import FloatArray

AROUND_S = 0.06
LONGEST_FIT_S = 0.6
WORST_CHI_SQUARE = 2.0
MOST_OUTLIERS = 0.1
LARGEST_SD = 0.10
AT_ODDS = 3.5
"""Standard deviations by which the slide alone may differ from the whole, before it is believed alone."""
WIDER = 1.15
"""What the curvature of the likelihood understates the spread of linear slides by; from synthetic trials."""
NORMAL_95 = 1.959964
STATIC_TOLD_SD, EXPONENT_TOLD_SD = 0.1, 0.15
"""Largest standard deviations at which mu_s / mu_k and 1/k count as told; of 1/k nothing at all is known at 0.29."""
EXPONENTS = (np.inf, 4.0, 2.0, 4.0 / 3.0, 1.0)
"""Pressure exponents k that are tried: even steps of 1/k."""
ONSETS_S = np.arange(-0.014, 0.0141, 0.002)
"""When the block may have begun to slide, about the instant that the poses show."""


@dataclass(frozen=True, slots=True)
class Fits:
    """The fit that is told, from when to when, whether the sticking entered it as friction that slides, and the rest.

    Attributes
    ----------
    kappa, kappa_relative_sd : float
        With what the fits at other exponents and onsets say.
    static_share : Told or None
        Friction that sticking took at most, over that of sliding: mu_s / mu_k. None where it was taken as one.
    inverse_exponent : Told or None
        1/k of the pressure. None where the surface was taken as an ellipsoid.
    """

    told: JointFit
    opens_s: float
    closes_s: float
    sticks_alike: bool
    kappa: float
    kappa_relative_sd: float
    static_share: Told | None = None
    inverse_exponent: Told | None = None


@dataclass(frozen=True, slots=True)
class _Span:
    """Where the fits open and close, and how the block starts in each."""

    opens_s: float
    slides_s: float
    closes_s: float
    grip: FloatArray
    state: FloatArray


def make_fits(request: EstimationRequest, slide: Slide, window: SlideWindow, kappa: float) -> Fits:
    """Fit the slide from its first sure frame on, then with the sticking around it; the former is the latter's check.

    A block that begins to slide otherwise than it slides on, with more static friction say, contradicts the latter.
    """
    span = _span(slide, window)
    start = JointStart(kappa, request.rho_m, span.slides_s, span.closes_s, span.grip, span.state)
    alone = _alone(request, window, start)
    if refusal(alone.told) is None:
        kappa = alone.kappa
    start = replace(start, kappa=kappa, opens_s=span.opens_s, object=None, curve=_curve(alone.inverse_exponent))
    if request.laws.sticking == "apart":
        return _held(request, window, start, slide, alone)
    whole = joint_fit(window, request.block, start, request.laws)
    if refusal(alone.told) is not None or (refusal(whole) is None and _agree(whole, alone.told)):
        return _with(whole, alone, span.opens_s)
    return alone


def refusal(joint: JointFit) -> str | None:
    """Why a fit is not told, if it is not."""
    sd = relative_sd(joint)
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
    return too_vague(sd)


def too_vague(sd: float) -> str | None:
    """Why a kappa with this standard deviation, over its value, is not told, if it is not."""
    if sd <= LARGEST_SD:
        return None
    told = f"to {100.0 * sd:.0f} % only" if sd < 1.0 else "not even to 100 %"
    return (
        f"friction refused: the slide tells kappa {told} (standard deviation), "
        f"at most {100.0 * LARGEST_SD:.0f} % is accepted"
    )


def relative_sd(joint: JointFit) -> float:
    """Standard deviation of kappa over its value, widened by what the residuals show."""
    return float(WIDER * joint.kappa_log_sd * np.sqrt(max(1.0, joint.chi_square)))


def _span(slide: Slide, window: SlideWindow) -> _Span:
    rows = np.flatnonzero(window.inside)
    top = rows[len(rows) // 2]
    gone = np.flatnonzero(~window.usable)
    first = float(window.time_s[gone[gone < top].max(initial=-1) + 1])
    last = float(window.time_s[gone[gone > top].min(initial=len(window.time_s)) - 1])
    opens, closes = max(slide.start_s - AROUND_S, first), min(slide.stop_s + AROUND_S, last)
    before = window.relative_smooth.pose[(window.time_s >= opens) & (window.time_s < slide.start_s - AROUND_S / 4.0)]
    body = window.object_smooth
    return _Span(
        opens_s=opens,
        slides_s=float(window.time_s[rows[0]]),
        closes_s=min(closes, opens + LONGEST_FIT_S),
        grip=before.mean(axis=0) if len(before) else window.relative_smooth.pose[rows[0]],
        state=np.concatenate([body.pose[rows[0]], body.velocity[rows[0]]]),
    )


def _alone(request: EstimationRequest, window: SlideWindow, start: JointStart) -> Fits:
    """Fit the slide without the sticking; where the pressure is left open, at several exponents."""
    fit = joint_fit(window, request.block, start, request.laws)
    plain = Fits(
        told=fit,
        opens_s=start.opens_s,
        closes_s=start.closes_s,
        sticks_alike=False,
        kappa=fit.kappa,
        kappa_relative_sd=relative_sd(fit),
    )
    if request.laws.surface == "ellipsoid":
        return plain
    warm = replace(start, z=fit.z)
    found = _profiled(
        1.0 / np.array(EXPONENTS),
        lambda inverse: joint_fit(window, request.block, replace(warm, curve=_surface(inverse)), request.laws),
    )
    exponent = found.profile.own(EXPONENT_TOLD_SD)
    best = joint_fit(window, request.block, replace(warm, curve=_surface(exponent.value)), request.laws)
    return replace(plain, told=best, kappa=found.kappa, kappa_relative_sd=found.sd, inverse_exponent=exponent)


def _held(request: EstimationRequest, window: SlideWindow, start: JointStart, slide: Slide, alone: Fits) -> Fits:
    """Fit the block as held until an instant, whatever friction that takes, for several instants."""
    fit = joint_fit(window, request.block, replace(start, held_s=slide.start_s), request.laws)
    warm = replace(start, z=fit.z)

    def held_until(onset_s: float) -> JointFit:
        return joint_fit(window, request.block, replace(warm, held_s=onset_s), request.laws)

    onsets = slide.start_s + ONSETS_S
    found = _profiled(onsets[onsets > start.opens_s], held_until)
    best = held_until(found.profile.own().value)
    if refusal(best) is not None or not _agree(best, alone.told):
        return alone
    inverse = None if alone.inverse_exponent is None else alone.inverse_exponent.value
    shares = [sticking_share(one, request.block, inverse) for one in found.fits]
    logs, sds = np.array([one.log for one in shares]), np.array([one.log_sd for one in shares])
    mean, sd = found.profile.mean(logs), WIDER * found.profile.sd(logs, sds)
    low, high = (max(1.0, float(np.exp(mean + sign * NORMAL_95 * sd))) for sign in (-1.0, 1.0))
    share = max(1.0, float(np.exp(mean)))
    return replace(
        _with(best, alone, start.opens_s),
        kappa=found.kappa,
        kappa_relative_sd=max(found.sd, _with(best, alone, start.opens_s).kappa_relative_sd),
        static_share=Told(share, share * sd, low, high, STATIC_TOLD_SD),
    )


def _with(whole: JointFit, alone: Fits, opens_s: float) -> Fits:
    """The fit with the sticking, and what other exponents add to the deviation of the slide's own."""
    added = max(0.0, alone.kappa_relative_sd**2 - relative_sd(alone.told) ** 2)
    sd = float(np.sqrt(relative_sd(whole) ** 2 + added))
    return replace(alone, told=whole, opens_s=opens_s, sticks_alike=True, kappa=whole.kappa, kappa_relative_sd=sd)


@dataclass(frozen=True, slots=True)
class _Profiled:
    profile: Profile
    fits: tuple[JointFit, ...]

    @property
    def kappa(self) -> float:
        return float(np.exp(self.profile.mean(self._logs())))

    @property
    def sd(self) -> float:
        return self.profile.sd(self._logs(), np.array([relative_sd(one) for one in self.fits]))

    def _logs(self) -> FloatArray:
        return np.log([one.kappa for one in self.fits])


def _profiled(values: FloatArray, fit: Callable[[float], JointFit]) -> _Profiled:
    fits = tuple(fit(float(value)) for value in values)
    cost = np.array([one.cost for one in fits])
    scale = WIDER**2 * max(1.0, fits[int(np.argmin(cost))].chi_square)
    return _Profiled(profile_of(values, cost, scale), fits)


def _agree(whole: JointFit, alone: JointFit) -> bool:
    """Whether two fits, one from a part of the other's poses, tell the same kappa."""
    apart = abs(np.log(whole.kappa / alone.kappa))
    return bool(apart <= AT_ODDS * np.sqrt(max(relative_sd(alone) ** 2 - relative_sd(whole) ** 2, 1e-6)))


def _curve(inverse: Told | None) -> FloatArray | None:
    return None if inverse is None else _surface(inverse.value)


def _surface(inverse: float) -> FloatArray:
    """Table of the exact surface for 1/k."""
    return patch_curve(np.inf if inverse < 1e-3 else round(1.0 / inverse, 6))
