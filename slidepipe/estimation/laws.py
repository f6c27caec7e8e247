"""Which laws of friction and of gravity an estimate assumes, and how surely."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError


@dataclass(frozen=True, slots=True)
class Laws:
    """Standard deviations of what a fit takes for known; zero holds it, a large one leaves it to the motion.

    Attributes
    ----------
    rho_relative_sd : float
        Of torsion constant times contact radius, over its value.
    growth_sd_s_m : float
        Of the growth of friction with sliding speed about none: friction is ``kappa (1 + growth * speed)``, s/m.
    gravity_angle_rad : float
        Angle by which gravity is turned in the plane of motion, counter-clockwise.
    gravity_angle_sd_rad : float
        Its standard deviation.
    """

    rho_relative_sd: float = 0.2
    growth_sd_s_m: float = 0.0
    gravity_angle_rad: float = 0.0
    gravity_angle_sd_rad: float = 0.0

    def __post_init__(self) -> None:
        for name in ("rho_relative_sd", "growth_sd_s_m", "gravity_angle_sd_rad"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"laws: {name} must be a number that is not negative, got {value!r}")
        if not np.isfinite(self.gravity_angle_rad):
            raise InputError(f"laws: gravity_angle_rad must be a finite angle, got {self.gravity_angle_rad!r}")
