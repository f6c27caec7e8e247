"""A limit surface from force and motion: wrenches that pushed an object over its supports, and how it slid.

An object that slides slowly over n point supports feels the wrench of its pusher balanced by their friction. So pairs
of wrench and displacement are points and normals of the limit surface of eq. (16): ``w = sum_i mu f_Ni G_i u_i``, where
u_i is the direction in which the object moves over support i. This is linear in the friction of each support: least
squares with the condition that none is negative, exact and without a start. The two kinds of noise, of force and of
moment, are weighed as the residuals themselves say.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares, nnls

from slidepipe.errors import EstimationError, InputError
from slidepipe.mechanics.dynamics import about_com
from slidepipe.mechanics.grasp import Contact, Grasp, carried
from slidepipe.mechanics.limit_surface import PointContact, SoftFinger
from slidepipe.mechanics.sticking import sticking_margin
from slidepipe.series import FloatArray

FEWEST_PAIRS = 10
RESAMPLES = 300
ROUNDS = 4
NEGLIGIBLE = 1e-6
"""Share of the friction below which a support is left out of the surface."""


@dataclass(frozen=True, slots=True)
class ForceMotion:
    """M pairs: what pushed the object, and how it slid while it did; in {b} about the centre of mass.

    Attributes
    ----------
    wrench : (M, 3)
        Force and moment on the object, N and N m.
    step : (M, 3)
        Displacement, m and rad; small, and only its direction counts.
    """

    wrench: FloatArray
    step: FloatArray

    def __post_init__(self) -> None:
        for name in ("wrench", "step"):
            values = np.asarray(getattr(self, name), dtype=float)
            if values.ndim != 2 or values.shape[1] != 3 or len(values) != len(self.wrench):
                raise InputError(f"force and motion: {name} must be (M, 3), one row a pair, got {values.shape}")
            bad = np.flatnonzero(~np.isfinite(values).all(axis=1) | ~values.any(axis=1))
            if len(bad):
                raise InputError(f"force and motion: {name} of pair {bad[0] + 1} must be finite and not zero")
        if len(self.wrench) < FEWEST_PAIRS:
            raise EstimationError(f"force and motion: {len(self.wrench)} pairs, at least {FEWEST_PAIRS} are needed")


@dataclass(frozen=True, slots=True)
class Supports:
    """Where the object stands: (n, 2) points in {b} about the centre of mass, m; (n,) shares of the load, if known."""

    points: FloatArray
    shares: FloatArray | None = None

    def __post_init__(self) -> None:
        points = np.asarray(self.points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 2 or not len(points) or not np.isfinite(points).all():
            raise InputError(f"supports: points must be (n, 2) finite numbers, got {self.points!r}")
        if self.shares is not None:
            shares = np.asarray(self.shares, dtype=float)
            if shares.shape != (len(points),) or not (shares >= 0.0).all() or abs(shares.sum() - 1.0) > 1e-3:
                raise InputError(f"supports: shares must be {len(points)} numbers that add up to 1, got {shares}")


@dataclass(frozen=True, slots=True)
class DirectionError:
    """How far, rad, predicted from measured sliding directions are, turning counted by the surface's own arm."""

    median: float
    ninth_decile: float


@dataclass(frozen=True, slots=True)
class SurfaceFit:
    """What force and motion tell of the friction between an object and its supports.

    Attributes
    ----------
    friction_n, friction_std_n : float
        ``mu f_N`` of all supports together, N; its standard deviation from resampled pairs.
    shares, shares_std : (n,)
        Of each support; known shares have no deviation.
    rms_force_n, rms_moment_n_m : float
        What the surface leaves of the wrenches.
    arm_m : float
        Largest moment over largest force.
    ellipsoid : SoftFinger
        The ellipsoid of eq. (10) at the centre of mass that fits the same pairs best, with ``mu = 1``.
    exact_error, ellipsoid_error : DirectionError
        From the measured wrench to the direction of sliding, beside the measured one.
    models_apart : DirectionError
        The ellipsoid's direction beside that of the exact surface for the same wrench.
    """

    friction_n: float
    friction_std_n: float
    shares: FloatArray
    shares_std: FloatArray
    rms_force_n: float
    rms_moment_n_m: float
    arm_m: float
    ellipsoid: SoftFinger
    exact_error: DirectionError
    ellipsoid_error: DirectionError
    models_apart: DirectionError


