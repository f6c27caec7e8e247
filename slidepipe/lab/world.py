"""The simulated laboratory's physics: the WAM, a gripper of two force-driven fingers, and a block held by friction."""

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.arm import wam
from slidepipe.arm.model import FLANGE, HAND, Tool, arm_spec
from slidepipe.errors import InputError
from slidepipe.lab.grip_model import (
    BLOCK,
    FINGER_MASS_KG,
    PRESCRIBED_INERTIA,
    ContactSettings,
    FreeBlock,
    add_block,
    add_contacts,
    add_fingers,
    closing_forces,
    compile_grip,
    set_options,
)
from slidepipe.mechanics.dynamics import GRAVITY
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane, object_pose, rotation
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.series import FloatArray

__all__ = ["PRESCRIBED_INERTIA", "ContactSettings", "World", "WorldSettings"]


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
        self.data.ctrl[:] = closing_forces(_fingers(settings))
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
        """Put the block into the grip, wherever the hand is: {b} in {f}, about the axis that both have in common."""
        hand_m, hand = self.hand()
        x, y, theta = object_pose(np.zeros(3), r_f_b)
        position, matrix = hand_m + hand @ np.array([x, y, 0.0]), hand @ rotation(theta)
        pose = self.data.qpos[self._block_address : self._block_address + 7]
        pose[:3], pose[3:] = position, Rotation.from_matrix(matrix).as_quat(scalar_first=True)


def _model(settings: WorldSettings) -> mujoco.MjModel:
    spec = arm_spec(settings.tool, 1.0 + settings.mass_error)
    set_options(spec, settings.contact, np.array([0.0, 0.0, -GRAVITY]))
    fingers, block = _fingers(settings), FreeBlock(settings.block_size_m, settings.block_mass_kg)
    _add_frame(spec, settings)
    add_fingers(spec, FLANGE, fingers, float(block.size_m[2]), length_m=settings.tool.length_m)
    add_block(spec, block)
    add_contacts(spec, fingers, settings.contact)
    model = compile_grip(spec, block)
    arm = slice(0, wam.JOINT_COUNT)
    if settings.prescribed:
        model.dof_armature[arm] = PRESCRIBED_INERTIA
    else:
        model.dof_frictionloss[arm] = settings.joint_friction_scale * np.array(wam.COULOMB_FRICTION)
        model.dof_damping[arm] = settings.joint_friction_scale * np.array(wam.VISCOUS_FRICTION)
    return model


def _fingers(settings: WorldSettings) -> tuple[PlacedFinger, ...]:
    """The gripper's two fingers: one opposing pair, that is one finger of the planar model, at {f}."""
    pair = SoftFinger(settings.friction, 2.0 * settings.normal_force_per_finger_n, a=settings.rho_m, c=1.0)
    return (PlacedFinger(pair, np.zeros(2)),)


def _add_frame(spec: mujoco.MjSpec, settings: WorldSettings) -> None:
    """The gripper's own weight, half way out."""
    frame = spec.body(FLANGE).add_body(name="gripper", pos=[0.0, 0.0, settings.tool.length_m / 2])
    frame.mass = wam.GRIPPER_MASS_KG - settings.block_mass_kg - 2 * FINGER_MASS_KG
    frame.ipos = [0.0, 0.0, 0.0]
    frame.inertia = [frame.mass * 0.03**2] * 3
    frame.explicitinertial = True
