"""Documents and runs as the stages make them, with numbers that a test can look for."""

from pathlib import Path

from slidepipe.artifacts.campaign import CampaignDocument, CampaignOutcome, CampaignRow, CampaignRuns
from slidepipe.artifacts.estimate import (
    Assumed,
    Budget,
    ClockFit,
    Derived,
    EstimateDocument,
    FrictionEstimate,
    JointClock,
    Measured,
    SlideFound,
)
from slidepipe.artifacts.manifest import (
    Code,
    Environment,
    ErrorNote,
    InputRef,
    Manifest,
    OutputRef,
    Result,
    RunState,
    Times,
)
from slidepipe.artifacts.plan import Belief, LimitCheck, Phase, PlanDocument, Slide
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.trial import FrameCounts, TrackingError, TrialDocument, TruthDocument
from slidepipe.artifacts.values import Pose, UncertainPose

PLAN = "20261124T093012Z-k3f9q2aw"
TRIAL = "20261124T093015Z-m0x7c4td"
ESTIMATE = "20261124T093044Z-9zq1h8vn"
CAMPAIGN = "20261124T093010Z-7jw2e5rb"
PI = 3.141592653589793
START = Pose(x_m=-0.01, y_m=-0.02, theta_rad=PI)
GOAL = Pose(x_m=0.01, y_m=0.02, theta_rad=PI)


def run(run_id: str, stage: str, *, root: Path = Path("data"), **changes: object) -> Run:
    day = f"{run_id[:4]}-{run_id[4:6]}-{run_id[6:8]}"
    values = {
        "run": run_id,
        "stage": stage,
        "stage_version": 1,
        "experiment": "regrasp",
        "state": RunState.COMPLETE,
        "times": Times(started="2026-11-24T09:30:12.000000Z", finished="2026-11-24T09:30:14.500000Z"),
        "recipe": "5e" * 32,
        "seed": None,
        "parameters": {},
        "inputs": (),
        "outputs": (),
        "results": (),
        "error": None,
        "code": Code(version="0.1.0", commit="7deb796" + "0" * 33, dirty=False),
        "environment": Environment(python="3.11.2", platform="Linux", host="bench", packages={}),
        "command": ("slidepipe", stage),
    }
    return Run(root / "runs" / day / run_id, Manifest(**(values | changes)))


def output(role: str, file: str) -> OutputRef:
    return OutputRef(role=role, file=file, sha256="cd" * 32, size=3120)


def plan_run(root: Path = Path("data")) -> Run:
    return run(
        PLAN,
        "plan",
        root=root,
        inputs=(InputRef(role="experiment", sha256="ab" * 32, size=2473, run=None, file="experiments/regrasp.yaml"),),
        outputs=(
            OutputRef(role="plan", file="plan.yaml", sha256="cd" * 32, size=3120),
            OutputRef(role="reference", file="reference.mcap", sha256="ef" * 32, size=203_400),
        ),
        results=(
            Result(name="peak_hand_speed", value=1.234567, std=None, unit="m/s"),
            Result(name="stick_load", value=0.8123, std=None, unit="1"),
            Result(name="peak_elbow_speed", value=0.5, std=0.01, unit="m/s"),
        ),
        command=("slidepipe", "plan", "experiments/regrasp.yaml"),
    )


def failed_run(root: Path = Path("data")) -> Run:
    return run(
        TRIAL,
        "execute",
        root=root,
        state=RunState.FAILED,
        seed=7,
        error=ErrorNote(type="LabError", message="joint 4: is 0.3 rad away from its command"),
        times=Times(started="2026-11-24T09:30:15.000000Z", finished="2026-11-24T09:30:16.000000Z"),
        code=Code(version="0.1.0", commit=None, dirty=None),
    )


def plan(*, trial: int = 1) -> PlanDocument:
    return PlanDocument(
        experiment="regrasp",
        trial=trial,
        reason="first plan of the experiment"
        if trial == 1
        else "13.42 mm and 0.4 mrad remain; friction from the estimate",
        previous_estimate=None if trial == 1 else ESTIMATE,
        believed=Belief(friction=0.38, friction_std=None if trial == 1 else 0.00188, kappa_m_s2=20.652, rho_m=0.01044),
        start_relative_pose=START,
        goal_relative_pose=GOAL,
        object_start_pose=Pose(x_m=0.0, y_m=0.0, theta_rad=0.0),
        hand_start_pose=START,
        hand_end_pose=GOAL,
        phases=(
            Phase(name="stick", start_s=0.0, stop_s=0.3, object_acceleration=(-0.7654, 1.25, 0.0)),
            Phase(name="slide", start_s=0.3, stop_s=0.46, object_acceleration=None),
            Phase(name="settle", start_s=0.46, stop_s=1.26, object_acceleration=(0.5, -2.0, 0.0001)),
        ),
        object_velocity_at_slide=(-0.22962, 0.375, 0.0),
        slide=Slide(start_s=0.3, switch_s=0.38, stop_s=0.46, relative_acceleration=(3.125, 6.25, 0.0)),
        margins=(
            LimitCheck(
                name="share of the friction used while sticking before the slide",
                value=0.8123,
                bound=1.0,
                unit="of 1",
                time_s=0.298,
                satisfied=True,
            ),
        ),
        limits=(
            *(
                LimitCheck(
                    name=f"joint {joint} torque", value=joint, bound=10.0, unit="N m", time_s=0.3, satisfied=True
                )
                for joint in range(1, 8)
            ),
            LimitCheck(name="hand speed", value=1.2345678, bound=3.0, unit="m/s", time_s=0.38, satisfied=True),
            LimitCheck(name="elbow speed", value=0.5, bound=2.5, unit="m/s", time_s=0.4, satisfied=True),
        ),
        reference_file="reference.mcap",
    )


