"""Numbers of the 7-DOF Barrett WAM with wrist, from the vendor's open library, and those that had to be chosen.

Kinematics are Denavit-Hartenberg, distal: ``Rz(theta) Tz(d) Tx(a) Rx(alpha)``; the base frame sits at the shoulder and
the tool points straight up at zero. Centres of mass and inertias are in each link's own frame.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

JOINT_COUNT = 7


@dataclass(frozen=True, slots=True)
class Link:
    """One link of the arm and the joint that moves it.

    Attributes
    ----------
    alpha_rad, a_m, d_m : float
        Denavit-Hartenberg parameters.
    range_rad : pair of float
        Joint limits.
    mass_kg : float
    com_m : three floats
        Centre of mass in the link's frame.
    inertia_kg_m2 : six floats
        xx, yy, zz, xy, xz, yz about the centre of mass, axes of the link's frame.
    """

    alpha_rad: float
    a_m: float
    d_m: float
    range_rad: tuple[float, float]
    mass_kg: float
    com_m: tuple[float, float, float]
    inertia_kg_m2: tuple[float, float, float, float, float, float]


LINKS: tuple[Link, ...] = (
    Link(-pi / 2, 0.0, 0.0, (-2.6, 2.6), 10.7677, (-4.43e-3, 121.89e-3, -0.66e-3),
         (134880.33e-6, 113283.69e-6, 90463.30e-6, -2130.41e-6, -124.85e-6, 685.55e-6)),
    Link(pi / 2, 0.0, 0.0, (-2.0, 2.0), 3.8749, (-2.37e-3, 31.06e-3, 15.42e-3),
         (21409.58e-6, 13778.75e-6, 15589.06e-6, 271.72e-6, 24.61e-6, -1819.20e-6)),
    Link(-pi / 2, 0.045, 0.55, (-2.8, 2.8), 1.8023, (-38.26e-3, 207.51e-3, 0.03e-3),
         (59110.77e-6, 3245.50e-6, 59270.43e-6, -2496.12e-6, 7.38e-6, -17.67e-6)),
    Link(pi / 2, -0.045, 0.0, (-0.9, 3.1), 2.17266, (5.53408e-3, 0.06822e-3, 119.27695e-3),
         (0.01067491, 0.01058659, 0.00282036, 0.00004503, -0.00135557, -0.00011002)),
    Link(-pi / 2, 0.0, 0.30, (-4.76, 1.24), 0.35656, (0.05483e-3, 28.86286e-3, 1.48493e-3),
         (0.00037112, 0.00019434, 0.00038209, -0.00000008, -0.00000003, -0.00001613)),
    Link(pi / 2, 0.0, 0.0, (-1.6, 1.6), 0.40916, (-0.05923e-3, -16.86123e-3, 24.19052e-3),
         (0.00054889, 0.00023846, 0.00045133, 0.00000019, -0.00000010, -0.00004430)),
    Link(0.0, 0.0, 0.0609, (-3.0, 3.0), 0.07548, (0.14836e-3, 0.07252e-3, -3.35185e-3),
         (0.00003911, 0.00003877, 0.00007614, 0.00000019, 0.0, 0.0)),
)  # fmt: skip
MIDDLE_RAD = np.array([sum(link.range_rad) / 2.0 for link in LINKS])
"""Middle of each joint's range."""

KP = (900.0, 2500.0, 600.0, 500.0, 50.0, 50.0, 8.0)
"""Vendor's joint position control: proportional gains, N m/rad."""
KI = (2.5, 5.0, 2.0, 0.5, 0.5, 0.5, 0.1)
"""Integral gains, N m/(rad s)."""
KD = (10.0, 20.0, 5.0, 2.0, 0.5, 0.5, 0.05)
"""Derivative gains, N m s/rad."""
CONTROL_LIMIT = (25.0, 20.0, 15.0, 15.0, 5.0, 5.0, 5.0)
"""What the vendor's joint position control may add to gravity compensation, N m."""
VELOCITY_FILTER_RAD_S = 180.0
"""Corner of the vendor's low-pass on joint velocity."""
PEAK_TORQUE = (77.3, 160.6, 95.6, 29.4, 11.6, 11.6, 2.7)
"""Published peak torques, N m."""

ROTOR_INERTIA = (0.14, 0.065, 0.065, 0.027, 0.006, 0.006, 0.0008)
"""Chosen, not published: rotor inertia seen at the joint, kg m^2 (some 8e-5 times the gear ratio squared)."""
COULOMB_FRICTION = (0.8, 1.2, 0.6, 0.5, 0.1, 0.1, 0.03)
"""Chosen, not published: dry friction at the joint, N m."""
VISCOUS_FRICTION = (0.6, 0.6, 0.3, 0.2, 0.02, 0.02, 0.005)
"""Chosen, not published: viscous friction at the joint, N m s/rad."""

GRIPPER_MASS_KG = 0.105
"""The paper's spring-powered gripper with the object in it."""
