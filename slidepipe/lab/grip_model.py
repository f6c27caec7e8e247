"""A block in a grip of soft fingers as a MuJoCo model: what the simulated lab and the cross-check are both made of.

Each finger of the paper's planar model is an opposing pair of spheres that close along the plane's normal, driven by
half its normal force each. Their contact is the paper's ellipsoid: an elliptic cone of dimension 4 with the torsional
coefficient ``mu c a``.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

BLOCK = "block"
"""Name of the block's body, joint and geom."""
SIDES = (("near", -1.0), ("far", 1.0))
"""The two spheres of a pair, and on which side of the block along the normal."""
FINGER_RADIUS_M = 0.02
FINGER_MASS_KG = 5e-5
"""Of one sphere of a pair, unless told otherwise. MuJoCo's contact pushes a sliding sphere off, and it hops: so light,
it is back at once; with 5 g the friction's direction is 0.9 degrees off and VIII-B ends 13 mrad from the mechanics.
"""
SOLVER_TOLERANCE = 1e-15
"""At MuJoCo's default of 1e-8 the solver stops while the light block still chatters and creeps through its grip."""
PRESCRIBED_INERTIA = 1e6
"""Rotor inertia of a joint that follows its reference whatever pulls at it, kg or kg m^2."""


@dataclass(frozen=True, slots=True)
class ContactSettings:
    """MuJoCo's soft contact: time step, normal ``solref`` time constant, friction-to-normal impedance ratio."""

    timestep_s: float
    solref_s: float
    impratio: float

    def __post_init__(self) -> None:
        steps = TICK_S / self.timestep_s if self.timestep_s > 0.0 else 0.0
        if round(steps) < 1 or abs(steps - round(steps)) > 1e-6:
            raise InputError(
                f"contact: timestep_s must be a whole part of the control loop's tick of {TICK_S:g} s, "
                f"got {self.timestep_s!r}"
            )


@dataclass(frozen=True, slots=True)
class FreeBlock:
    """The block: ``size_m`` (3,) along x_b, y_b and the plane's normal, and its mass."""

    size_m: FloatArray
    mass_kg: float

    def __post_init__(self) -> None:
        if np.shape(self.size_m) != (3,) or not np.all(np.isfinite(self.size_m) & (np.asarray(self.size_m) > 0.0)):
            raise InputError(f"block: size_m must be three positive numbers, got {self.size_m!r}")
        if not (np.isfinite(self.mass_kg) and self.mass_kg > 0.0):
            raise InputError(f"block: mass_kg must be a positive number, got {self.mass_kg!r}")


def set_options(spec: mujoco.MjSpec, contact: ContactSettings, gravity: FloatArray) -> None:
    """Set what the simulation of a light block in a grip needs; ``gravity`` (3,) is in the model's frame, m/s^2."""
    spec.option.timestep = contact.timestep_s
    spec.option.impratio = contact.impratio
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.tolerance = SOLVER_TOLERANCE
    spec.option.gravity = gravity


def finger_names(number: int) -> tuple[str, str]:
    """Names of the bodies, joints, geoms, motors and contacts of the pair that is finger ``number``, from 0.

    Examples
    --------
    >>> finger_names(0)
    ('finger0_near', 'finger0_far')
    """
    return f"finger{number}_{SIDES[0][0]}", f"finger{number}_{SIDES[1][0]}"


def add_fingers(
    spec: mujoco.MjSpec,
    hand: str,
    fingers: tuple[PlacedFinger, ...],
    thickness_m: float,
    *,
    length_m: float = 0.0,
    mass_kg: float = FINGER_MASS_KG,
) -> None:
    """Hang the fingers on a body, ready to close on a block of a thickness.

    The two spheres of a pair are coupled to close alike, and the sum of their forces stays constant: see
    :func:`closing_forces` for what drives them.

    Parameters
    ----------
    spec : mujoco.MjSpec
    hand : str
        Body whose z axis is the plane's normal.
    fingers : tuple of PlacedFinger
    thickness_m : float
        Of the block, along the normal.
    length_m : float
        How far out along the body's z axis the middle of the block is.
    mass_kg : float
        Of each sphere. MuJoCo's contacts push apart what slides on them, so that a finger hops; the heavier it is, the
        longer it stays away.

    Raises
    ------
    InputError
        No finger.
    """
    if not fingers:
        raise InputError("grip: a grip needs at least one finger, got none")
    reach = thickness_m / 2 + FINGER_RADIUS_M
    for number, placed in enumerate(fingers):
        for name, (_, side) in zip(finger_names(number), SIDES, strict=True):
            finger = spec.body(hand).add_body(name=name, pos=[*placed.place, length_m + side * reach])
            finger.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, -side])
            finger.add_geom(
                name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[FINGER_RADIUS_M, 0, 0], mass=mass_kg,
                contype=0, conaffinity=0,
            )  # fmt: skip
            motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            motor.set_to_motor()
        _couple(spec, number)


def closing_forces(fingers: tuple[PlacedFinger, ...]) -> FloatArray:
    """Controls (2 n,) of the fingers' motors, N: each sphere of a pair presses with half the finger's normal force."""
    return np.repeat([0.5 * placed.finger.f_N for placed in fingers], 2)


def add_block(spec: mujoco.MjSpec, block: FreeBlock) -> None:
    """Add the block as a free body that touches nothing but fingers."""
    body = spec.worldbody.add_body(name=BLOCK)
    body.add_freejoint(name=BLOCK)
    body.add_geom(
        name=BLOCK, type=mujoco.mjtGeom.mjGEOM_BOX, size=block.size_m / 2, mass=block.mass_kg,
        contype=0, conaffinity=0,
    )  # fmt: skip


def add_contacts(spec: mujoco.MjSpec, fingers: tuple[PlacedFinger, ...], contact: ContactSettings) -> None:
    """Let the fingers touch the block: an elliptic cone of dimension 4, ``mu c a`` its torsional coefficient."""
    for number, placed in enumerate(fingers):
        mu, rho = placed.finger.mu, placed.finger.a * placed.finger.c
        for name in finger_names(number):
            pair = spec.add_pair(name=name, geomname1=name, geomname2=BLOCK, condim=4)
            pair.friction = [mu, mu, mu * rho, 0.0, 0.0]
            pair.solref = [contact.solref_s, 1.0]
            # As stiff as the time step allows: MuJoCo leaves the turning of the arm (J' q') out of the contact's
            # acceleration, and a stuck block creeps by that times this time constant.
            pair.solreffriction = [2.0 * contact.timestep_s, 1.0]
            pair.solimp = [0.99, 0.99, 0.001, 0.5, 2.0]


def compile_grip(spec: mujoco.MjSpec, block: FreeBlock) -> mujoco.MjModel:
    """Compile a model that holds a light block."""
    model = spec.compile()
    # The solver's tolerance is relative to the mean inertia, which a heavy arm would spoil for the light block.
    model.stat.meaninertia = block.mass_kg
    return model


def _couple(spec: mujoco.MjSpec, number: int) -> None:
    near, far = finger_names(number)
    mirror = spec.add_equality(name=f"mirror{number}", type=mujoco.mjtEq.mjEQ_JOINT, name1=near, name2=far)
    mirror.data[:2] = [0.0, 1.0]
    mirror.solref = [2 * spec.option.timestep, 1.0]