def trial(outcome: str = "held") -> TrialDocument:
    return TrialDocument(
        plan=PLAN,
        lab="simulated",
        seed=7,
        outcome=outcome,
        started_ns=0,
        finished_ns=1_560_000_000,
        frames=FrameCounts(taken=562, hand_missing=11, object_missing=9, longest_gap_s=0.0083),
        tracking_error=TrackingError(
            position_rms_m=0.00123, position_peak_m=0.0034, angle_rms_rad=0.0021, angle_peak_rad=0.0056
        ),
        recording_file="trial.mcap",
    )


def truth(outcome: str = "held") -> TruthDocument:
    return TruthDocument(
        friction=0.4256,
        normal_force_per_finger_n=0.625,
        kappa_m_s2=23.13,
        rho_m=0.01044,
        initial_relative_pose=START,
        final_relative_pose=Pose(x_m=0.00402, y_m=0.00804, theta_rad=3.142),
        slide_start_s=0.312,
        slide_stop_s=0.446,
        outcome=outcome,
    )


def estimate(*, friction: bool = True, lost: str | None = None) -> EstimateDocument:
    found = FrictionEstimate(
        kappa_m_s2=Measured(value=23.1, std=0.1, interval_95=(22.9, 23.3)),
        mu=Derived(value=0.42504, interval_95=(0.42136, 0.42872)),
        rho_m=None,
        assumed=Assumed(normal_force_n=1.25, mass_kg=0.023, rho_m=0.01044),
        mu_budget=Budget(
            kappa_relative_std=0.004,
            normal_force_relative_std=0.05,
            mass_relative_std=0.01,
            mu_relative_std=0.0511,
        ),
        fit=None,
    )
    return EstimateDocument(
        trial=TRIAL,
        clock=ClockFit(offset_s=12.300012, rate_ppm=20.1, residual_std_s=0.0000123),
        joints=JointClock(offset_s=0.0003, offset_std_s=2e-5, gravity_angle_rad=0.0012, gravity_angle_std_rad=0.0005),
        frames_used=542,
        outliers=3,
        smoothing=None,
        initial_relative_pose=uncertain(-0.01, -0.02, PI),
        final_relative_pose=uncertain(0.004, 0.0081, PI) if lost is None else None,
        lost=lost,
        slide=SlideFound(start_s=0.3112, stop_s=0.4459) if friction else None,
        friction=found if friction else None,
        friction_missing_because=None if friction else "the object did not slide",
        not_told=("torsion: this slide hardly turns",),
        notes=("two gaps",),
        series_file="smoothed.mcap",
    )


def uncertain(x_m: float, y_m: float, theta_rad: float) -> UncertainPose:
    return UncertainPose(x_m=x_m, y_m=y_m, theta_rad=theta_rad, x_std_m=3e-5, y_std_m=2e-5, theta_std_rad=0.0004)


def row(number: int, *, simulated: bool = True, reached: UncertainPose | None = None, **changes: object) -> CampaignRow:
    values = {
        "trial": number,
        "runs": CampaignRuns(plan=PLAN, execute=TRIAL, estimate=ESTIMATE),
        "outcome": "held",
        "planned_relative_pose": GOAL,
        "reached_relative_pose": reached or uncertain(0.004, 0.0081, -3.1415),
        "true_relative_pose": Pose(x_m=0.00402, y_m=0.00804, theta_rad=3.142) if simulated else None,
        "error_m": 0.013331,
        "error_rad": 0.0001,
        "true_error_m": 0.01337 if simulated else None,
        "true_error_rad": 0.0004 if simulated else None,
        "believed_friction": 0.38,
        "estimated_friction": 0.42504,
        "estimated_friction_interval_95": (0.42136, 0.42872),
        "true_friction": 0.4256 if simulated else None,
    }
    return CampaignRow(**(values | changes))


def lost_row(number: int) -> CampaignRow:
    return row(
        number,
        outcome="lost",
        reached_relative_pose=None,
        error_m=None,
        error_rad=None,
        estimated_friction=None,
        estimated_friction_interval_95=None,
    )


def campaign(
    *rows: CampaignRow,
    outcome: CampaignOutcome = "converged",
    because: str | None = None,
    what_to_do: str | None = None,
) -> CampaignDocument:
    pictures = ("tracking.png", "sliding.png")
    return CampaignDocument(
        experiment="regrasp",
        rows=rows,
        converged=outcome == "converged",
        outcome=outcome,
        stopped_because=because,
        what_to_do=what_to_do,
        pictures=pictures,
    )
