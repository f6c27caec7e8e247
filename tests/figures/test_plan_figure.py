import itertools
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from paper_cases import rotational_setup

from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.figures.plan import PhaseSpan, PlanPicture, Robustness, draw_plan
from slidepipe.mechanics.dynamics import about_com
from slidepipe.mechanics.planar import rotation
from slidepipe.planning.planner import Plan


@pytest.fixture(scope="module")
def picture(rotational_plan: Plan) -> PlanPicture:
    setup, motion = rotational_setup(), rotational_plan.motion
    start, slide, _, settle, stop = rotational_plan.course.boundaries
    wrench = np.einsum("tji,tj->ti", rotation(motion.q_o[:, 2]), setup.block.M * motion.ddq_o - setup.block.g)
    f_f = np.einsum("tji,tj->ti", rotation(motion.r_b[:, 2]), about_com(wrench, -motion.r_b))
    return PlanPicture(
        title="a plan",
        phases=(PhaseSpan("stick", start, slide), PhaseSpan("slide", slide, settle), PhaseSpan("settle", settle, stop)),
        time_s=motion.time_s,
        q_o=motion.q_o,
        q_f=motion.q_f,
        r_f_b=motion.r_b,
        ddq_o=motion.ddq_o,
        ddq_f=motion.ddq_f,
        f_f=f_f,
        semi_axes=setup.finger.semi_axes,
        patch_radius_m=setup.finger.a,
        block_size_m=np.array([setup.block.length, setup.block.width]),
    )


def told() -> Robustness:
    ratio = np.linspace(0.9, 1.1, 5)
    return Robustness(ratio, np.abs(ratio - 1.0), np.array([np.nan, -0.1, 0.0, 0.1, 0.2]), eps_low=0.05, eps_high=0.1)


def test_the_friction_of_the_slide_lies_on_the_surface_and_that_of_the_rest_within(picture):
    scaled = picture.semi_axes / [1.0, 1.0, picture.patch_radius_m]
    space = draw_plan(picture).axes[-1]
    for phase in picture.phases:
        look = style.PHASES[phase.kind]
        drawn = [one for one in space.lines if one.get_linewidth() == 2.2 and one.get_color() == look["color"]]
        (path,) = [np.array(one.get_data_3d()).T for one in drawn]
        gauge = np.linalg.norm(path / scaled, axis=1)
        assert len(path) == round((phase.stop_s - phase.start_s) / 0.002)
        if phase.kind == "slide":
            np.testing.assert_allclose(gauge, 1.0, rtol=1e-9)
        else:
            assert gauge.max() < 1.0


def test_the_block_is_drawn_where_each_phase_ends_and_the_path_without_gaps(picture):
    plane = draw_plan(picture).axes[0]
    moments = [0.0, *(phase.stop_s for phase in picture.phases)]
    blocks = [one for one in plane.patches if to_hex(one.get_facecolor()) == style.BLOCK["facecolor"]]
    centres = [one.get_xy()[:4].mean(axis=0) for one in blocks]
    expected = [picture.q_o[np.argmin(np.abs(picture.time_s - moment)), :2] for moment in moments]
    np.testing.assert_allclose(centres, expected, atol=1e-12)
    assert [text.get_text() for text in plane.texts] == ["0.00 s", "0.30 s", "0.50 s", "0.80 s"]
    paths = [one.get_xydata() for one in plane.lines if one.get_color() == "#b3261e"]
    for before, after in itertools.pairwise(paths):
        np.testing.assert_allclose(before[-1], after[0])


def test_robustness_is_drawn_where_it_is_known(picture):
    figure = draw_plan(replace(picture, robustness=told()))
    panel = figure.axes[-1]
    np.testing.assert_allclose(panel.lines[1].get_ydata(), 1e3 * told().error_m)
    assert panel.get_legend().get_title().get_text() == "survived: 0.95 to 1.1"
    (span,) = panel.patches
    assert (span.get_x(), span.get_x() + span.get_width()) == pytest.approx((0.95, 1.1))
    assert len(figure.axes) == len(draw_plan(picture).axes) + 1


def test_series_that_do_not_belong_together_are_told(picture):
    with pytest.raises(InputError, match=r"^figure: q_f of a plan must be one pose"):
        replace(picture, q_f=picture.q_f[:-1])
    with pytest.raises(InputError, match="has one phase at least, got none"):
        replace(picture, phases=())
