"""The simulated laboratory's physics: the WAM, a gripper of two force-driven fingers, and a block held by friction."""

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.arm import wam
from slidepipe.arm.model import FLANGE, HAND, Tool, arm_spec
from slidepipe.errors import InputError
from slidepipe.mechanics.planar import MotionPlane, object_pose
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

BLOCK = "block"
FINGERS = ("finger_near", "finger_far")
FINGER_RADIUS_M = 0.02
FINGER_MASS_KG = 0.005
SOLVER_TOLERANCE = 1e-15
"""At MuJoCo's default of 1e-8 the solver stops while the light block still chatters and creeps through its grip."""
PRESCRIBED_INERTIA = 1e6
"""Rotor inertia of an arm that follows its reference whatever pulls at it, kg m^2."""


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
class WorldSettings:
    """What the simulated world really is.

    Attributes
    ----------
    block_size_m : (3,)
        Length along x_b, width along y_b, thickness along the plane's normal.
    block_mass_kg, friction, normal_force_per_finger_n : float
    rho_m : float
        Torsional friction over tangential friction: the paper's ``c a``.
    tool : Tool
    plane : MotionPlane
    prescribed : bool
        Whether the arm follows its reference perfectly.
    mass_error : float
        Relative error of the table's link masses.
    joint_friction_scale : float
        Multiplies the arm's dry and viscous friction.
    contact : ContactSettings
    """

    block_size_m: FloatArray
    block_mass_kg: float
    friction: float
    normal_force_per_finger_n: float
    rho_m: float
    tool: Tool
    plane: MotionPlane
    prescribed: bool
    mass_error: float
    joint_friction_scale: float
    contact: ContactSettings

    def __post_init__(self) -> None:
        room_kg = wam.GRIPPER_MASS_KG - 2 * FINGER_MASS_KG
        if not 0.0 < self.block_mass_kg < room_kg:
            raise InputError(
                f"world: block_mass_kg must be positive and below {room_kg:g}, for gripper and block weigh "
                f"{wam.GRIPPER_MASS_KG:g} kg together, got {self.block_mass_kg!r}"
            )


class World:
    """The compiled model and its state; time starts at zero with the hand at rest and the block in its grip."""

    def __init__(self, settings: WorldSettings, joints_rad: FloatArray, r_f_b: FloatArray) -> None:
        self.settings = settings
        self.model = _model(settings)
        self.data = mujoco.MjData(self.model)
        self.data.qpos[: wam.JOINT_COUNT] = joints_rad
        self.data.ctrl[:] = settings.normal_force_per_finger_n
        mujoco.mj_kinematics(self.model, self.data)
        self._block_address = int(self.model.joint(BLOCK).qposadr[0])
        self._place_block(r_f_b)
        mujoco.mj_forward(self.model, self.data)

    @property
    def time_s(self) -> float:
        """Time since the start, s."""
        return float(self.data.time)

    def hand(self) -> tuple[FloatArray, FloatArray]:
        """Position (3,) and rotation matrix (3, 3) of {f} in the base frame."""
        mujoco.mj_kinematics(self.model, self.data)
        site = self.data.site(HAND)
        return site.xpos.copy(), site.xmat.reshape(3, 3).copy()

    def block(self) -> tuple[FloatArray, FloatArray]:
        """Position (3,) and rotation matrix (3, 3) of {b} in the base frame."""
        pose = self.data.qpos[self._block_address : self._block_address + 7]
        return pose[:3].copy(), Rotation.from_quat(pose[3:], scalar_first=True).as_matrix()

    def step(self, count: int) -> None:
        """Advance by ``count`` time steps under the torques in :attr:`torque`."""
        mujoco.mj_step(self.model, self.data, nstep=count)

    @property
    def joints_rad(self) -> FloatArray:
        """(7,) the arm's joint angles: a view."""
        return np.asarray(self.data.qpos[: wam.JOINT_COUNT])

    @property
    def joint_speeds_rad_s(self) -> FloatArray:
        """(7,) the arm's joint speeds: a view."""
        return np.asarray(self.data.qvel[: wam.JOINT_COUNT])

    @property
    def torque(self) -> FloatArray:
        """(7,) torques applied at the joints, N m: a view."""
        return np.asarray(self.data.qfrc_applied[: wam.JOINT_COUNT])

    def _place_block(self, r_f_b: FloatArray) -> None:
        position, matrix = self.hand()
        q_f = self.settings.plane.project(position, matrix)
        position, matrix = self.settings.plane.lift(object_pose(q_f, r_f_b))
        pose = self.data.qpos[self._block_address : self._block_address + 7]
        pose[:3], pose[3:] = position, Rotation.from_matrix(matrix).as_quat(scalar_first=True)


