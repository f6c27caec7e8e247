"""Figs. 1 to 5: what the paper's theory alone says, and the pinch as an experiment file describes it."""

from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from slidepipe.figures.friction_error import FrictionErrorPicture, draw_friction_error
from slidepipe.figures.grasp_surface import GraspPicture, SurfacePanel, draw_grasp_surface
from slidepipe.figures.limit_surface import SurfacePicture, draw_limit_surface
from slidepipe.figures.one_dof_profile import OneDofPicture, draw_one_dof_profile
from slidepipe.figures.pinch import PinchPicture, draw_pinch
from slidepipe.mechanics.dynamics import about_com
from slidepipe.mechanics.grasp_surface import GraspSurface, SurfaceMesh
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.one_dof import Accelerations, Profile
from slidepipe.mechanics.theorem_1 import d_2, d_3, eps_limits
from slidepipe.series import FloatArray
from slidepipe.stages.paper_runs import LINEAR, PaperRuns
from slidepipe.stages.translate import setup

ACCELERATIONS = Accelerations(a_f=20.0, a_o=5.0, a=4.0)
D_GOAL_M, EPS = -0.1, 0.15
"""What Figs. 1 and 2 are drawn for; the paper states no numbers for them."""
SLIDING_AT = np.array([0.9, 0.5, 45.0])
"""Relative velocity of Fig. 4, m/s and rad/s."""
MU, FINGER_N, PATCH_M = 0.38, 1.0, 0.01
PLACES_M = np.array([[-0.03, -0.015], [0.03, -0.015], [0.0, 0.02], [0.0, 0.0]])
LEVER_M = 0.03
"""Fingers of Fig. 5: places in {b}, force of the three on one side; moments are divided by the lever to be drawn."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A figure and what is to be said under it."""

    figure: Figure
    caption: str


def fig01(runs: PaperRuns) -> Drawn:  # noqa: ARG001  # every figure is drawn by the same kind of function
    """Fig. 1, from the closed forms of eq. (4)."""
    profile = Profile(ACCELERATIONS, D_GOAL_M)
    time_s = _fine(profile)
    finger = np.stack([profile.finger.at(time_s, order) for order in range(3)])
    slide = np.stack([profile.slide(ACCELERATIONS.a_o).motion.at(time_s, order) for order in range(3)])
    figure = draw_one_dof_profile(OneDofPicture(time_s, finger, finger - slide, _edges(profile), D_GOAL_M))
    s = ACCELERATIONS
    caption = (
        "Motion of finger and object in the 1-DOF problem, from eq. (4). The shaded area is the relative sliding "
        f"distance. The paper gives no numbers; here $a_f$ = {s.a_f:g}, $a_o$ = {s.a_o:g}, $a$ = {s.a:g} m/s² and "
        f"d_goal = {D_GOAL_M:g} m, which give T1 = {profile.T1:.4f}, T2 = {profile.T2:.4f}, T3 = {profile.T3:.4f} and "
        f"T4 = {profile.T4:.4f} s. As in the paper, T1 = T3 + T4, and the object moves on at $a_o$ until T3 ends. "
        "No run: mechanics alone."
    )
    return Drawn(figure, caption)


def fig02(runs: PaperRuns) -> Drawn:  # noqa: ARG001
    """Fig. 2, from the slides under three frictions."""
    s, profile = ACCELERATIONS, Profile(ACCELERATIONS, D_GOAL_M)
    time_s = _fine(profile)
    velocity = profile.finger.at(time_s, 1)
    nominal, less, more = (
        velocity - profile.slide(s.a_o * ratio).motion.at(time_s, 1) for ratio in (1.0, 1.0 - EPS, 1.0 + EPS)
    )
    short, long = abs(d_2(profile, EPS)), abs(d_3(profile, EPS))
    areas = (abs(D_GOAL_M) - short, short, long)
    figure = draw_friction_error(
        FrictionErrorPicture(time_s, velocity, nominal, less, more, EPS, areas, _edges(profile))
    )
    caption = (
        f"The same motion when friction is {100 * EPS:g} % more or less than estimated. The areas are distances: "
        f"with more friction the object slides d1 = {1e3 * areas[0]:.1f} mm, d2 = {1e3 * short:.1f} mm too short "
        "(eq. 5), "
        f"with less it slides d3 = {1e3 * long:.1f} mm too far (eq. 6). Theorem 1 holds up to "
        f"$ε$ = {eps_limits(s).eps_star:g} for these accelerations. The paper's text sets d3 + d4 = d_goal, while "
        "its eqs. (6) "
        "and (7) put d3 on top of d_goal; the picture follows the equations. No run: mechanics alone."
    )
    return Drawn(figure, caption)


