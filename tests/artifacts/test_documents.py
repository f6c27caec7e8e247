from pathlib import Path

import pytest

from slidepipe.artifacts.campaign import CampaignDocument, CampaignRow, CampaignRuns
from slidepipe.artifacts.estimate import (
    Assumed,
    Budget,
    ClockFit,
    Derived,
    EstimateDocument,
    Fit,
    FrictionEstimate,
    JointClock,
    Measured,
    SlideFound,
    Smoothing,
)
from slidepipe.artifacts.plan import Belief, LimitCheck, Phase, PlanDocument, Slide
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.strict_yaml import load, loads
from slidepipe.artifacts.trial import FrameCounts, TrackingError, TrialDocument, TruthDocument
from slidepipe.artifacts.values import Pose, UncertainPose
from slidepipe.errors import InputError

RUN = "20261123T093012Z-k3f9q2aw"
POSE = Pose.of([0.01, 0.02, 3.1])
REACHED = UncertainPose(x_m=0.01, y_m=0.02, theta_rad=3.1, x_std_m=1e-5, y_std_m=1e-5, theta_std_rad=1e-4)

PLAN = PlanDocument(
    experiment="paper_linear",
    trial=2,
    reason="friction as estimated",
    previous_estimate=RUN,
    believed=Belief(friction=0.38, friction_std=None, kappa_m_s2=20.6, rho_m=0.01),
    start_relative_pose=POSE,
    goal_relative_pose=POSE,
    object_start_pose=POSE,
    hand_start_pose=POSE,
    hand_end_pose=POSE,
    phases=(
        Phase(name="stick", start_s=0.0, stop_s=0.3, object_acceleration=(1.0, 2.0, 0.0)),
        Phase(name="slide", start_s=0.3, stop_s=0.5, object_acceleration=None),
    ),
    object_velocity_at_slide=(1.0, 2.0, 0.0),
    slide=Slide(start_s=0.3, switch_s=0.4, stop_s=0.5, relative_acceleration=(2.0, 4.0, 0.0)),
    margins=(LimitCheck(name="stick_load", value=0.5, bound=1.0, unit="1", time_s=0.3, satisfied=True),),
    limits=(),
    reference_file="reference.mcap",
)
TRIAL = TrialDocument(
    plan=RUN,
    lab="simulated",
    seed=1,
    outcome="held",
    started_ns=0,
    finished_ns=1_600_000_000,
    frames=FrameCounts(taken=576, hand_missing=10, object_missing=12, longest_gap_s=0.005),
    tracking_error=TrackingError(position_rms_m=1e-3, position_peak_m=2e-3, angle_rms_rad=1e-3, angle_peak_rad=2e-3),
    recording_file="trial.mcap",
)
TRUTH = TruthDocument(
    friction=0.4256,
    normal_force_per_finger_n=0.625,
    kappa_m_s2=23.1,
    rho_m=0.01,
    initial_relative_pose=POSE,
    final_relative_pose=POSE,
    slide_start_s=None,
    slide_stop_s=None,
    outcome="lost",
)
ESTIMATE = EstimateDocument(
    trial=RUN,
    clock=ClockFit(offset_s=12.3, rate_ppm=20.0, residual_std_s=1e-5),
    joints=JointClock(offset_s=0.0003, offset_std_s=2e-5, gravity_angle_rad=0.0012, gravity_angle_std_rad=0.0005),
    frames_used=560,
    outliers=3,
    smoothing=Smoothing(hand_nis=(1.0, 0.9, 1.1), object_nis=(1.0, 1.0, 1.0), relative_nis=(1.2, 1.0, 0.8)),
    initial_relative_pose=REACHED,
    final_relative_pose=REACHED,
    lost=None,
    slide=SlideFound(start_s=0.3, stop_s=0.5),
    friction=FrictionEstimate(
        kappa_m_s2=Measured(value=23.1, std=0.1, interval_95=(22.9, 23.3)),
        mu=Derived(value=0.425, interval_95=(0.42, 0.43)),
        rho_m=Measured(value=0.01, std=0.0001, interval_95=(0.0098, 0.0102)),
        assumed=Assumed(normal_force_n=1.25, mass_kg=0.023, rho_m=0.01),
        mu_budget=Budget(
            kappa_relative_std=0.004,
            normal_force_relative_std=0.05,
            mass_relative_std=0.01,
            mu_relative_std=0.0511,
        ),
        fit=Fit(
            chi_square=1.01,
            outlier_share=0.0,
            frames=90,
            start_s=0.24,
            stop_s=0.56,
            sticking_agrees=True,
            kappa_change_per_growth_s_m=-0.24,
            kappa_change_per_gravity_rad=-0.2,
        ),
    ),
    friction_missing_because=None,
    not_told=("growth",),
    notes=("two gaps",),
    series_file="smoothed.mcap",
)
CAMPAIGN = CampaignDocument(
    experiment="paper_linear",
    rows=(
        CampaignRow(
            trial=1,
            runs=CampaignRuns(plan=RUN, execute=RUN, estimate=None),
            outcome="lost",
            planned_relative_pose=POSE,
            reached_relative_pose=REACHED,
            true_relative_pose=POSE,
            error_m=1e-3,
            error_rad=1e-2,
            true_error_m=None,
            true_error_rad=None,
            believed_friction=0.38,
            estimated_friction=0.42,
            estimated_friction_interval_95=(0.41, 0.43),
            true_friction=0.4256,
        ),
    ),
    converged=False,
    outcome="lost",
    stopped_because="the block was lost",
    what_to_do="put it back",
    pictures=("fig10.png", "fig11.png"),
)


