import pytest
from lab_setups import Trial, run_trial
from paper_cases import linear_setup, rotational_setup

from slidepipe.lab.simulated import Tracker
from slidepipe.planning.planner import Plan


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
