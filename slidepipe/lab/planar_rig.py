"""A hand that moves exactly as told, with fingers and a block: experiments in MuJoCo without an arm."""

from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import rollout

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
from slidepipe.mechanics.dynamics import GRAVITY, Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.planar import object_pose, relative_pose
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.series import FloatArray

HAND = "hand"
HAND_MASS_KG = 1e-3
"""Of no weight beside what its joints resist with."""
AXES = ("x", "y", "theta")
THICKNESS_M = 0.01
"""Of the block: what it does in the plane does not depend on it."""
CLOSING_S = 0.05
"""How long the hand rests first, for the fingers to close."""
CONTROLS = mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_QFRC_APPLIED
REST_S = 0.5
"""How long it rests after the motion."""


@dataclass(frozen=True, slots=True)
class PlanarRig:
    """A compiled rig; MuJoCo's x and y are those of {w}, its z the plane's normal.

    Attributes
    ----------
    model : mujoco.MjModel
        Joints x, y and theta of the hand first; then the fingers, then the block.
    forces_n : (2 n,)
        What drives the fingers.
    """

    model: mujoco.MjModel
    forces_n: FloatArray


@dataclass(frozen=True, slots=True)
class RigMotion:
    """What a rig went through, at each of its time steps.

    Attributes
    ----------
    time_s : (T,)
        On the hand motion's clock.
    r_f_b : (T, 3)
        Relative pose of the hand in {b}, m and rad; the angle goes on beyond a turn.
    """

    time_s: FloatArray
    r_f_b: FloatArray


def planar_rig(
    block: Block,
    fingers: tuple[PlacedFinger, ...],
    contact: ContactSettings,
    *,
    finger_mass_kg: float = FINGER_MASS_KG,
) -> PlanarRig:
    """Build the rig of a block and its fingers.

    Parameters
    ----------
    block : Block
    fingers : tuple of PlacedFinger
        Each becomes an opposing pair at its place in {f}.
    contact : ContactSettings
    finger_mass_kg : float
        Of each sphere of a pair.

    Raises
    ------
    InputError
        No finger.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    set_options(spec, contact, np.array([0.0, -GRAVITY, 0.0]))
    hand = spec.worldbody.add_body(name=HAND, mass=HAND_MASS_KG, inertia=[HAND_MASS_KG] * 3, explicitinertial=True)
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    for name, axis, kind in zip(AXES, np.eye(3), (slide, slide, hinge), strict=True):
        hand.add_joint(name=name, type=kind, axis=axis, armature=PRESCRIBED_INERTIA)
    body = FreeBlock(np.array([block.length, block.width, THICKNESS_M]), block.m)
    add_fingers(spec, HAND, fingers, THICKNESS_M, mass_kg=finger_mass_kg)
    add_block(spec, body)
    add_contacts(spec, fingers, contact)
    return PlanarRig(compile_grip(spec, body), closing_forces(fingers))


def run_rig(rig: PlanarRig, hand: HandMotion, r_f_b: FloatArray) -> RigMotion:
    """Take a block, held at ``r_f_b`` (3,) at first, through a hand's motion and a rest after it.

    The speed of each step is the one that carries MuJoCo's semi-implicit integrator exactly to the next position.
    """
    r_f_b = np.asarray(r_f_b, dtype=float)
    if r_f_b.shape != (3,) or not np.all(np.isfinite(r_f_b)):
        raise InputError(f"rig: r_f_b must be three finite numbers, got {r_f_b!r}")
    time_s = step_times(rig, hand)
    q_f = hand.at(time_s)
    states = roll(rig, q_f, r_f_b)
    q_o = _block_poses(rig.model, states)
    r = relative_pose(q_o, states[:, 1:4])
    r[:, 2] += 2.0 * np.pi * np.round((r_f_b[2] - r[0, 2]) / (2.0 * np.pi))
    return RigMotion(time_s[1:], r)


def step_times(rig: PlanarRig, hand: HandMotion) -> FloatArray:
    """Times (T + 1,) of the steps that a motion takes: while the fingers close, the motion, and the rest."""
    h = rig.model.opt.timestep
    before, during = round(CLOSING_S / h), round((hand.breaks[-1] - hand.breaks[0] + REST_S) / h)
    return np.asarray(hand.breaks[0] + h * np.arange(-before, during + 1))


def roll(rig: PlanarRig, q_f: FloatArray, r_f_b: FloatArray) -> FloatArray:
    """States (T, n) of MuJoCo after each step of a hand that goes through ``q_f`` (T + 1, 3)."""
    model, data = rig.model, mujoco.MjData(rig.model)
    data.qpos[:3] = q_f[0]
    address = int(model.joint(BLOCK).qposadr[0])
    pose = object_pose(q_f[0], r_f_b)
    data.qpos[address : address + 7] = [*pose[:2], 0.0, np.cos(pose[2] / 2), 0.0, 0.0, np.sin(pose[2] / 2)]
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    states, _ = rollout.rollout(model, data, state, _controls(rig, q_f), control_spec=int(CONTROLS))
    return np.asarray(states[0])


def _controls(rig: PlanarRig, q_f: FloatArray) -> FloatArray:
    """Forces of the fingers and of the hand's joints at every step, (T, 2 n + nv)."""
    h, fingers = rig.model.opt.timestep, len(rig.forces_n)
    controls = np.zeros((len(q_f) - 1, fingers + rig.model.nv))
    controls[:, :fingers] = rig.forces_n
    speed = np.diff(q_f, axis=0) / h
    controls[:, fingers : fingers + 3] = PRESCRIBED_INERTIA * np.diff(speed, axis=0, prepend=0.0) / h
    return controls


def _block_poses(model: mujoco.MjModel, states: FloatArray) -> FloatArray:
    """Planar poses (T, 3) of the block, the angle without jumps; a state is the time, positions and speeds."""
    address = 1 + int(model.joint(BLOCK).qposadr[0])
    angle = np.unwrap(2.0 * np.arctan2(states[:, address + 6], states[:, address + 3]))
    return np.column_stack([states[:, address], states[:, address + 1], angle])