@pytest.mark.parametrize("document", [PLAN, TRIAL, TRUTH, ESTIMATE, CAMPAIGN], ids=lambda one: one.SCHEMA)
def test_documents_come_back_equal(document):
    text = dump_model(document)
    assert text.startswith(f"schema: {document.SCHEMA}/{document.VERSION}\n")
    assert parse(type(document), loads(text, "a.yaml")) == document


def test_a_missing_friction_has_a_reason():
    text = dump_model(ESTIMATE).replace("friction_missing_because: null", "friction_missing_because: nothing slid")
    with pytest.raises(
        InputError, match=r"friction: must have either a value or, in friction_missing_because, a reason"
    ):
        parse(EstimateDocument, loads(text, "a.yaml"))


def test_a_run_id_is_a_run_id():
    text = dump_model(TRIAL).replace(RUN, "latest")
    with pytest.raises(InputError, match=r"^a.yaml:2:1: plan: must be a run id .*, got 'latest'$"):
        parse(TrialDocument, loads(text, "a.yaml"))


def test_poses_as_vectors():
    assert POSE.vector == REACHED.vector == (0.01, 0.02, 3.1)
    assert REACHED.std == (1e-5, 1e-5, 1e-4)


@pytest.mark.parametrize(
    ("converged", "because", "outcome", "expected"),
    [
        ("true", "null", "held", "converged"),
        ("false", "null", "held", "out of trials"),
        ("false", "gone", "lost", "lost"),
        ("false", "joint 2 torque", "held", "no plan"),
    ],
)
def test_a_campaign_of_version_1_tells_its_outcome(converged, because, outcome, expected):
    text = (
        dump_model(CAMPAIGN).replace("campaign/2", "campaign/1").replace("converged: false", f"converged: {converged}")
    )
    text = text.replace("stopped_because: the block was lost", f"stopped_because: {because}")
    text = text.replace("  outcome: lost\n", f"  outcome: {outcome}\n", 1)
    text = text.replace("\noutcome: lost\n", "\n").replace("what_to_do: put it back\n", "")
    document = parse(CampaignDocument, loads(text, "a.yaml"))
    assert (document.outcome, document.what_to_do) == (expected, None)


def test_an_estimate_of_version_1_is_read():
    """The file is as the first release wrote it."""
    told = parse(EstimateDocument, load(Path(__file__).parent / "estimate-1.yaml"))
    assert (told.joints, told.outliers, told.smoothing, told.not_told) == (None, None, None, ())
    assert told.friction.kappa_m_s2.value == pytest.approx(20.6, abs=0.5)
    assert (told.friction.rho_m, told.friction.mu_budget, told.friction.fit) == (None, None, None)
    assert parse(EstimateDocument, loads(dump_model(told), "again.yaml")) == told