def fit_surface(pairs: ForceMotion, supports: Supports, *, seed: int = 0) -> SurfaceFit:
    """Fit the friction of n point supports to pairs of wrench and displacement.

    Parameters
    ----------
    supports : Supports
        With shares, only the sum is fitted; without, the friction of each support.
    seed : int
        Of the resampling that the standard deviations come from.

    Raises
    ------
    EstimationError
        The pairs do not fit: no friction at all is the best answer.
    """
    wrench, step = np.asarray(pairs.wrench, dtype=float), np.asarray(pairs.step, dtype=float)
    columns = _columns(step, supports)
    scale = _scales(columns, wrench)
    each = _forces(columns, wrench, scale)
    total = float(each.sum())
    if not total > 0.0:
        raise EstimationError("force and motion: the wrenches point against the sliding, no friction explains them")
    given = supports.shares is not None
    shares = np.asarray(supports.shares if given else each / total, dtype=float)
    random = np.random.default_rng(seed)
    drawn = [random.integers(len(wrench), size=len(wrench)) for _ in range(RESAMPLES)]
    again = np.array([_forces(columns[rows], wrench[rows], scale) for rows in drawn])
    sums = again.sum(axis=1)
    left = wrench - columns @ each
    grasp = _grasp(supports.points, shares * total)
    arm = float(grasp.support(np.array([0.0, 0.0, 1.0]))) / total
    ellipsoid = fit_ellipsoid(pairs, scale)
    exact = np.array([sticking_margin(grasp, row).direction for row in wrench])
    flat = ellipsoid.direction(wrench)
    return SurfaceFit(
        friction_n=total,
        friction_std_n=float(sums.std(ddof=1)),
        shares=shares,
        shares_std=np.zeros(len(shares)) if given else (again / sums[:, None]).std(axis=0, ddof=1),
        rms_force_n=float(np.sqrt(np.mean(left[:, :2] ** 2) * 2.0)),
        rms_moment_n_m=float(np.sqrt(np.mean(left[:, 2] ** 2))),
        arm_m=arm,
        ellipsoid=ellipsoid,
        exact_error=_apart(exact, step, arm),
        ellipsoid_error=_apart(flat, step, arm),
        models_apart=_apart(flat, exact, arm),
    )


def fit_ellipsoid(pairs: ForceMotion, scale: FloatArray) -> SoftFinger:
    """Ellipsoid of eq. (10) at the centre of mass that fits the pairs best; ``scale`` (3,) is the noise of a wrench."""
    wrench, step = np.asarray(pairs.wrench, dtype=float), np.asarray(pairs.step, dtype=float)

    def finger(logarithms: FloatArray) -> SoftFinger:
        force, radius = (float(number) for number in np.exp(logarithms))
        return SoftFinger(mu=1.0, f_N=force, a=radius, c=1.0)

    force = float(np.median(np.linalg.norm(wrench[:, :2], axis=1)))
    start = np.log([force, max(float(np.median(np.abs(wrench[:, 2]))) / force, 1e-4)])
    found = least_squares(lambda x: np.ravel((finger(x).friction(step) - wrench) / scale), start)
    return finger(found.x)


def _columns(step: FloatArray, supports: Supports) -> FloatArray:
    """(M, 3, k) wrench that a unit of friction of each unknown balances: a support, or all with their shares."""
    r = np.column_stack([supports.points, np.zeros(len(supports.points))])
    slip = carried(step[:, None, :], r)[..., :2]
    size = np.linalg.norm(slip, axis=-1, keepdims=True)
    unit = np.divide(slip, size, out=np.zeros_like(slip), where=size > 0.0)
    force = np.concatenate([unit, np.zeros_like(size)], axis=-1)
    each = np.swapaxes(about_com(force, r), 1, 2)
    return each if supports.shares is None else np.asarray(each @ np.asarray(supports.shares, dtype=float))[..., None]


def _forces(columns: FloatArray, wrench: FloatArray, scale: FloatArray) -> FloatArray:
    rows = (columns / scale[:, None]).reshape(-1, columns.shape[-1])
    return np.asarray(nnls(rows, np.ravel(wrench / scale))[0])


def _scales(columns: FloatArray, wrench: FloatArray) -> FloatArray:
    """(3,) noise of a wrench's two forces, taken as equal, and of its moment, from the residuals of a few rounds."""
    scale = np.sqrt(np.mean(wrench**2, axis=0))
    for _ in range(ROUNDS):
        left = wrench - columns @ _forces(columns, wrench, scale)
        force, moment = np.sqrt(np.mean(left[:, :2] ** 2)), np.sqrt(np.mean(left[:, 2] ** 2))
        floor = 1e-9 * np.abs(wrench).max(axis=0)
        scale = np.maximum([force, force, moment], np.maximum(floor, 1e-300))
    return np.asarray(scale)


def _grasp(points: FloatArray, forces: FloatArray) -> Grasp:
    """The supports as a grasp: the object slides on them as it would slide in fingers that hold still."""
    told = forces > NEGLIGIBLE * forces.sum()
    return Grasp(
        [
            Contact(PointContact(mu=1.0, f_N=float(force)), np.array([*point, 0.0]))
            for point, force in zip(np.asarray(points)[told], forces[told], strict=True)
        ]
    )


def _apart(one: FloatArray, other: FloatArray, arm: float) -> DirectionError:
    a, b = (twist * [1.0, 1.0, arm] for twist in (one, other))
    a, b = (twist / np.linalg.norm(twist, axis=1, keepdims=True) for twist in (a, b))
    angle = 2.0 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1))
    return DirectionError(float(np.median(angle)), float(np.percentile(angle, 90.0)))