def fig03(runs: PaperRuns) -> Drawn:
    """Fig. 3, of the experiment of Section VIII-B at the moment in which it begins to slide."""
    planned, motion = runs.rotational, runs.rotational.motion
    start_s = planned.document.slide.start_s
    index = motion.during(start_s, start_s).start
    experiment = planned.experiment
    thing, grasp = experiment.object, experiment.grasp
    data = PinchPicture(
        q_o=motion.q_o[index],
        q_f=motion.q_f[index],
        block_size_m=np.array([thing.size_x_m, thing.size_y_m]),
        thickness_m=thing.thickness_m,
        patch_radius_m=grasp.contact_radius_m,
        normal_force_per_finger_n=grasp.normal_force_per_finger_n,
    )
    caption = (
        f"An object in a two-fingered pinch, drawn from {experiment.name}.yaml: (a) in the plane of motion, at "
        f"{start_s:g} s of plan {planned.run.id}; {{w}} is the world frame, {{b}} the body's at its centre of mass, "
        f"{{f}} the finger's, with $q_f = q_o + r_f$. (b) Across the plane: two fingers with patches of radius "
        f"$a$ = {1e3 * grasp.contact_radius_m:g} mm press from both sides. Block {1e3 * thing.size_x_m:g} mm by "
        f"{1e3 * thing.size_y_m:g} mm and {1e3 * thing.mass_kg:g} g as in the paper; its thickness of "
        f"{1e3 * thing.thickness_m:g} mm is ours, the paper gives none."
    )
    return Drawn(draw_pinch(data), caption)


def fig04(runs: PaperRuns) -> Drawn:
    """Fig. 4, for the finger of Section VIII-A."""
    experiment = runs.experiment(LINEAR)
    finger = setup(experiment, experiment.friction).finger
    f_c = finger.friction(SLIDING_AT)
    scale = np.array([1.0, 1.0, 1.0 / finger.a])
    figure = draw_limit_surface(SurfacePicture(finger.semi_axes * scale, f_c * scale, SLIDING_AT / scale))
    angle = np.degrees(np.arccos(_cosine(f_c * scale, SLIDING_AT / scale)))
    caption = (
        f"Limit surface of eq. (10) for {experiment.name}: $μ f_N$ = {finger.mu * finger.f_N:.4g} N, largest moment "
        f"$c a μ f_N$ = {1e3 * finger.semi_axes[2]:.3g} mN m, with $c$ = {finger.c:g} as in the paper. The sliding "
        "velocity "
        f"$Δv$ is along the normal at the friction force $f_c$ (eq. 11); here they are {angle:.0f}° apart. $m_z$ is "
        "divided "
        "by $a$. No run: mechanics alone."
    )
    return Drawn(figure, caption)


def fig05(runs: PaperRuns) -> Drawn:
    """Fig. 5, for three fingers on one side and one on the other."""
    small = SoftFinger.growing(MU, FINGER_N, PATCH_M, 1 / 3, 0.6)
    large = SoftFinger.growing(MU, 3.0 * FINGER_N, PATCH_M, 1 / 3, 0.6)
    thing = runs.experiment(LINEAR).object
    whole = GraspSurface([small, small, small, large], PLACES_M)
    panels = (
        _mapped("fingers 1 to 3 in their frames", small, PLACES_M[3]),
        *(_mapped(f"finger {index + 1} in {{b}}", small, PLACES_M[index]) for index in range(3)),
        _mapped("finger 4 in its own frame", large, PLACES_M[3]),
        _mapped("finger 4 in {b}", large, PLACES_M[3]),
        _panel("the grasp in {b}", whole.mesh(3)),
    )
    radius = np.array([small.a] * 3 + [large.a])
    size = np.array([thing.size_y_m, thing.size_x_m])
    most = [float(whole.support(axis)) for axis in np.eye(3)]
    caption = (
        "A grasp with three fingers on one side and one on the other, and its limit surfaces: exact sums of support "
        f"functions (eq. 16), not sampled hulls. The paper gives no numbers; here $μ$ = {MU:g}, {FINGER_N:g} N on "
        "fingers 1 to "
        f"3 and {3 * FINGER_N:g} N on finger 4, patches of {1e3 * small.a:.0f} and {1e3 * large.a:.1f} mm. As in the "
        "paper the "
        "mapping to {b} shears the ellipsoids of fingers off the centre, and finger 4's is left as it is. The grasp "
        f"resists {most[0]:.3g} N along x and y and {1e3 * most[2]:.3g} mN m. Moments are divided by "
        f"{1e3 * LEVER_M:g} mm; "
        "(h) has a scale of its own. No run: mechanics alone."
    )
    return Drawn(draw_grasp_surface(GraspPicture(size, PLACES_M, radius, panels)), caption)


def _mapped(title: str, finger: SoftFinger, place: FloatArray) -> SurfacePanel:
    """A finger's own surface, taken about a centre from which it is ``place`` (2,) away: G_i of eq. (15)."""
    mesh = GraspSurface([finger], np.zeros((1, 2))).mesh(3)
    return _panel(title, replace(mesh, vertices=about_com(mesh.vertices, np.append(place, 0.0))))


def _panel(title: str, mesh: SurfaceMesh) -> SurfacePanel:
    return SurfacePanel(title, mesh.vertices / [1.0, 1.0, LEVER_M], mesh.faces)


def _fine(profile: Profile) -> FloatArray:
    """Times with both sides of every jump."""
    edges = np.array(_edges(profile))
    return np.unique(np.concatenate([np.linspace(0.0, profile.T, 801), edges, edges[1:] - 1e-9]))


def _edges(profile: Profile) -> tuple[float, ...]:
    return tuple(float(one) for one in np.cumsum([0.0, profile.T1, profile.T2, profile.T3, profile.T4]))


def _cosine(one: FloatArray, other: FloatArray) -> float:
    return float(one @ other / (np.linalg.norm(one) * np.linalg.norm(other)))
