"""What ``estimate.yaml`` says, from what the estimator found."""

import numpy as np

from slidepipe.artifacts import estimate as records
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.values import UncertainPose
from slidepipe.estimation.friction import FrictionEstimate
from slidepipe.estimation.hand_clock import JointClock
from slidepipe.estimation.profile import Told
from slidepipe.estimation.rest import RestPose
from slidepipe.series import FloatArray
from slidepipe.stages.recorded_estimate import RecordedEstimate

Z95 = 1.959964
SMOOTHED_FILE = "smoothed.mcap"


def estimate_document(found: RecordedEstimate, trial: str, calibration: str | None) -> EstimateDocument:
    """Document of an estimate of the run ``trial``, with the calibration run that placed cameras and markers."""
    told = found.estimate
    placed = (
        f"cameras and markers are where calibration {calibration} found them; how well it tells the finger's place on "
        "the hand is in the intervals of friction, and in no pose's deviation"
    )
    slide = None
    if told.slide is not None:
        start_s, stop_s = (_since_start(found, time_s) for time_s in (told.slide.start_s, told.slide.stop_s))
        slide = records.SlideFound(start_s=start_s, stop_s=stop_s)
    return EstimateDocument(
        trial=trial,
        clock=records.ClockFit(
            offset_s=told.clock.offset_s, rate_ppm=told.clock.drift_ppm, residual_std_s=1e-9 * told.clock.residual_ns
        ),
        joints=_joints(told.joints),
        frames_used=int(np.sum(told.tracks.relative.valid)),
        outliers=told.tracks.spikes,
        smoothing=records.Smoothing(
            hand_nis=_triple(told.hand.consistency),
            object_nis=_triple(told.object.consistency),
            relative_nis=_triple(told.relative.consistency),
        ),
        initial_relative_pose=_uncertain(told.initial),
        final_relative_pose=_uncertain(told.final),
        lost=told.lost,
        slide=slide,
        friction=_friction(found),
        friction_missing_because=told.friction_reason,
        not_told=told.not_told,
        notes=told.notes if calibration is None else (*told.notes, placed),
        series_file=SMOOTHED_FILE,
    )


def _since_start(found: RecordedEstimate, time_s: float) -> float:
    return 1e-9 * (found.estimate.host_ns(time_s) - found.start_ns)


def _uncertain(rest: RestPose | None) -> UncertainPose | None:
    if rest is None:
        return None
    x, y, theta = (float(value) for value in rest.pose)
    x_std, y_std, theta_std = (float(value) for value in rest.sd)
    return UncertainPose(x_m=x, y_m=y, theta_rad=theta, x_std_m=x_std, y_std_m=y_std, theta_std_rad=theta_std)


def _joints(found: JointClock | None) -> records.JointClock | None:
    if found is None:
        return None
    return records.JointClock(
        offset_s=found.offset_s,
        offset_std_s=found.sd_s,
        gravity_angle_rad=found.tilt_rad,
        gravity_angle_std_rad=found.tilt_sd_rad,
    )


def _triple(values: FloatArray) -> tuple[float, float, float]:
    x, y, theta = (float(value) for value in values)
    return x, y, theta


def _friction(found: RecordedEstimate) -> records.FrictionEstimate | None:
    told, experiment = found.estimate.friction, found.experiment
    if told is None:
        return None
    interval = told.kappa_interval_m_s2
    force, mass = records.NORMAL_FORCE_RELATIVE_STD, records.MASS_RELATIVE_STD
    return records.FrictionEstimate(
        kappa_m_s2=_measured(told.kappa_m_s2, told.kappa_relative_sd, (interval.low, interval.high)),
        rho_m=_rho(told),
        mu=records.Derived(value=told.mu, interval_95=(told.mu_interval.low, told.mu_interval.high)),
        assumed=records.Assumed(
            normal_force_n=experiment.grasp.normal_force_n,
            mass_kg=experiment.object.mass_kg,
            rho_m=experiment.grasp.rho_m,
        ),
        mu_budget=records.Budget(
            kappa_relative_std=told.kappa_relative_sd,
            normal_force_relative_std=force,
            mass_relative_std=mass,
            mu_relative_std=float(np.sqrt(told.kappa_relative_sd**2 + force**2 + mass**2)),
        ),
        fit=records.Fit(
            chi_square=told.chi_square,
            outlier_share=told.outlier_share,
            frames=told.frames,
            start_s=_since_start(found, told.window_start_s),
            stop_s=_since_start(found, told.window_stop_s),
            sticking_agrees=told.sticks_alike,
            kappa_change_per_growth_s_m=told.per_growth,
            kappa_change_per_gravity_rad=told.per_gravity,
        ),
        growth_s_m=_told(told.growth),
        static_share=_told(told.static_share),
        inverse_exponent=_told(told.inverse_exponent),
    )


def _measured(value: float, relative_std: float, interval: tuple[float, float]) -> records.Measured:
    return records.Measured(value=value, std=value * relative_std, interval_95=interval)


def _rho(told: FrictionEstimate) -> records.Measured | None:
    """Rho where the slide turned enough to tell it."""
    if not told.rho_told:
        return None
    spread = np.exp(Z95 * told.rho_relative_sd)
    return _measured(told.rho_m, told.rho_relative_sd, (float(told.rho_m / spread), float(told.rho_m * spread)))


def _told(found: Told | None) -> records.Measured | None:
    if found is None or not found.told:
        return None
    return records.Measured(value=found.value, std=found.sd, interval_95=(found.low, found.high))