def _model(settings: WorldSettings) -> mujoco.MjModel:
    spec = arm_spec(settings.tool, 1.0 + settings.mass_error)
    _set_options(spec, settings)
    _add_gripper(spec, settings)
    _add_block(spec, settings)
    for finger in FINGERS:
        _add_contact(spec, finger, settings)
    model = spec.compile()
    # The solver's tolerance is relative to the mean inertia, which the heavy arm would spoil for the light block.
    model.stat.meaninertia = settings.block_mass_kg
    arm = slice(0, wam.JOINT_COUNT)
    if settings.prescribed:
        model.dof_armature[arm] = PRESCRIBED_INERTIA
    else:
        model.dof_frictionloss[arm] = settings.joint_friction_scale * np.array(wam.COULOMB_FRICTION)
        model.dof_damping[arm] = settings.joint_friction_scale * np.array(wam.VISCOUS_FRICTION)
    return model


def _set_options(spec: mujoco.MjSpec, settings: WorldSettings) -> None:
    spec.option.timestep = settings.contact.timestep_s
    spec.option.impratio = settings.contact.impratio
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.tolerance = SOLVER_TOLERANCE
    spec.option.gravity = [0.0, 0.0, -9.81]


def _add_gripper(spec: mujoco.MjSpec, settings: WorldSettings) -> None:
    """Two spheres on slides along the wrist axis, coupled to close alike; the sum of their forces stays constant."""
    length = settings.tool.length_m
    frame = spec.body(FLANGE).add_body(name="gripper", pos=[0.0, 0.0, length / 2])
    frame.mass = wam.GRIPPER_MASS_KG - settings.block_mass_kg - 2 * FINGER_MASS_KG
    frame.ipos = [0.0, 0.0, 0.0]
    frame.inertia = [frame.mass * 0.03**2] * 3
    frame.explicitinertial = True
    reach = settings.block_size_m[2] / 2 + FINGER_RADIUS_M
    for name, side in zip(FINGERS, (-1.0, 1.0), strict=True):
        finger = spec.body(FLANGE).add_body(name=name, pos=[0.0, 0.0, length + side * reach])
        finger.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, -side])
        finger.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[FINGER_RADIUS_M, 0, 0], mass=FINGER_MASS_KG,
            contype=0, conaffinity=0,
        )  # fmt: skip
        motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_motor()
    mirror = spec.add_equality(name="mirror", type=mujoco.mjtEq.mjEQ_JOINT, name1=FINGERS[0], name2=FINGERS[1])
    mirror.data[:2] = [0.0, 1.0]
    mirror.solref = [2 * settings.contact.timestep_s, 1.0]


def _add_block(spec: mujoco.MjSpec, settings: WorldSettings) -> None:
    block = spec.worldbody.add_body(name=BLOCK)
    block.add_freejoint(name=BLOCK)
    block.add_geom(
        name=BLOCK, type=mujoco.mjtGeom.mjGEOM_BOX, size=settings.block_size_m / 2, mass=settings.block_mass_kg,
        contype=0, conaffinity=0,
    )  # fmt: skip


def _add_contact(spec: mujoco.MjSpec, finger: str, settings: WorldSettings) -> None:
    """The paper's ellipsoid: an elliptic cone of dimension 4 whose torsional coefficient is ``mu c a``."""
    mu = settings.friction
    pair = spec.add_pair(name=finger, geomname1=finger, geomname2=BLOCK, condim=4)
    pair.friction = [mu, mu, mu * settings.rho_m, 0.0, 0.0]
    pair.solref = [settings.contact.solref_s, 1.0]
    # As stiff as the time step allows: MuJoCo leaves the turning of the arm (J' q') out of the contact's acceleration,
    # and a stuck block creeps by that times this time constant.
    pair.solreffriction = [2.0 * settings.contact.timestep_s, 1.0]
    pair.solimp = [0.99, 0.99, 0.001, 0.5, 2.0]
