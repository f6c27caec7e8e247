"""Friction by a joint fit: the hand as a spline, the block's grip before the slide, kappa and rho together.

All poses from a little before the slide to a little after it enter one robust least squares. The block obeys the
contact law exactly: it sticks to the hand, slides and sticks again when the hand's motion and its friction say so, and
the slip times follow. The hand's jerk is held by the process noise that the smoother found. What the fit returns as its
covariance therefore holds the noise of both bodies.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.estimation import joint_kernel as kernel
from slidepipe.estimation.laws import Laws
from slidepipe.estimation.linear_kernel import inverse_of
from slidepipe.estimation.stage_kernel import PHYSICS, START
from slidepipe.estimation.weak_form import SlideWindow
from slidepipe.mechanics.dynamics import Block
from slidepipe.series import FloatArray, IntArray

KNOT_STEP_S = 0.008
LOOSER_HAND = 10.0
GENTLE_TAIL, TAIL = 100.0, 15.0
"""Degrees of freedom of Student's t: of the first search, so that a bad start finds back, and of the fit."""
HELD_SD = 0.003
"""Of kappa about its start in the first search: the hand is found before a wrong one makes kappa run away."""
LONGEST_STEP_S = 0.0004
MOST_STEPS = 60
LARGEST_LAST_STEP = 0.5
DIRECTIONS = 24
"""Random directions that the second derivatives are averaged over."""
OUTLIER = 27.0
TOLD_SD = 0.2
OTHER_SHARES = (0.95, 0.9, 1.05)
"""Of the first kappa, from which to search again until the poses fit."""
FITS = 1.5
MOST_OUTLIERS = 0.1


@dataclass(frozen=True, slots=True)
class JointStart:
    """Where the joint fit starts.

    Attributes
    ----------
    kappa : float
        m/s^2.
    rho_m : float
        Torsion constant times contact radius, and what its prior is about.
    opens_s, closes_s : float
        The poses between these are used.
    r_f_b : (3,)
        Finger in {b} while the block still sticks.
    object : (6,) or None
        Pose and velocity of the block as the window opens, where it slides already; else None.
    curve : (N, 3) or None
        Table of the limit surface, of :func:`~slidepipe.mechanics.patch_curve.patch_curve`; None is the ellipsoid.
    held_s : float or None
        Until when the block sticks whatever friction it takes.
    z : (P,) or None
        Parameters of a like fit to go on from.
    """

    kappa: float
    rho_m: float
    opens_s: float
    closes_s: float
    r_f_b: FloatArray
    object: FloatArray | None = None
    curve: FloatArray | None = None
    held_s: float | None = None
    z: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class JointFit:
    """What the joint fit found.

    Attributes
    ----------
    kappa : float
        mu f_N / m, m/s^2.
    kappa_log_sd : float
        Standard deviation of its logarithm with the step that was left to go, not yet inflated by ``chi_square``.
    rho_m, rho_log_sd : float
        Torsion constant times contact radius and the standard deviation of its logarithm.
    growth_s_m, growth_sd_s_m : float
        Growth of friction with sliding speed; zero and zero where it was taken as constant.
    bias : float
        What the noise alone adds to the logarithm of kappa (Box's second order); it was taken off.
    per_growth, per_gravity : float
        Change of the logarithm of kappa for each s/m of growth of friction with speed, and for each rad that gravity is
        turned, against what the fit took for known.
    chi_square : float
        Mean squared weighted residual of the measured poses that are no outliers, per degree of freedom.
    outlier_share : float
        Share of poses further than the gate from the fit.
    frames : int
        Frames in which the object was seen.
    cost : float
        Twice the negative log-likelihood with the priors, up to a constant.
    slides_s : (K, 2)
        Begins and ends of the stretches in which the fitted block slides.
    converged : bool
        Whether the next step would change kappa by less than half of its standard deviation.
    z, covariance : (P,), (P, P)
        All parameters and their covariance: the hand's coefficients, the block's start, the physics.
    first_knot_s, knot_s : float
        Where the hand's spline begins, and its knots' interval.
    held_s : float or None
        Until when the block was held.
    """

    kappa: float
    kappa_log_sd: float
    rho_m: float
    rho_log_sd: float
    growth_s_m: float
    growth_sd_s_m: float
    bias: float
    per_growth: float
    per_gravity: float
    chi_square: float
    outlier_share: float
    frames: int
    cost: float
    slides_s: FloatArray
    converged: bool
    z: FloatArray
    covariance: FloatArray
    first_knot_s: float
    knot_s: float
    held_s: float | None


