import signal

import pytest
from hypothesis import settings
from paper_cases import LINEAR, ROTATIONAL, linear_setup, rotational_setup

from slidepipe.planning.planner import Plan, plan

# The same examples in every run, and no verdict on how busy the machine is.
settings.register_profile("slidepipe", deadline=None, derandomize=True)
settings.load_profile("slidepipe")

# A suite that was begun in the background ignores Ctrl-C, and so would every process that it starts and interrupts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def linear_plan() -> Plan:
    """Section VIII-A with 1.25 N in all, planned down to the joints."""
    return plan(LINEAR, linear_setup())


@pytest.fixture(scope="session")
def rotational_plan() -> Plan:
    """Section VIII-B with 2.5 N in all, planned down to the joints."""
    return plan(ROTATIONAL, rotational_setup())
