"""The paper's numbers beside ours, each with the difference and its reason."""

from dataclasses import replace

import numpy as np
from scipy.optimize import fsolve

from slidepipe.artifacts import topics
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.mechanics.one_dof import Profile
from slidepipe.mechanics.pressure_patch import torsion_constant
from slidepipe.mechanics.theorem_1 import contraction_bound, contraction_factor, d_2, eps_limits, theorem_1
from slidepipe.planning.three_phase import ThreePhaseMotion
from slidepipe.series import FloatArray, IntArray
from slidepipe.stages.paper_claim import Claim, less
from slidepipe.stages.paper_given import followed, given
from slidepipe.stages.paper_repeats import PAPER_ERROR, PAPER_SD, friction_for_miss, repeat_error
from slidepipe.stages.paper_runs import FRICTION_SD, PaperRuns, Planned, Tried
from slidepipe.stages.paper_theory import ACCELERATIONS, D_GOAL_M, EPS
from slidepipe.stages.translate import block, first_regrasp, setup
from slidepipe.stages.trial_facts import RECORDING


def claims(runs: PaperRuns) -> tuple[Claim, ...]:
    """Every number of the paper that can be compared, in the paper's order."""
    return (
        *_one_dof(),
        *_theorem(),
        *_surface(),
        *given(runs),
        *_planned(runs.linear, "VIII-A", (0.3, 0.2, 1.1), (2.0, 4.0, 0.0)),
        *_planned(runs.rotational, "VIII-B", (0.3, 0.2, 0.3), (2.0, 0.0, 25.0 * np.pi)),
        *_forces(runs),
        *_recorded(runs.nominal),
        *followed(runs),
        *_errors(runs),
    )


def _one_dof() -> tuple[Claim, ...]:
    profile, s = Profile(ACCELERATIONS, D_GOAL_M), ACCELERATIONS

    def constraints(times: FloatArray) -> list[float]:
        T1, T2, T3 = (float(one) for one in times)
        return [
            2.0 * s.a * T1 - s.a_f * T2,
            s.a_o * (T2 + T3) - s.a * (2.0 * T1 - T3),
            D_GOAL_M + 0.5 * (s.a_f - s.a_o) * (T2**2 + T2 * T3),
        ]

    solved = fsolve(constraints, [0.1, 0.1, 0.1], xtol=1e-13)
    closed = {"T1": profile.T1, "T2": profile.T2, "T3": profile.T3}
    rows = [
        Claim(
            "III-C, eq. (4)", f"{name}, Fig. 1", f"{value:.6f} s", f"{found:.6f} s", less(found - value, "s"), FORMULA
        )
        for (name, value), found in zip(closed.items(), solved, strict=True)
    ]
    ours = profile.T - sum(closed.values())
    last = Claim("III-C", "T4, Fig. 1", "T1 - T3", f"{ours:.6f} s", less(ours - profile.T4, "s"), "T34 = T1")
    return (*rows, last)


FORMULA = "the paper gives the formula: its value beside eqs. (1) to (3) solved numerically"


def _theorem() -> tuple[Claim, ...]:
    s, limits, told = ACCELERATIONS, eps_limits(ACCELERATIONS), theorem_1(ACCELERATIONS, EPS)
    worst = max(contraction_factor(s, s.a_o * (1.0 - EPS)), contraction_factor(s, s.a_o * (1.0 + EPS)))
    bound, short = contraction_bound(s, EPS), abs(d_2(Profile(s, D_GOAL_M), EPS) / D_GOAL_M)
    where = "III-D, Theorem 1"
    return (
        Claim(where, f"1: a below, ε = {EPS}", f"{told.sticks.right:.2f} m/s²", f"a = {s.a:g}", "holds", "as printed"),
        Claim(
            where,
            f"2: a_f above, ε = {EPS}",
            f"{told.slides.right:.2f} m/s²",
            f"a_f = {s.a_f:g}",
            "holds",
            "as printed",
        ),
        Claim(
            where, f"3: a_f above, ε = {EPS}", f"{told.stops.right:.2f} m/s²", f"a_f = {s.a_f:g}", "holds", "as printed"
        ),
        Claim(
            where,
            "3: largest ε",
            "no bound once its denominator is negative",
            f"{limits.stops:.4f}",
            "a fourth condition",
            f"it says nothing unless a + (1 - 2 ε) a_o is positive: ε below {limits.can_stop:g}",
        ),
        Claim(
            where,
            "largest ε of all",
            "not given",
            f"{limits.eps_star:.4f}",
            "-",
            f"set by the condition that it {limits.binding}",
        ),
        Claim(
            "III-D, eq. (5)",
            f"|d2/d_goal|, ε = {EPS}",
            f"{short:.6f}",
            f"{contraction_factor(s, s.a_o * (1.0 + EPS)):.6f}",
            less(contraction_factor(s, s.a_o * (1.0 + EPS)) - short),
            "the formula beside the simulated slide with more friction",
        ),
        Claim(
            "III-D, eq. (6)",
            f"|d3/d_goal|, ε = {EPS}",
            f"{bound:.6f}",
            f"{worst:.6f}",
            less(worst - bound),
            "the formula beside the worst of the simulated slides",
        ),
    )


def _surface() -> tuple[Claim, ...]:
    hertz = torsion_constant(2.0)
    reason = "the paper rounds; ours is exact for Hertz's pressure (3 π/16), plans use the paper's"
    return (Claim("V-B", "c of the largest moment", "0.6", f"{hertz:.4f}", f"{hertz - 0.6:+.4f}", reason),)


