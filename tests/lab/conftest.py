import numpy as np
import pytest
from emulated import COARSE
from lab_setups import CAMERAS, Notes, Trial, reference, run_trial, world
from paper_cases import linear_setup, rotational_setup

from slidepipe.lab.course import rest_move_rest
from slidepipe.lab.loop import execute
from slidepipe.lab.simulated import SimulatedLab, Tracker
from slidepipe.planning.planner import Plan, Setup, plan
from slidepipe.planning.three_phase import Regrasp
from slidepipe.series import FloatArray


@pytest.fixture(scope="session")
def perfect_linear(linear_plan: Plan) -> Trial:
    """Section VIII-A by an arm that follows exactly."""
    return run_trial(linear_plan, linear_setup(), Tracker.PERFECT)


@pytest.fixture(scope="session")
def perfect_rotational(rotational_plan: Plan) -> Trial:
    """Section VIII-B by an arm that follows exactly."""
    return run_trial(rotational_plan, rotational_setup(), Tracker.PERFECT)


@pytest.fixture(scope="session")
def wam_linear(linear_plan: Plan) -> Trial:
    """Section VIII-A by the simulated WAM with feedforward."""
    return run_trial(linear_plan, linear_setup(), Tracker.FEEDFORWARD)


@pytest.fixture(scope="session")
def vendor_linear(linear_plan: Plan) -> Trial:
    """Section VIII-A by the simulated WAM with the vendor's joint control alone."""
    return run_trial(linear_plan, linear_setup(), Tracker.VENDOR)


@pytest.fixture(scope="session")
def short_setup() -> Setup:
    """What :func:`short_plan` is made for."""
    return linear_setup()


@pytest.fixture(scope="session")
def short_plan(short_setup: Setup) -> Plan:
    """The demonstration's regrasp: the block hangs upright in the grip, and the motion lasts 0.84 s."""
    upright = np.arctan2(0.01, 0.02)
    task = Regrasp(
        q_o_start=np.array([0.0, 0.0, upright]),
        r_start=np.array([-0.01, -0.02, np.pi]),
        r_goal=np.array([0.01, 0.02, np.pi]),
        q_f_end=np.array([0.0, np.hypot(0.01, 0.02), np.pi + upright]),
        T1=0.3,
        T23=0.14,
        T4=0.4,
    )
    return plan(task, short_setup)


@pytest.fixture(scope="session")
def short_landing(short_plan: Plan, short_setup: Setup) -> FloatArray:
    """Where the finger ends on the block in virtual time, without a wire."""
    start = reference(short_plan)
    lab = SimulatedLab(
        world(short_setup, prescribed=False, contact=COARSE),
        Tracker.FEEDFORWARD,
        CAMERAS,
        start.position_rad[0],
        short_plan.course.r_start,
        random=np.random.default_rng(1),
    )
    execute(rest_move_rest(start), lab, lab, Notes())
    return lab.relative_pose()
