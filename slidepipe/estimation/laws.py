"""Which laws of friction and of gravity an estimate assumes, and how surely."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from slidepipe.errors import InputError

Sticking = Literal["as_sliding", "apart"]
Surface = Literal["ellipsoid", "pressure"]


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
    sticking : "as_sliding" or "apart"
        Whether a contact sticks with the friction that it slides with, or with more, which is told apart.
    surface : "ellipsoid" or "pressure"
        The limit surface: the paper's ellipsoid, or that of a round patch whose pressure exponent is estimated.
    """

    rho_relative_sd: float = 0.2
    growth_sd_s_m: float = 0.0
    gravity_angle_rad: float = 0.0
    gravity_angle_sd_rad: float = 0.0
    sticking: Sticking = "as_sliding"
    surface: Surface = "ellipsoid"

    def __post_init__(self) -> None:
        for name in ("rho_relative_sd", "growth_sd_s_m", "gravity_angle_sd_rad"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"laws: {name} must be a number that is not negative, got {value!r}")
        for name, allowed in (("sticking", get_args(Sticking)), ("surface", get_args(Surface))):
            if getattr(self, name) not in allowed:
                raise InputError(f"laws: {name} must be one of {', '.join(allowed)}, got {getattr(self, name)!r}")
        if not np.isfinite(self.gravity_angle_rad):
            raise InputError(f"laws: gravity_angle_rad must be a finite angle, got {self.gravity_angle_rad!r}")
