"""Friction by a joint fit: the hand as a spline, the object's state when the window opens, kappa and rho together.

All measured poses of the window enter one weighted least squares. The hand's jerk is held by the process noise that
the smoother found; the object obeys the equation of motion exactly. What the fit returns as its covariance therefore
holds the noise of both bodies.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import OptimizeResult, least_squares

from slidepipe.estimation.forward import SlidingBlocks
from slidepipe.estimation.weak_form import SlideWindow
from slidepipe.mechanics.dynamics import Block
from slidepipe.series import FloatArray, IntArray

KNOT_STEP_S = 0.008
MARGIN_S = 0.03
LOOSER_HAND = 10.0
RHO_SD = 0.05
SOFT_SHARE = 0.35
FIRST_SPEED_SDS = 10.0
MOST_STEPS = 40
LARGEST_LAST_STEP = 0.5
SMALLEST_COLUMN, RIDGE = 1e-9, 1e-12
COARSEST_STEP_S, FINEST_STEP_S = 0.001, 0.0003


@dataclass(frozen=True, slots=True)
class JointStart:
    """Where the joint fit starts: kappa in m/s^2, rho in m, and the slowest sliding speed of the window in m/s."""

    kappa: float
    rho_m: float
    slowest_m_s: float


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
    chi_square : float
        Mean squared weighted residual of the measured poses, per degree of freedom.
    frames : int
        Frames of the window in which the object was seen.
    converged : bool
        Whether the next step would change kappa by less than half of its standard deviation.
    """

    kappa: float
    kappa_log_sd: float
    rho_m: float
    rho_log_sd: float
    chi_square: float
    frames: int
    converged: bool


def joint_fit(window: SlideWindow, block: Block, start: JointStart) -> JointFit:
    """Fit hand, object and friction to the measured poses of the window.

    Friction damps sideways sliding within a frame where the object is slow, so the first velocity across the slide
    is not told by the poses, and a search that is left free runs away along it. It is therefore held to ten standard
    deviations of the smoothed velocity, a hundredth of what the smoother knows.
    """
    problem = _Problem(window, block, start)
    found = _search(problem)
    covariance = _covariance(found.jac)
    measured = found.jac[: problem.measurements]
    freedom = problem.measurements - float(np.einsum("ij,jk,ik->", measured, covariance, measured))
    next_step = covariance @ (found.jac.T @ found.fun)
    sd = np.sqrt(np.diagonal(covariance))
    return JointFit(
        kappa=float(np.exp(found.x[-2])),
        kappa_log_sd=float(np.hypot(sd[-2], next_step[-2])),
        rho_m=float(np.exp(found.x[-1])),
        rho_log_sd=float(sd[-1]),
        chi_square=float(np.sum(found.fun[: problem.measurements] ** 2) / freedom),
        frames=len(problem.object_rows),
        converged=bool(abs(next_step[-2]) < LARGEST_LAST_STEP * sd[-2]),
    )


def _search(problem: "_Problem") -> OptimizeResult:
    """Least squares by MINPACK: threaded linear algebra takes a hundred times as long where other processes run."""
    scale = np.sqrt(np.diagonal(_covariance(problem.jacobian(problem.first))))
    return least_squares(
        problem.residuals,
        problem.first,
        jac=problem.jacobian,
        method="lm",
        x_scale=scale,
        ftol=1e-6,
        xtol=1e-9,
        max_nfev=MOST_STEPS,
    )


def _covariance(jacobian: FloatArray) -> FloatArray:
    """Inverse of the information; of a parameter that the measurements do not tell, a huge variance and not none."""
    size = np.maximum(np.linalg.norm(jacobian, axis=0), SMALLEST_COLUMN)
    scaled = jacobian / size
    information = np.einsum("ri,rj->ij", scaled, scaled) + RIDGE * np.eye(len(size))
    return np.asarray(np.linalg.inv(information) / size / size[:, None])