def joint_fit(window: SlideWindow, block: Block, start: JointStart, laws: Laws) -> JointFit:
    """Fit hand, object and friction to the measured poses around a slide."""
    problem = _Problem(window, block, start, laws)
    if start.z is not None:
        again = _fit(problem, start.z.copy())
        if problem.fits(again):
            return _report(problem, again)
    best = _search(problem, 1.0)
    for share in OTHER_SHARES:
        if problem.fits(best):
            break
        best = min(best, _search(problem, share), key=lambda found: found.cost)
    return _report(problem, best)


@dataclass(frozen=True, slots=True)
class _Found:
    """Parameters, and what the kernel returns of them."""

    z: FloatArray
    information: FloatArray
    prior: FloatArray
    squares: FloatArray
    hand_squares: FloatArray
    path: FloatArray
    step: FloatArray
    cost: float
    steps: int

    @property
    def all_squares(self) -> FloatArray:
        """Squared weighted distances of block and hand."""
        return np.concatenate([self.squares, self.hand_squares])


def _search(problem: "_Problem", share: float) -> _Found:
    """Search from a share of the first kappa: with too much friction nothing slides, and then nothing leads back."""
    z = problem.first()
    z[-PHYSICS] += np.log(share)
    near, held = problem.mean.copy(), problem.information.copy()
    near[-PHYSICS] = z[-PHYSICS]
    held[-PHYSICS] = HELD_SD**-2.0
    kernel.fit(z, *problem.arguments, near, held, GENTLE_TAIL, MOST_STEPS)
    return _fit(problem, z)


def _fit(problem: "_Problem", z: FloatArray) -> _Found:
    """Fit from the parameters z on, which are changed."""
    return _Found(z, *kernel.fit(z, *problem.arguments, problem.mean, problem.information, TAIL, MOST_STEPS))


class _Problem:
    """The kernel's arrays; parameters are the hand's coefficients (3 n), the start (6), and the physics (4)."""

    def __init__(self, window: SlideWindow, block: Block, start: JointStart, laws: Laws) -> None:
        self.window, self.start, self.laws = window, start, laws
        span = start.closes_s - start.opens_s
        self.count = max(4, round(span / KNOT_STEP_S)) + 3
        self.knot_s = span / (self.count - 3)
        steps = int(np.ceil(span / LONGEST_STEP_S))
        near = (window.time_s >= start.opens_s) & (window.time_s <= start.closes_s)
        self.object_rows: IntArray = np.flatnonzero(near & window.object.valid)
        hand = near & window.hand.valid
        kind = kernel.STICKS if start.object is None else kernel.FREE
        self.kind = np.array([kind, block.m / block.inertia])
        held = 0 if start.held_s is None else max(0, round((start.held_s - start.opens_s) * steps / span))
        self.held_s = None if start.held_s is None else start.opens_s + held * span / steps
        self.clock = np.array([start.opens_s, self.knot_s, start.opens_s, span / steps, steps, held])
        self.mean, self.information = self._priors()
        rows = self.object_rows
        self.model = (self.kind, self.clock, start.curve)
        self.block = (window.time_s[rows], window.object.pose[rows], window.object_smooth.noise)
        seen = (window.time_s[hand], window.hand.pose[hand], window.hand_smooth.noise)
        self.arguments = (*self.model, self.block, seen, LOOSER_HAND * window.hand_smooth.process_noise)

    def first(self) -> FloatArray:
        """Parameters to start from: the smoothed hand, by what a cubic spline's coefficients nearly are."""
        hand, at = self.window.hand_smooth, self.start.opens_s + self.knot_s * (np.arange(self.count) - 1)
        nearly = hand.pose - self.knot_s**2 / 6.0 * hand.acceleration
        coefficients = [np.interp(at, self.window.time_s, nearly[:, axis]) for axis in range(3)]
        return np.concatenate([*coefficients, self.mean[3 * self.count :]])

    def chi_square(self, found: _Found) -> float:
        """Mean squared weighted residual of what is no outlier, per degree of freedom."""
        near = found.all_squares <= OUTLIER
        held = float(np.sum(inverse_of(found.information) * found.prior))
        freedom = 3 * np.count_nonzero(near) - len(found.z) + held
        return float(np.sum(found.all_squares[near]) / max(freedom, 1.0))

    def fits(self, found: _Found) -> bool:
        """Whether the poses are about as far from the fit as their noise."""
        return bool(np.mean(found.all_squares > OUTLIER) < MOST_OUTLIERS and self.chi_square(found) < FITS)

    def _priors(self) -> tuple[FloatArray, FloatArray]:
        """Mean and information of all parameters; only the physics is held, and what is not used."""
        start, laws = self.start, self.laws
        grip = np.concatenate([start.r_f_b, np.zeros(3)]) if start.object is None else start.object
        law = [np.log(start.kappa), np.log(start.rho_m), 0.0, laws.gravity_angle_rad]
        mean = np.concatenate([np.zeros(3 * self.count), grip, law])
        sds = np.array([np.inf, laws.rho_relative_sd, laws.growth_sd_s_m, laws.gravity_angle_sd_rad])
        information = np.zeros(len(mean))
        with np.errstate(divide="ignore"):
            information[-PHYSICS:] = np.minimum(sds**-2.0, kernel.CERTAIN)
        if start.object is None:
            information[-PHYSICS - START + 3 : -PHYSICS] = kernel.CERTAIN
        return mean, information


