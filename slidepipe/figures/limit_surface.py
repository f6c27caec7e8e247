"""Fig. 4: the ellipsoid of one soft finger, a friction force on it and the sliding velocity along its normal."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from slidepipe.figures import style
from slidepipe.figures.surface import bare_axes, draw_arrow, draw_ellipsoid
from slidepipe.series import FloatArray

FORCES = ("$f_x$ (N)", "$f_y$ (N)", "$m_z/a$ (N)")


@dataclass(frozen=True, slots=True)
class SurfacePicture:
    """An ellipsoid and what lies on it, moments divided by ``a``: all in N.

    Attributes
    ----------
    semi_axes : (3,)
    f_c : (3,)
        Friction on it.
    dv : (3,)
        The velocity that belongs to it, of any length, with its turning multiplied by ``a``.
    """

    semi_axes: FloatArray
    f_c: FloatArray
    dv: FloatArray


def draw_limit_surface(data: SurfacePicture) -> Figure:
    """Draw it in space."""
    with style.applied():
        figure = Figure(figsize=(4.4, 3.2))
        axes = bare_axes(figure, (-0.06, 0.0, 1.0, 1.0), FORCES, 1.15 * data.semi_axes, size=1.4)
        draw_ellipsoid(axes, data.semi_axes)
        draw_arrow(axes, np.zeros(3), data.f_c, color=style.FORCE, width=2.0)
        normal = 0.75 * float(data.semi_axes[0]) * data.dv / np.linalg.norm(data.dv)
        draw_arrow(axes, data.f_c, normal, color=style.VELOCITY, width=2.0)
        axes.text(*(0.55 * data.f_c + [0.0, 0.0, 0.12 * data.semi_axes[2]]), "$f_c$", color=style.FORCE, zorder=20)
        axes.text(*(data.f_c + 1.18 * normal), "$Δv$", color=style.VELOCITY, zorder=20, ha="center")
    return figure
