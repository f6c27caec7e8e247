"""Friction that a block held by the hand took, as a share of what it slides with: mu_s / mu_k at the onset."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from slidepipe.errors import InputError
from slidepipe.estimation.joint_fit import JointFit
from slidepipe.estimation.stage_kernel import PHYSICS, START
from slidepipe.mechanics.dynamics import Block, about_com
from slidepipe.mechanics.limit_surface import LimitSurface, SoftFinger
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.pressure_patch import PressurePatch, torsion_constant
from slidepipe.mechanics.slip import stuck_acceleration
from slidepipe.series import FloatArray, IntArray

STEP = 1e-6
"""Of the differences, in standard deviations of the parameters."""


@dataclass(frozen=True, slots=True)
class StickingShare:
    """Logarithm of the share, and its standard deviation from the fit."""

    log: float
    log_sd: float


def sticking_share(fit: JointFit, block: Block, inverse_exponent: float | None) -> StickingShare:
    """What sticking took as the block was let go.

    Parameters
    ----------
    fit : JointFit
        Of a block that was held until ``fit.held_s``.
    inverse_exponent : float or None
        1/k of the pressure; None for the ellipsoid.

    Raises
    ------
    InputError
        The block was not held.
    """
    if fit.held_s is None:
        raise InputError("sticking_share: the fit did not hold the block")
    share = _Share(fit, block, inverse_exponent)
    used = share.rows()
    sizes = STEP * np.sqrt(np.diagonal(fit.covariance)[used])
    slope = np.array([share.slope(row, size) for row, size in zip(used, sizes, strict=True)])
    variance = float(slope @ fit.covariance[np.ix_(used, used)] @ slope)
    return StickingShare(share.log(fit.z), float(np.sqrt(variance)))


@dataclass(frozen=True, slots=True)
class _Share:
    fit: JointFit
    block: Block
    inverse_exponent: float | None

    def rows(self) -> IntArray:
        """Parameters that the share hangs on: the hand at the onset, the grip, kappa and rho."""
        count, law = self._count(), len(self.fit.z) - PHYSICS
        near = int((self._held() - self.fit.first_knot_s) / self.fit.knot_s) + np.arange(4)
        hand = [axis * count + near for axis in range(3)]
        return np.concatenate([*hand, 3 * count + np.arange(3), [law, law + 1]])

    def slope(self, row: int, size: float) -> float:
        ahead, behind = self.fit.z.copy(), self.fit.z.copy()
        ahead[row] += size
        behind[row] -= size
        return (self.log(ahead) - self.log(behind)) / (2.0 * size)

    def log(self, z: FloatArray) -> float:
        """Logarithm of the friction that sticking takes over the friction that slides."""
        count, law = self._count(), z[-PHYSICS:]
        knots = self.fit.first_knot_s + self.fit.knot_s * (np.arange(count + 4) - 3)
        hand = BSpline(knots, z[: 3 * count].reshape(3, count).T, 3)
        pose, velocity, acceleration = (hand(self._held(), order) for order in range(3))
        grip = z[3 * count : 3 * count + 3]
        theta = float(pose[2] - grip[2])
        moved = stuck_acceleration(theta, float(velocity[2]), acceleration, grip)
        wrench = rotation(theta).T @ (self.block.M * moved - self.block.g)
        surface = self._surface(float(np.exp(law[0]) * self.block.m), float(np.exp(law[1])))
        return float(np.log(surface.load(about_com(wrench, -grip))))

    def _surface(self, force: float, rho: float) -> LimitSurface:
        if self.inverse_exponent is None:
            return SoftFinger(mu=1.0, f_N=force, a=rho, c=1.0)
        k = np.inf if self.inverse_exponent <= 0.0 else 1.0 / self.inverse_exponent
        return PressurePatch(mu=1.0, f_N=force, a=rho / torsion_constant(k), k=k)

    def _held(self) -> float:
        return float(self.fit.held_s or 0.0)

    def _count(self) -> int:
        return (len(self.fit.z) - START - PHYSICS) // 3
