"""The control loop: hold, move, hold; the same for every arm."""

from dataclasses import dataclass

import numpy as np

from slidepipe.lab.protocols import Arm, JointCommand, JointState, MotionCapture, Recorder
from slidepipe.series import FloatArray, JointSeries
from slidepipe.tick import TICK_S

REST_S = 0.5
"""How long the arm holds before and after the motion, so that the cameras see both grips at rest."""
ECHO_PERIOD_S = 0.1
MOTION_STARTS = "motion starts"
MOTION_ENDS = "motion ends"


@dataclass(frozen=True, slots=True)
class Execution:
    """One execution: when the motion began and ended on the host's clock, and how the joints followed, (T, 7) rad."""

    start_ns: int
    stop_ns: int
    joint_error_rad: FloatArray


def execute(reference: JointSeries, arm: Arm, cameras: MotionCapture, recorder: Recorder) -> Execution:
    """Run a reference at one sample a tick, with a rest before and after, and record everything.

    Parameters
    ----------
    reference : JointSeries
        Joint angles, speeds and torques beyond gravity at the loop's rate.
    arm, cameras, recorder
        The lab, and where to put what it says.

    Returns
    -------
    Execution
    """
    loop = _Loop(arm, cameras, recorder)
    rest = round(REST_S / TICK_S)
    commands = [
        JointCommand(*sample)
        for sample in zip(reference.position_rad, reference.velocity_rad_s, reference.effort_n_m, strict=True)
    ]
    for _ in range(rest):
        loop.tick(commands[0].held())
    errors = []
    for index, command in enumerate(commands):
        state = loop.tick(command)
        if index == 0:
            start_ns = state.stamp_ns
            recorder.event(start_ns, MOTION_STARTS)
        errors.append(command.position_rad - state.position_rad)
    recorder.event(state.stamp_ns, MOTION_ENDS)
    for _ in range(rest):
        loop.tick(commands[-1].held())
    return Execution(start_ns, state.stamp_ns, np.array(errors))


class _Loop:
    """One tick after another, with an echo of the cameras every so often."""

    def __init__(self, arm: Arm, cameras: MotionCapture, recorder: Recorder) -> None:
        self._arm, self._cameras, self._recorder = arm, cameras, recorder
        self._count = 0
        self._echo_every = round(ECHO_PERIOD_S / TICK_S)

    def tick(self, command: JointCommand) -> JointState:
        if self._count % self._echo_every == 0:
            exchange = self._cameras.echo()
            if exchange is not None:
                self._recorder.clock(exchange)
        self._count += 1
        state = self._arm.exchange(command)
        self._recorder.joints(command, state)
        for frame in self._cameras.take():
            self._recorder.frame(frame)
        return state
