"""The part of the experiment file that says which laws of friction an estimate leaves open."""

from typing import Literal

from slidepipe.artifacts.schema import Record
from slidepipe.artifacts.values import NotNegative


class EstimationSetup(Record):
    """Without it, friction is the planner's: it does not grow with speed, sticks as it slides, and is an ellipsoid.

    ``growth_std_s_m`` is how much friction may grow with the sliding speed, one standard deviation: it is estimated
    where this is above 0. ``sticking: apart`` estimates mu_s beside mu_k. ``surface: pressure`` takes the exact limit
    surface of a round patch, and estimates the exponent of its pressure.
    """

    growth_std_s_m: NotNegative = 0.0
    sticking: Literal["as_sliding", "apart"] = "as_sliding"
    surface: Literal["ellipsoid", "pressure"] = "ellipsoid"
