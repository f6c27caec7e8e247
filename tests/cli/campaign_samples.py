"""What repeats, sweeps and explains, with numbers that a test can look for."""

from cli import samples
from slidepipe.artifacts.arm_correction import ArmCorrectionDocument
from slidepipe.artifacts.repeat import Repeatability, RepeatDocument, Repetition
from slidepipe.artifacts.sweep import Spread, SweepDocument, SweepSetting
from slidepipe.artifacts.values import Pose
from slidepipe.artifacts.why import ErrorOf, ExpectedError, FrictionView, WhyDocument


def repeat() -> RepeatDocument:
    error = Pose(x_m=-0.00123, y_m=0.004, theta_rad=0.0123)
    held = Repetition(
        repetition=1, execute=samples.TRIAL, estimate=samples.ESTIMATE, outcome="held", error=error, true_error=None
    )
    lost = held.model_copy(update={"repetition": 2, "outcome": "lost", "error": None})
    return RepeatDocument(
        experiment="regrasp",
        plan=samples.PLAN,
        rows=(held, lost),
        lost=1,
        estimated=Repeatability(trials=1, mean=(-0.00123, 0.004, 0.0123), std=None),
        true=None,
    )


def sweep() -> SweepDocument:
    spread = Spread(worlds=19, mean=(-0.001, 0.002, 0.003), std=(0.01, 0.02, 0.03))
    setting = SweepSetting(
        overrides=("motion.slide_s=0.14",),
        worlds=20,
        lost_share=0.05,
        converged_share=0.9,
        first_trial=spread,
        last_trial=None,
    )
    return SweepDocument(
        experiment="regrasp",
        world="lab",
        sets=("lab.friction=0.36..0.44", "motion.slide_s=[0.14]"),
        seed=3,
        worlds=20,
        reused=5,
        workers="2 processes",
        seconds=12.34,
        settings=(setting,),
        numbers_sha256="ab" * 32,
        table_file="worlds.csv",
    )


def why(*, lost: bool = False) -> WhyDocument:
    before = ErrorOf(pose=Pose(x_m=-0.003, y_m=0.004, theta_rad=-0.012), position_m=0.005, angle_rad=0.012)
    return WhyDocument(
        experiment="regrasp",
        trial=2,
        previous_estimate=samples.ESTIMATE,
        way="learned",
        error_before=None if lost else before,
        friction_before=FrictionView(value=0.38, interval_95=None, source="the last plan"),
        friction_after=FrictionView(value=0.42, interval_95=(0.4, 0.44), source="1 trial"),
        expected_after=ExpectedError(
            position_m=0.0004,
            position_interval_95_m=(0.0001, 0.0015),
            angle_rad=0.003,
            angle_interval_95_rad=(0.0002, 0.01),
            lost_share=0.0,
            within_tolerance_share=0.75,
            model_miss_share=0.021,
            draws=400,
        ),
        changed=("friction 0.3800 -> 0.4200: 1 trial", "slide of 140 ms -> 92 ms"),
    )


def arm() -> ArmCorrectionDocument:
    five, one = (0.05,) * 7, (0.01,) * 7
    names = ("moving_mass", "resting_mass", "coulomb", "viscous")
    shares = dict.fromkeys(names, five) | {f"{name}_std": one for name in names}
    return ArmCorrectionDocument(
        experiment="regrasp", trials=(samples.TRIAL,), torque_rms_n_m=(1.0,) * 7, left_rms_n_m=(0.1,) * 7, **shares
    )