def _planned(
    planned: Planned, section: str, times_s: tuple[float, ...], acceleration: tuple[float, ...]
) -> tuple[Claim, ...]:
    spans = [phase.stop_s - phase.start_s for phase in planned.document.phases]
    rows = [
        Claim(section, name, f"{wanted:g} s", f"{got:.3g} s", less(got - wanted, "s"), "as the experiment file says")
        for name, wanted, got in zip(("T1", "T23", "T4"), times_s, spans, strict=True)
    ]
    got = planned.document.slide.relative_acceleration
    units = ("m/s²", "m/s²", "rad/s²")
    rows += [
        Claim(
            section,
            f"relative acceleration, {axis}",
            f"{wanted:.4g} {unit}",
            f"{value:.4g} {unit}",
            less(value - wanted, unit),
            "paper's choice; ours is 4 (goal - start)/T23²",
        )
        for axis, wanted, value, unit in zip(("x", "y", "θ"), acceleration, got, units, strict=True)
    ]
    reach = float(np.max(np.linalg.norm(planned.motion.q_f[:, :2], axis=1)))
    radius = planned.experiment.workspace.radius_m
    reason = "the largest distance of the hand from the origin; the circle is read as its diameter"
    rows.append(
        Claim(
            section, "workspace", "1 m circle", f"{reach:.3f} m", f"{radius - reach:.3f} m left of {radius:g} m", reason
        )
    )
    return tuple(rows)


def _forces(runs: PaperRuns) -> tuple[Claim, ...]:
    rows = []
    for planned, section, printed in ((runs.linear, "VIII-A", 1.25), (runs.rotational, "VIII-B", 2.5)):
        per_finger = planned.experiment.grasp.normal_force_per_finger_n
        reason = (
            f"read as {printed:g} N each, the hand would have to reach {_peak_speed(planned, printed):.1f} m/s, "
            "beyond a "
            f"WAM; read as that of both it reaches {_peak_speed(planned, per_finger):.1f} m/s"
        )
        rows.append(
            Claim(
                section,
                "normal force of a finger",
                f"{printed:g} N",
                f"{per_finger:g} N",
                f"{per_finger - printed:+g} N",
                reason,
            )
        )
    return tuple(rows)


def _peak_speed(planned: Planned, force_per_finger_n: float) -> float:
    """Largest speed of the hand, m/s, if every finger pressed so hard; no limit is asked."""
    experiment = planned.experiment
    finger = setup(experiment, experiment.friction).finger
    finger = replace(finger, f_N=experiment.grasp.finger_count * force_per_finger_n)
    motion = ThreePhaseMotion(first_regrasp(experiment), block(experiment), finger).sample(planned.motion.time_s)
    return float(np.max(np.linalg.norm(motion.dq_f[:, :2], axis=1)))


def _recorded(tried: Tried) -> tuple[Claim, ...]:
    recording = read_recording(tried.runs.execute.file(RECORDING))
    joints_hz = _rate_hz(recording.joints(topics.MEASURED).stamp_ns)
    frames = recording.mocap().frames
    frames_hz = (frames.frame[-1] - frames.frame[0]) / (1e-9 * (frames.received_ns[-1] - frames.received_ns[0]))
    return (
        Claim(
            "IX",
            "control loop",
            "500 Hz",
            f"{joints_hz:.1f} Hz",
            f"{joints_hz - 500:+.1f} Hz",
            "counted in the recording",
        ),
        Claim(
            "IX", "cameras", "360 Hz", f"{frames_hz:.1f} Hz", f"{frames_hz - 360:+.1f} Hz", "counted in the recording"
        ),
    )


def _errors(runs: PaperRuns) -> tuple[Claim, ...]:
    told = repeat_error(runs)
    reasons = (
        f"our worlds differ in friction alone, by {100 * FRICTION_SD:g} % s.d. about the belief: no common miss",
        "the same; the plan's own sensitivity makes so small a spread so wide",
        "so large a turn does not come of wrong friction: tracking, an uneven grip or a start that was off",
    )
    rows = []
    for index, (axis, scale, unit) in enumerate((("x", 1e3, "mm"), ("y", 1e3, "mm"), ("θ", 1e3, "mrad"))):
        paper, ours = scale * PAPER_ERROR[index], scale * told.mean[index]
        rows.append(
            Claim(
                "IX",
                f"final error, {axis}",
                f"{paper:.1f} ± {scale * PAPER_SD[index]:.1f} {unit}",
                f"{ours:.1f} ± {scale * told.sd[index]:.1f} {unit}",
                f"{ours - paper:+.1f} {unit}",
                reasons[index],
            )
        )
    miss = float(np.hypot(*PAPER_ERROR[:2]))
    ratio = friction_for_miss(runs.linear, miss)
    rows.append(
        Claim(
            "IX",
            "friction that explains the mean miss",
            f"{1e3 * miss:.1f} mm short",
            f"{100 * (ratio - 1):.1f} % above belief",
            "-",
            "so much more slides as far short, but along the planned way (1 to 2): the paper's miss is 1.03 to 1.12",
        )
    )
    return tuple(rows)


def _rate_hz(stamp_ns: IntArray) -> float:
    return float((len(stamp_ns) - 1) / (1e-9 * (stamp_ns[-1] - stamp_ns[0])))
