"""How far a grasp is from slipping: a convex problem, Section VI-A, solved with a certificate."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.grasp import Grasp, finite
from slidepipe.mechanics.norm_kernel import smallest_sum
from slidepipe.mechanics.planar import rotation
from slidepipe.series import FloatArray

NO_RANK = 1e-12
"""Share of its largest friction below which a grasp is taken to have none in a direction."""
OUTSIDE = 1e-9
"""Share of a wrench that may point there, by rounding, before nothing can hold it."""


@dataclass(frozen=True, slots=True)
class StickingLoad:
    """The share of its friction that a grasp needs for a wrench, and the proof that it is no less and no more.

    Attributes
    ----------
    load : float
        Smallest lambda with ``sum_i G_i f_i = w`` and every ``f_i^T A_i f_i <= lambda^2``; the grasp sticks below one.
        Infinite where no friction, however large, gives the wrench: point contacts at one point, and a moment.
    forces : (n, 3)
        Contact wrenches in {b} that do it, N and N m: they show that the load is enough. NaN if it is infinite.
    direction : (3,)
        Sliding velocity in {b} at the CoM with ``support(direction) = 1`` W. All wrenches with a load up to lambda have
        ``w . direction <= lambda``, so ``w . direction`` shows that no less is enough: where the load is above one it
        separates the wrench from the grasp limit surface of eq. (16). Zero for no wrench; of unit length, with
        support zero, if the load is infinite.
    gap : float
        ``load - w . direction``: the load is within this of the least one.
    """

    load: float
    forces: FloatArray
    direction: FloatArray
    gap: float

    @property
    def sticks(self) -> bool:
        """Whether the friction is enough."""
        return self.load < 1.0

    @property
    def margin(self) -> float:
        """1 - load: the share of the friction that is left; negative if it slips."""
        return 1.0 - self.load


def needed_wrench(block: Block, theta: FloatArray | float, ddq_o: FloatArray) -> FloatArray:
    """Wrench in {b} about the CoM that friction must supply, (..., 3): ``M ddq_o - g`` of eq. (17).

    ``theta`` (...) is the object's angle and ``ddq_o`` (..., 3) its acceleration in {w}.
    """
    theta, ddq_o = finite("sticking: theta", theta), finite("sticking: ddq_o", ddq_o, (3,))
    return np.asarray(np.einsum("...ji,...j->...i", rotation(theta), block.M * ddq_o - block.g))


def sticking_margin(grasp: Grasp, w_b: FloatArray) -> StickingLoad:
    """Load of a grasp under a wrench, with its certificate; one finger's is ``dynamics.sticking_load``.

    Parameters
    ----------
    w_b : (3,)
        Wrench that friction must supply, in {b} about the CoM, N and N m: see :func:`needed_wrench`.

    Examples
    --------
    Two fingers beside the CoM share a weight, and a moment loads both by forces across.

    >>> from slidepipe.mechanics.grasp import Contact
    >>> from slidepipe.mechanics.limit_surface import SoftFinger
    >>> finger = SoftFinger(mu=0.5, f_N=2.0, a=0.02, c=0.6)
    >>> grasp = Grasp([Contact(finger, [0.03, 0.0, 0.0]), Contact(finger, [-0.03, 0.0, 0.0])])
    >>> found = sticking_margin(grasp, np.array([0.0, 1.0, 0.0]))
    >>> round(found.load, 9), found.forces.round(9)[:, 1], found.gap < 1e-9
    (0.5, array([0.5, 0.5]), True)
    """
    w = finite("sticking: w_b", np.atleast_1d(w_b), (3,))
    forces, direction = np.empty((len(grasp), 3)), np.empty(3)
    load, bound = certified_load(grasp.r_f_b, grasp.semi_axes, np.array(w.reshape(3)), forces, direction)
    return StickingLoad(load, forces, direction, load - bound if np.isfinite(load) else 0.0)


def sticking_loads(
    grasp: Grasp, w_b: FloatArray, f_N: FloatArray | None = None, r_f_b: FloatArray | None = None
) -> FloatArray:
    """Loads (T,) of a grasp along a motion: wrenches ``w_b`` (T, 3), normal forces ``f_N`` (T, n), places ``r_f_b`` (T, n, 3).

    None keeps the grasp's own normal forces or places.
    """
    w = finite("sticking: w_b", w_b, (3,)).reshape(-1, 3)
    n = len(grasp)
    places = grasp.r_f_b if r_f_b is None else finite("sticking: r_f_b", r_f_b, (n, 3))
    shape = (len(w), n, 3)
    places, axes = (np.ascontiguousarray(np.broadcast_to(a, shape)) for a in (places, grasp.axes_over(f_N)))
    loads = np.empty(len(w))
    many_loads(places, axes, np.ascontiguousarray(w), loads)
    return loads


@njit(cache=True, error_model="numpy")
def many_loads(r, s, w, loads):
    """Fill ``loads`` (T,) row by row."""
    forces, direction = np.empty((r.shape[1], 3)), np.empty(3)
    for row in range(len(w)):
        loads[row] = certified_load(r[row], s[row], w[row], forces, direction)[0]


@njit(cache=True, error_model="numpy")
def grasp_columns(r, s):
    """K_i = G_i S_i side by side, (3, 3 n), eq. (15)."""
    K = np.zeros((3, 3 * len(r)))
    for i in range(len(r)):
        K[0, 3 * i] = s[i, 0]
        K[1, 3 * i + 1] = s[i, 1]
        K[2, 3 * i] = -r[i, 1] * s[i, 0]
        K[2, 3 * i + 1] = r[i, 0] * s[i, 1]
        K[2, 3 * i + 2] = s[i, 2]
    return K


@njit(cache=True, error_model="numpy")
def across(w):
    """Orthonormal vectors (r, r - 1) at right angles to ``w`` (r,), r = 2 or 3."""
    size = np.sqrt(np.sum(w * w))
    N = np.zeros((len(w), len(w) - 1))
    if len(w) == 2:
        N[0, 0], N[1, 0] = -w[1] / size, w[0] / size
        return N
    least = np.argmin(np.abs(w))
    axis = np.zeros(3)
    axis[least] = 1.0
    first = np.cross(w, axis)
    first /= np.sqrt(np.sum(first * first))
    N[:, 0], N[:, 1] = first, np.cross(w / size, first)
    return N


@njit(cache=True, error_model="numpy")
def certified_load(r, s, w, forces, direction):
    """Load and its lower bound; fills ``forces`` (n, 3) and ``direction`` (3,). ``r``, ``s`` are (n, 3), ``w`` (3,)."""
    n = len(r)
    forces[:], direction[:] = 0.0, 0.0
    if not np.any(w != 0.0):
        return 0.0, 0.0
    K = grasp_columns(r, s)
    # One length makes moments of forces, and U / sigma makes sum_i K_i K_i^T the unit matrix where there is friction.
    lever = np.sqrt(np.sum(K[2] ** 2) / np.sum(K[:2] ** 2))
    lever = lever if lever > 0.0 else 1.0
    units = np.array([1.0, 1.0, 1.0 / lever])
    scaled, wanted = K * units.reshape(3, 1), w * units
    U, sigma, _ = np.linalg.svd(scaled, False)
    rank = 3 if sigma[2] > NO_RANK * sigma[0] else 2
    if rank == 2 and abs(np.sum(U[:, 2] * wanted)) > OUTSIDE * np.sqrt(np.sum(wanted**2)):
        away = U[:, 2] * units * np.sign(np.sum(U[:, 2] * wanted))
        direction[:] = away / np.sqrt(np.sum(away**2))
        forces[:] = np.nan
        return np.inf, np.inf
    white = np.ascontiguousarray((U[:, :rank] / sigma[:rank]).T)
    columns, goal = white @ scaled, white @ wanted
    N = across(goal)
    start = goal / np.sum(goal**2)
    x, g = np.empty(rank - 1), np.empty((n, 3))
    blocks = np.ascontiguousarray(columns.T)
    smallest_sum(0.0, (blocks @ N).reshape(n, 3, rank - 1), (blocks @ start).reshape(n, 3), x, g)
    # The forces add up to the wrench exactly; the largest of them is the load.
    given = columns @ g.reshape(3 * n)
    share = np.sum(goal * given) / np.sum(goal**2)
    g += (blocks @ (share * goal - given)).reshape(n, 3)
    forces[:] = s * g / share
    direction[:] = units * (white.T @ (start + N @ x))
    moved = (np.ascontiguousarray(K.T) @ direction).reshape(n, 3)
    direction /= np.sum(np.sqrt(np.sum(moved**2, axis=1)))
    return np.sqrt(np.max(np.sum(g**2, axis=1))) / share, np.sum(w * direction)