def _report(problem: _Problem, found: _Found) -> JointFit:
    z, covariance = found.z, inverse_of(found.information)
    sd = np.sqrt(np.diagonal(covariance))
    kappa, rho, growth, gravity = range(len(z) - PHYSICS, len(z))
    bias = float(_bias(problem, found, covariance)[kappa]) if sd[kappa] < TOLD_SD else 0.0
    bias = float(np.clip(bias, -sd[kappa], sd[kappa]))
    return JointFit(
        kappa=float(np.exp(z[kappa] - bias)),
        kappa_log_sd=float(np.hypot(sd[kappa], found.step[kappa])),
        rho_m=float(np.exp(z[rho])),
        rho_log_sd=float(sd[rho]),
        growth_s_m=float(z[growth]),
        growth_sd_s_m=float(sd[growth]) if problem.laws.growth_sd_s_m > 0.0 else 0.0,
        bias=bias,
        per_growth=_leverage(found, covariance, growth),
        per_gravity=_leverage(found, covariance, gravity),
        chi_square=problem.chi_square(found),
        outlier_share=float(np.mean(found.all_squares > OUTLIER)),
        frames=len(problem.object_rows),
        cost=float(found.cost),
        slides_s=_stretches(problem, found.path),
        converged=bool(abs(found.step[kappa]) < LARGEST_LAST_STEP * sd[kappa]),
        z=z,
        covariance=covariance,
        first_knot_s=problem.start.opens_s,
        knot_s=problem.knot_s,
        held_s=problem.held_s,
    )


def _leverage(found: _Found, covariance: FloatArray, column: int) -> float:
    """Change of log kappa for a unit change of a parameter that the fit takes for known."""
    pull = found.information[:, column].copy()
    pull[column] = 0.0
    return float(-covariance[len(found.z) - PHYSICS] @ pull)


def _bias(problem: _Problem, found: _Found, covariance: FloatArray) -> FloatArray:
    """Second-order bias of the estimate from the noise (Box), its trace averaged over random directions."""
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(DIRECTIONS, len(found.z)))
    measured = found.information - found.prior
    # By einsum and not by @: threaded linear algebra waits for cores that others use.
    scatter = np.einsum("ij,jk->ik", np.einsum("ij,jk->ik", covariance, measured), covariance)
    return np.asarray(
        kernel.bias_of(found.z, *problem.model, problem.block, TAIL, found.squares, covariance, scatter, signs)
    )


def _stretches(problem: _Problem, path: FloatArray) -> FloatArray:
    """(K, 2) begins and ends of sliding, s."""
    sliding = np.concatenate([[False], path[:, 6] >= 0.0, [False]])
    edges = np.flatnonzero(np.diff(sliding.astype(int)))
    return np.asarray(problem.start.opens_s + problem.clock[3] * (edges.reshape(-1, 2) - [1, 0]))
