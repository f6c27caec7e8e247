"""The arm as a MuJoCo model, built from the table in :mod:`slidepipe.arm.wam`."""

from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.arm import wam
from slidepipe.series import FloatArray

HAND = "hand"
"""Name of the site at the contact: its frame is {f}, its z axis the wrist's."""
FLANGE = "link7"
ELBOW = "elbow"
"""Name of the site 350 mm past the elbow, where the vendor's safety module measures the speed."""
ELBOW_POINT_M = 0.35


@dataclass(frozen=True, slots=True)
class Tool:
    """Where the finger frame {f} is on the flange: ``length_m`` out along the wrist axis, turned by ``angle_rad``."""

    length_m: float
    angle_rad: float


def arm_spec(tool: Tool, mass_scale: float = 1.0) -> mujoco.MjSpec:
    """Build the bare arm with its hand site, to compile or to hang a gripper on.

    Parameters
    ----------
    tool : Tool
    mass_scale : float
        Scales every link's mass and inertia: a simulated arm differs from its table by 5 to 10 %.

    Returns
    -------
    mujoco.MjSpec
        Joints ``joint1`` .. ``joint7``, bodies ``link1`` .. ``link7``, sites :data:`HAND` and :data:`ELBOW`; base frame
        at the shoulder, z up.
    """
    spec = mujoco.MjSpec()
    spec.compiler.autolimits = True
    spec.compiler.degree = False
    body = spec.worldbody
    for index, link in enumerate(wam.LINKS):
        body = _add_link(body, index, link, mass_scale)
    body.add_site(name=HAND, pos=[0.0, 0.0, tool.length_m], quat=_quat_wxyz(Rotation.from_euler("z", tool.angle_rad)))
    spec.body("link4").add_site(name=ELBOW, pos=[0.0, 0.0, ELBOW_POINT_M])
    return spec


@cache
def nominal_model(tool: Tool) -> mujoco.MjModel:
    """The arm as its table says, with the gripper and block as one mass at the hand; compiled once, never to change."""
    spec = arm_spec(tool)
    side = 0.03
    moment = wam.GRIPPER_MASS_KG * side**2
    load = spec.body(FLANGE).add_body(name="load", pos=[0.0, 0.0, tool.length_m / 2])
    load.mass, load.ipos = wam.GRIPPER_MASS_KG, [0.0, 0.0, 0.0]
    load.inertia = [moment, moment, moment]
    load.explicitinertial = True
    return spec.compile()


def _add_link(parent: mujoco.MjsBody, index: int, link: wam.Link, mass_scale: float) -> mujoco.MjsBody:
    turn = Rotation.from_euler("x", link.alpha_rad)
    offset = np.array([link.a_m, 0.0, link.d_m])
    body = parent.add_body(name=f"link{index + 1}", pos=offset, quat=_quat_wxyz(turn))
    body.mass = link.mass_kg * mass_scale
    body.ipos = link.com_m
    body.fullinertia = np.array(link.inertia_kg_m2) * mass_scale
    body.explicitinertial = True
    body.add_joint(
        name=f"joint{index + 1}",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=turn.inv().apply([0.0, 0.0, 1.0]),
        pos=-turn.inv().apply(offset),
        range=link.range_rad,
        armature=wam.ROTOR_INERTIA[index],
    )
    return body


def _quat_wxyz(turn: Rotation) -> FloatArray:
    return np.asarray(turn.as_quat(scalar_first=True))