class _Problem:
    """Residuals and derivatives; parameters are hand coefficients (3 n), first object state (6), log kappa, log rho."""

    def __init__(self, window: SlideWindow, block: Block, start: JointStart) -> None:
        self.window, self.block, self.start = window, block, start
        rows = np.flatnonzero(window.inside)
        self.row = int(rows[0])
        self.opens, self.closes = float(window.time_s[rows[0]]), float(window.time_s[rows[-1]])
        self.object_rows: IntArray = rows[window.object.valid[rows]]
        near = (window.time_s >= self.opens - MARGIN_S) & (window.time_s <= self.closes + MARGIN_S)
        self.hand_rows: IntArray = np.flatnonzero(near & window.hand.valid)
        stiffness = self._stiffness()
        soft_m_s = SOFT_SHARE * start.slowest_m_s
        step_s = float(np.clip(2.0 * soft_m_s / stiffness, FINEST_STEP_S, COARSEST_STEP_S))
        self.soft_m_s = max(soft_m_s, stiffness * step_s / 2.0)
        self.steps = max(20, int(np.ceil((self.closes - self.opens) / step_s)))
        self.measurements = 3 * (len(self.object_rows) + len(self.hand_rows))

    def _stiffness(self) -> float:
        """Rate times speed at which friction damps sliding sideways, m/s^2; the Runge-Kutta rule must resolve it."""
        offset = self.window.relative_smooth.pose[self.window.inside, :2]
        arm = max(self.start.rho_m**2, float(np.max(np.sum(offset**2, axis=1))))
        return float(self.start.kappa * (1.0 + arm * self.block.m / self.block.inertia))

    @cached_property
    def knots(self) -> FloatArray:
        """Cubic knots over the window and its margins."""
        first, last = self.window.time_s[self.hand_rows[0]], self.window.time_s[self.hand_rows[-1]]
        first, last = min(first, self.opens), max(last, self.closes)
        inner = np.linspace(first, last, max(4, round((last - first) / KNOT_STEP_S)) + 1)
        return np.concatenate([[first] * 3, inner, [last] * 3])

    def basis(self, time_s: FloatArray, derivative: int = 0) -> FloatArray:
        """(T, n) values of the hand's basis functions or of a derivative of them."""
        count = len(self.knots) - 4
        spline = BSpline(self.knots, np.eye(count), 3)
        return np.asarray(spline(np.clip(time_s, self.knots[0], self.knots[-1]), derivative))

    @cached_property
    def hand_basis(self) -> FloatArray:
        """Basis at the hand's measurements."""
        return self.basis(self.window.time_s[self.hand_rows])

    @cached_property
    def half_steps(self) -> tuple[FloatArray, FloatArray]:
        """Basis and its derivative at the half steps of the integration."""
        time_s = np.linspace(self.opens, self.closes, 2 * self.steps + 1)
        return self.basis(time_s), self.basis(time_s, 1)

    @cached_property
    def jerk_basis(self) -> FloatArray:
        """Jerk of each knot interval per square root of its variance under a unit density."""
        inner = self.knots[3:-3]
        return self.basis((inner[1:] + inner[:-1]) / 2.0, 3) * np.sqrt(np.diff(inner))[:, None]

    @cached_property
    def first(self) -> FloatArray:
        """Parameters to start from: the smoothed motion."""
        smooth = self.window.hand_smooth.pose[self.hand_rows]
        coefficients = np.linalg.lstsq(self.hand_basis, smooth, rcond=None)[0]
        row, body = self.row, self.window.object_smooth
        rest = [np.log(self.start.kappa), np.log(self.start.rho_m)]
        return np.concatenate([coefficients.T.ravel(), body.pose[row], body.velocity[row], rest])

    def residuals(self, parameters: FloatArray) -> FloatArray:
        """Weighted residuals of one set of parameters."""
        return np.asarray(self.many_residuals(parameters[None])[0])

    def jacobian(self, parameters: FloatArray) -> FloatArray:
        """Central differences, all parameters in one batch."""
        step = np.full(len(parameters), 1e-5)
        batch = np.concatenate([parameters + np.diag(step), parameters - np.diag(step)])
        values = self.many_residuals(batch)
        half = len(parameters)
        return np.asarray((values[:half] - values[half:]).T / (2.0 * step))

    def many_residuals(self, batch: FloatArray) -> FloatArray:
        """(B, R) residuals of B sets of parameters: object, hand, jerk, first speed, rho."""
        count = self.hand_basis.shape[1]
        coefficients = batch[:, : 3 * count].reshape(len(batch), 3, count)
        noise, q = self.window.hand_smooth.noise, LOOSER_HAND * self.window.hand_smooth.process_noise
        hand = (np.einsum("tn,ban->bta", self.hand_basis, coefficients) - self.window.hand.pose[self.hand_rows]) / noise
        jerk = np.einsum("tn,ban->bta", self.jerk_basis, coefficients) / np.sqrt(q)
        body = (self.object_at(batch, coefficients) - self.window.object.pose[self.object_rows]) / (
            self.window.object_smooth.noise
        )
        speed = (batch[:, -5:-2] - self.first[-5:-2]) / (
            FIRST_SPEED_SDS * self.window.object_smooth.velocity_sd[self.row]
        )
        rho = (batch[:, -1:] - np.log(self.start.rho_m)) / RHO_SD
        return np.concatenate([part.reshape(len(batch), -1) for part in (body, hand, jerk, speed, rho)], axis=1)

    def object_at(self, batch: FloatArray, coefficients: FloatArray) -> FloatArray:
        """(B, T, 3) predicted object poses at its measurements, by cubic Hermite interpolation of the steps."""
        place, slope = self.half_steps
        h = (self.closes - self.opens) / self.steps
        blocks = SlidingBlocks(
            step_s=h,
            hand=np.einsum("tn,ban->tba", place, coefficients),
            hand_velocity=np.einsum("tn,ban->tba", slope, coefficients),
            kappa=np.exp(batch[:, -2]),
            rho_m=np.exp(batch[:, -1]),
            mass_per_inertia=self.block.m / self.block.inertia,
            soft_m_s=self.soft_m_s,
        )
        states = blocks.run(batch[:, -8:-2].T)
        at = (self.window.time_s[self.object_rows] - self.opens) / h
        step = np.minimum(at.astype(int), self.steps - 1)
        s = (at - step)[:, None, None]
        before, after = states[step], states[step + 1]
        pose = (
            (1.0 + 2.0 * s) * (1.0 - s) ** 2 * before[:, :3]
            + s * (1.0 - s) ** 2 * h * before[:, 3:]
            + s**2 * (3.0 - 2.0 * s) * after[:, :3]
            + s**2 * (s - 1.0) * h * after[:, 3:]
        )
        return np.asarray(np.moveaxis(pose, -1, 0))
