"""Bounded numbers and small records that several documents share."""

from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

from slidepipe.artifacts.schema import Record
from slidepipe.artifacts.shapes import RUN_ID, SLUG

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Share = Annotated[float, Field(ge=0.0, lt=1.0)]
Count = Annotated[int, Field(ge=0)]
Stamp = Annotated[int, Field(ge=0, lt=2**63)]
"""Nanoseconds on the host's clock."""
Friction = Annotated[float, Field(ge=0.01, le=5.0)]
"""Coefficient of friction: what lies outside is a slip of the pen."""
Slug = Annotated[str, Field(pattern=SLUG)]
"""A name that can stand in a path."""
RunId = Annotated[str, Field(pattern=RUN_ID)]
Interval = tuple[float, float]
"""Lower and upper end."""
Planar = tuple[float, float, float]
"""Along x and y in m, m/s or m/s^2, and about the normal in rad, rad/s or rad/s^2."""


class Pose(Record):
    """Pose in the plane."""

    x_m: float
    y_m: float
    theta_rad: float

    @property
    def vector(self) -> Planar:
        """``(x, y, theta)`` in m and rad."""
        return self.x_m, self.y_m, self.theta_rad

    @classmethod
    def of(cls, vector: Iterable[float]) -> "Pose":
        """Pose from any three numbers.

        Examples
        --------
        >>> Pose.of([0.1, 0.2, 3]).theta_rad
        3.0
        """
        x, y, theta = (float(value) for value in vector)
        return cls(x_m=x, y_m=y, theta_rad=theta)


class UncertainPose(Record):
    """Pose in the plane with one standard deviation of each coordinate."""

    x_m: float
    y_m: float
    theta_rad: float
    x_std_m: NotNegative
    y_std_m: NotNegative
    theta_std_rad: NotNegative

    @property
    def vector(self) -> Planar:
        """``(x, y, theta)`` in m and rad."""
        return self.x_m, self.y_m, self.theta_rad

    @property
    def std(self) -> Planar:
        """One standard deviation of x, y and theta in m and rad."""
        return self.x_std_m, self.y_std_m, self.theta_std_rad
