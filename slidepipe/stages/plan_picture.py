"""The picture of a plan, from the plan itself."""

from pathlib import Path

import numpy as np

from slidepipe.figures.plan import PhaseSpan, PlanPicture, Robustness, draw_plan
from slidepipe.mechanics.dynamics import about_com
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.sticking import needed_wrench
from slidepipe.planning.planner import Plan
from slidepipe.planning.survival import LEFT, SLIDING, Survival
from slidepipe.series import FloatArray

RESOLUTION_DPI = 150
SHOWN = 1.5
"""How much beyond the friction errors that are survived the picture goes, beside these."""


def picture_plan(plan: Plan, title: str, path: Path) -> None:
    """Draw a plan into a file: its way in the plane and over time, its friction, what wrong friction does to it."""
    course, motion, finger = plan.course, plan.motion, plan.setup.finger
    end = float(motion.time_s[-1])
    data = PlanPicture(
        title=title,
        phases=(
            PhaseSpan("stick", 0.0, course.slide_s),
            PhaseSpan("slide", course.slide_s, course.stop_s),
            PhaseSpan("settle", course.stop_s, end),
        ),
        time_s=motion.time_s,
        q_o=motion.q_o,
        q_f=motion.q_f,
        r_f_b=motion.r_b,
        ddq_o=motion.ddq_o,
        ddq_f=motion.ddq_f,
        f_f=_contact_wrench(plan),
        semi_axes=finger.semi_axes,
        patch_radius_m=finger.a,
        block_size_m=2.0 * plan.setup.half_size_m,
        robustness=_robustness(plan.survival, course.r_goal),
    )
    draw_plan(data).savefig(path, dpi=RESOLUTION_DPI)


def _contact_wrench(plan: Plan) -> FloatArray:
    """Friction on the object about the hand's origin, in {f}, (T, 3)."""
    motion = plan.motion
    wrench_b = needed_wrench(plan.setup.block, motion.q_o[:, 2], motion.ddq_o)
    return np.asarray(np.einsum("tji,tj->ti", rotation(motion.r_b[:, 2]), about_com(wrench_b, -motion.r_b)))


def _robustness(found: Survival, r_goal: FloatArray) -> Robustness:
    """What to show: the interval that is survived, and somewhat beyond."""
    shown = (found.ratio >= 1.0 - SHOWN * found.below - 0.05) & (found.ratio <= 1.0 + SHOWN * found.above + 0.05)
    lost = np.isin(found.verdict[shown], (LEFT, SLIDING))
    error = found.r_f_b[shown] - r_goal
    return Robustness(
        mu_ratio=found.ratio[shown],
        error_m=np.where(lost, np.nan, np.linalg.norm(error[:, :2], axis=1)),
        error_rad=np.where(lost, np.nan, error[:, 2]),
        eps_low=found.below,
        eps_high=found.above,
    )
