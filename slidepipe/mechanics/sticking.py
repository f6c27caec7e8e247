"""How far a grasp is from slipping: a convex problem, Section VI-A, solved with a certificate."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.grasp import Grasp, finite, single
from slidepipe.mechanics.load_kernel import certified_load, many_loads
from slidepipe.mechanics.planar import rotation
from slidepipe.series import FloatArray


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
    w = single("sticking: w_b", w_b, (3,))
    forces, direction, shapes = np.empty((len(grasp), 3)), np.empty(3), grasp.shapes
    load, bound = certified_load(grasp.r_f_b, grasp.semi_axes, shapes.of, shapes.curves, np.array(w), forces, direction)
    return StickingLoad(load, forces, direction, load - bound if np.isfinite(load) else 0.0)


def sticking_loads(
    grasp: Grasp, w_b: FloatArray, f_N: FloatArray | None = None, r_f_b: FloatArray | None = None
) -> FloatArray:
    """Loads (T,) of a grasp along a motion.

    Wrenches ``w_b`` are (T, 3), normal forces ``f_N`` (T, n), places ``r_f_b`` (T, n, 3); None keeps the grasp's own.
    """
    w = finite("sticking: w_b", w_b, (3,)).reshape(-1, 3)
    n = len(grasp)
    places = grasp.r_f_b if r_f_b is None else finite("sticking: r_f_b", r_f_b, (n, 3))
    axes, shapes, shape = grasp.axes_over(f_N), grasp.shapes, (len(w), n, 3)
    for name, value in (("r_f_b", places), ("f_N", axes)):
        if value.ndim > 2 and value.shape != shape:
            raise InputError(f"sticking: {name} must have one row for each of {len(w)} wrenches, got {len(value)}")
    places, axes = (np.ascontiguousarray(np.broadcast_to(a, shape)) for a in (places, axes))
    loads = np.empty(len(w))
    many_loads(places, axes, shapes.of, shapes.curves, np.ascontiguousarray(w), loads)
    return loads
