"""What an estimate is asked from."""

from dataclasses import dataclass, field

import numpy as np

from slidepipe.errors import InputError
from slidepipe.estimation.laws import Laws
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.series import FloatArray, MocapSeries, PoseSeries


@dataclass(frozen=True, slots=True)
class EstimationRequest:
    """One trial as recorded, and what must be assumed of it. All stamps are on the host's clock.

    Attributes
    ----------
    mocap : MocapSeries
        Hand {f} and object {b} in the base frame, and the clock exchanges.
    plane : MotionPlane
        {w} in the base frame.
    block : Block
        The object; only its mass and its size are used.
    normal_force_n : float
        Normal force of all fingers together, N; assumed, motion does not tell it.
    rho_m : float
        Torsion constant times contact radius, m; assumed to within ``laws.rho_relative_sd``.
    believed_kappa : float
        mu f_N / m that the planner believed, m/s^2; compared with the estimate, never averaged into it.
    relative_angle_rad : float
        Angle of {f} in {b} that was planned for the start; only its turn counts: the first angle is reported within
        pi of it.
    slide_start_ns, slide_stop_ns : int
        Where the plan slides; a guide only.
    motion_start_ns, motion_stop_ns : int
        The hand rests outside these.
    joint_hand : PoseSeries or None
        {f} in the base frame by the measured joints, on the host's clock; it tells the offset between both clocks.
    start_relative_pose : (3,) or None
        r_f_b that was planned for the start; an object that is far from it is another body.
    hand_place_sd : (3,) or None
        Standard deviations of where {f} is on the hand, along its x and y, m, and in angle, rad; None is exact.
    laws : Laws
        Which laws of friction and gravity the fit assumes, and how surely.
    """

    mocap: MocapSeries
    plane: MotionPlane
    block: Block
    normal_force_n: float
    rho_m: float
    believed_kappa: float
    relative_angle_rad: float
    slide_start_ns: int
    slide_stop_ns: int
    motion_start_ns: int
    motion_stop_ns: int
    joint_hand: PoseSeries | None = None
    start_relative_pose: FloatArray | None = None
    hand_place_sd: FloatArray | None = None
    laws: Laws = field(default_factory=Laws)

    def __post_init__(self) -> None:
        for name in ("normal_force_n", "rho_m", "believed_kappa"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"estimation: {name} must be a positive number, got {value!r}")
        if not np.isfinite(self.relative_angle_rad):
            raise InputError(f"estimation: relative_angle_rad must be a finite angle, got {self.relative_angle_rad!r}")
        if self.motion_stop_ns <= self.motion_start_ns:
            raise InputError(
                "estimation: the motion must stop after it starts, "
                f"got motion_start_ns {self.motion_start_ns} and motion_stop_ns {self.motion_stop_ns}"
            )
