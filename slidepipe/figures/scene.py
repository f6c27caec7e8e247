"""The object and the finger on it, in the plane of motion."""

from typing import Any

import numpy as np
from matplotlib.patches import Circle, Polygon

from slidepipe.figures import style
from slidepipe.mechanics.planar import finger_pose
from slidepipe.series import FloatArray


def corners(pose: FloatArray, size_m: FloatArray) -> FloatArray:
    """(4, 2) corners in {w} of a block of this size (2,) whose {b} is at ``pose`` (3,).

    Examples
    --------
    >>> corners(np.array([1.0, 0.0, 0.0]), np.array([0.2, 0.1]))[0].round(9)
    array([ 0.9 , -0.05])
    """
    half = 0.5 * np.asarray(size_m, dtype=float)
    body = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half
    return finger_pose(np.asarray(pose, dtype=float), np.column_stack([body, np.zeros(4)]))[:, :2]


def draw_block(axes: Any, pose: FloatArray, size_m: FloatArray, **changes: Any) -> None:
    """Draw the object at ``pose`` (3,), its x_b as a mark from the centre; ``changes`` stand over its look."""
    look = {**style.BLOCK, **changes}
    axes.add_patch(Polygon(corners(pose, size_m), closed=True, **look))
    mark = finger_pose(np.asarray(pose, dtype=float), np.array([[0.0, 0.0, 0.0], [0.18 * float(size_m[0]), 0.0, 0.0]]))
    kept = {name: look[name] for name in ("alpha", "zorder") if name in look}
    axes.plot(mark[:, 0], mark[:, 1], color=look["edgecolor"], linewidth=0.8, **kept)


def draw_finger(axes: Any, pose: FloatArray, length_m: float, **changes: Any) -> None:
    """Draw the finger at ``pose`` (3,): a dot where it touches, and a line along its x axis."""
    x, y, theta = (float(value) for value in pose)
    tip = length_m * np.array([np.cos(theta), np.sin(theta)])
    axes.plot([x, x + tip[0]], [y, y + tip[1]], **{**style.FINGER, **changes})
    axes.add_patch(Circle((x, y), 0.13 * length_m, zorder=changes.get("zorder", 2) + 1, **style.CONTACT))
