"""Which fingers of a grasp stick, which slide, and where to: onset of slip and one implicit step, as a convex problem.

Gauss' principle: of all friction within the ellipsoids of eq. (10), the contacts apply that which brings the object
nearest, in the norm of the mass matrix, to moving with them. Its optimality conditions are eqs. (10), (11) and (14)
together: a finger sticks with friction inside its ellipsoid, or slides with the friction that its sliding has.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.grasp import Grasp, carried, in_world, single
from slidepipe.mechanics.load_kernel import certified_load
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.slip_kernel import grasp_friction
from slidepipe.series import BoolArray, FloatArray

STUCK = 1e-9
"""Share of the sliding without friction below which a finger sticks."""
ONE_BODY = 1e-12
"""Share of their motion by which the fingers of one rigid hand may differ by rounding."""


@dataclass(frozen=True, slots=True)
class Onset:
    """How an object at rest in a hand answers the hand's acceleration; in {w}.

    Attributes
    ----------
    f : (n, 3)
        Friction on the object at the contacts, N and N m. Where every finger sticks and more than one finger could
        hold the object, the forces are those that use the least share of the friction.
    ddq_o : (3,)
        Acceleration of the object.
    ddr : (3,)
        Acceleration of the hand relative to the object, at the CoM: zero, exactly, if the grasp sticks.
    ddv : (n, 3)
        The same at the contacts, G_i^T ddr: the direction in which each finger begins to slide.
    stuck : (n,) bool
        Which fingers do not begin to slide: all, none, or point contacts about which the object turns.
    residual : float
        By how much the optimality conditions are missed, as a share of the friction.
    """

    f: FloatArray
    ddq_o: FloatArray
    ddr: FloatArray
    ddv: FloatArray
    stuck: BoolArray
    residual: float

    @property
    def sticks(self) -> bool:
        """Whether the object moves with the hand."""
        return bool(np.all(self.stuck))


@dataclass(frozen=True, slots=True)
class FrictionStep:
    """One implicit step of an object between fingers that move each on its own; in {w}.

    Attributes
    ----------
    dq_o : (3,)
        Velocity of the object at the step's end.
    f : (n, 3)
        Friction at the contacts, N and N m, on average over the step.
    dv : (n, 3)
        Sliding velocities at the step's end, eq. (18).
    stuck : (n,) bool
        Which fingers stick.
    residual : float
        As in :class:`Onset`.
    """

    dq_o: FloatArray
    f: FloatArray
    dv: FloatArray
    stuck: BoolArray
    residual: float


def stuck_acceleration(theta: float, omega: float, ddq_f: FloatArray, r_f_b: FloatArray) -> FloatArray:
    """Acceleration (3,) in {w} of an object that moves with a finger: ``ddq_f`` (3,) taken from ``r_f_b`` to the CoM.

    Examples
    --------
    >>> stuck_acceleration(0.0, 2.0, np.array([1.0, 0.0, 3.0]), np.array([0.1, 0.0, 0.0])).round(9)
    array([ 1.4, -0.3,  3. ])
    """
    ddq_f, r_f = single("onset: ddq_f", ddq_f, (3,)), rotation(theta) @ single("onset: r_f_b", r_f_b, (3,))
    spin = np.array([r_f[0], r_f[1], 0.0]) * single("onset: omega", omega, ()) ** 2
    return np.asarray(carried(ddq_f, -r_f) + spin)


def onset(block: Block, grasp: Grasp, theta: float, ddq_h: FloatArray) -> Onset:
    """Whether fingers on one rigid hand, at rest on the object, begin to slide, and in which direction.

    Parameters
    ----------
    theta : float
        Angle of the object, rad.
    ddq_h : (3,)
        Acceleration in {w} that the object would have if it stuck: see :func:`stuck_acceleration`.

    Examples
    --------
    >>> from slidepipe.mechanics.grasp import Contact
    >>> from slidepipe.mechanics.limit_surface import SoftFinger
    >>> finger = SoftFinger(mu=0.5, f_N=2.0, a=0.02, c=0.6)
    >>> grasp = Grasp([Contact(finger, [0.03, 0.0, 0.0]), Contact(finger, [-0.03, 0.0, 0.0])])
    >>> begun = onset(Block(length=0.1, width=0.06, m=0.1), grasp, 0.0, np.array([25.0, -9.81, 0.0]))
    >>> begun.sticks, begun.ddq_o.round(8), begun.ddr.round(8)
    (False, array([20.  , -9.81,  0.  ]), array([5., 0., 0.]))
    """
    wanted = single("onset: ddq_h", ddq_h, (3,))
    r_f = in_world(single("onset: theta", theta, ()), grasp.r_f_b)
    f, ddq_o, ddv, stuck, residual = _solve(block.M, grasp, r_f, block.g / block.M, carried(wanted, r_f))
    ddr = np.zeros(3) if np.all(stuck) else wanted - ddq_o
    return Onset(f, ddq_o, ddr, ddv, stuck, residual)


def friction_step(
    block: Block, grasp: Grasp, theta: float, dq_o: FloatArray, *, dq_f: FloatArray, h: float
) -> FrictionStep:
    """One step of eqs. (14), (17) and (18), implicit in the velocities: exact stick, stable for any step.

    Parameters
    ----------
    theta, dq_o : float and (3,)
        Angle of the object, and its velocity in {w} at the step's beginning.
    dq_f : (n, 3)
        Velocities of the fingers in {w} at the step's end, each its own.
    h : float
        Length of the step, s.
    """
    if not (np.isfinite(h) and h > 0.0):
        raise InputError(f"friction step: h must be a positive time in s, got {h!r}")
    free = single("friction step: dq_o", dq_o, (3,)) + h * block.g / block.M
    dq_f = single("friction step: dq_f", dq_f, (len(grasp), 3))
    r_f = in_world(single("friction step: theta", theta, ()), grasp.r_f_b)
    f, dq_o, dv, stuck, residual = _solve(block.M / h, grasp, r_f, free, dq_f)
    return FrictionStep(dq_o, f, dv, stuck, residual)


def _solve(
    M: FloatArray, grasp: Grasp, r_f: FloatArray, free: FloatArray, wanted: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray, float]:
    """Friction, the object's motion, the slip at the contacts, who sticks, and the residual.

    ``free`` (3,) is the motion without friction and ``wanted`` (n, 3) that of the fingers at their contacts.
    """
    s, shapes = grasp.semi_axes, grasp.shapes
    forces = np.empty((len(s), 3))
    together = carried(wanted[0], -r_f[0])
    if np.max(np.abs(carried(together, r_f) - wanted)) <= ONE_BODY * np.max(np.abs(wanted)):
        load, _bound = certified_load(r_f, s, shapes.of, shapes.curves, M * (together - free), forces, np.empty(3))
        if load <= 1.0:
            return forces, together, np.zeros((len(s), 3)), np.ones(len(s), dtype=bool), 0.0
    motion, slip = np.empty(3), np.empty((len(s), 3))
    residual, size = grasp_friction(M, s, shapes.of, shapes.curves, r_f, free, wanted, forces, motion, slip)
    stuck = np.linalg.norm(s * slip, axis=1) <= STUCK * size
    slip[stuck] = 0.0
    return forces, motion, slip, stuck, float(residual)
