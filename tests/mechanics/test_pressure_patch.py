"""The exact patch against closed forms, published constants and integrals over the patch in other coordinates."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad, quad, solve_ivp
from scipy.optimize import brentq

from slidepipe.errors import InputError
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.pressure_patch import PressurePatch, curve, torsion_constant

KS = [1.0, 2.0, 4.0, np.inf]
TABLE = {
    1.0: [(0.3573, 0.4563), (0.6416, 0.3517), (0.9155, 0.1622), (0.9808, 0.0762)],
    2.0: [(0.2899, 0.5531), (0.5522, 0.4556), (0.8836, 0.2209), (0.9743, 0.1019)],
    4.0: [(0.2627, 0.6027), (0.5094, 0.5107), (0.8641, 0.2560), (0.9705, 0.1168)],
    np.inf: [(0.2480, 0.6358), (0.4838, 0.5477), (0.8488, 0.2829), (0.9677, 0.1278)],
}
UNIFORM = PressurePatch(mu=0.5, f_N=2.0, a=0.02, k=np.inf)


def pressure(k: float, r: float) -> float:
    return 1.0 if np.isinf(k) else max(0.0, 1.0 - r**k) ** (1.0 / k)


def around_the_cor(k: float, eps: float) -> tuple[float, float]:
    """Force and moment of the unit patch in polar coordinates around the COR: friction is the same along a ray."""
    whole = quad(lambda r: 2.0 * np.pi * r * pressure(k, r), 0.0, 1.0, epsabs=1e-12)[0]

    def chord(angle: float, side: float) -> float:
        return max(0.0, eps * np.cos(angle) + side * np.sqrt(max(0.0, 1.0 - (eps * np.sin(angle)) ** 2)))

    def part(what: int) -> float:
        def integrand(rho: float, angle: float) -> float:
            r = np.sqrt(max(0.0, rho * rho - 2.0 * rho * eps * np.cos(angle) + eps * eps))
            return pressure(k, r) * rho * (np.cos(angle) if what == 0 else rho - eps * np.cos(angle))

        top = np.pi if eps < 1.0 else np.arcsin(1.0 / eps)
        near, far = (0.0 if eps < 1.0 else lambda x: chord(x, -1.0)), lambda x: chord(x, 1.0)
        return 2.0 * dblquad(integrand, 0.0, top, near, far, epsabs=1e-9, epsrel=1e-9)[0] / whole

    return part(0), part(1)


@pytest.mark.parametrize(
    ("k", "c"), [(1.0, 0.5), (2.0, 3 * np.pi / 16), (3.0, 0.620245), (4.0, 0.635410), (np.inf, 2 / 3)]
)
def test_the_torsion_constant(k: float, c: float) -> None:
    assert torsion_constant(k) == pytest.approx(c, abs=5e-7)
    assert float(curve(0.0, 1.0, k)[1]) == pytest.approx(torsion_constant(k), rel=1e-9)


def test_the_torsion_constant_grows_into_that_of_uniform_pressure() -> None:
    assert np.all(np.diff([torsion_constant(k) for k in np.geomspace(1.0, 1e3, 50)]) > 0.0)
    assert torsion_constant(1e6) == pytest.approx(2 / 3, abs=1e-9)


def test_the_papers_constant_belongs_to_nearly_hertzian_pressure() -> None:
    assert brentq(lambda k: torsion_constant(k) - 0.6, 1.0, 10.0) == pytest.approx(2.2645, abs=5e-5)


@pytest.mark.parametrize("k", KS)
def test_the_table_of_force_and_moment(k: float) -> None:
    F, T = curve(np.array([0.25, 0.5, 1.0, 2.0]), 1.0, k)
    np.testing.assert_allclose(np.column_stack([F, T]), TABLE[k], atol=5.1e-5)


@pytest.mark.parametrize("k", KS)
@pytest.mark.parametrize("eps", [0.01, 0.6, 1.0, 1.01, 30.0])
def test_the_integral_over_the_patch_around_the_cor(k: float, eps: float) -> None:
    np.testing.assert_allclose(np.ravel(curve(eps, 1.0, k)), around_the_cor(k, eps), rtol=1e-6)


@pytest.mark.parametrize("k", KS)
def test_a_sum_over_many_points_of_the_patch(k: float) -> None:
    t, phi = (np.arange(2000) + 0.5) / 2000, (np.arange(720) + 0.5) * np.pi / 720
    r = 1.0 - (1.0 - t) ** 4  # finer towards the rim, where the pressure is steep
    share = r * (1.0 - t) ** 3 * np.array([pressure(k, one) for one in r])
    share /= share.sum()
    x, y = r[:, None] * np.cos(phi), r[:, None] * np.sin(phi)
    speed = np.hypot(y, 0.7 + x)
    F, T = (share @ np.mean(part / speed, axis=1) for part in (0.7 + x, y * y + x * (0.7 + x)))
    np.testing.assert_allclose(np.ravel(curve(0.7, 1.0, k)), [F, T], rtol=2e-6)


@pytest.mark.parametrize("k", [1.0, 1.5, 2.0, 3.0, 8.0, 50.0, 1e3, 1e6, np.inf])
def test_a_finer_rule_changes_nothing(k: float, monkeypatch: pytest.MonkeyPatch) -> None:
    from slidepipe.mechanics import pressure_patch as module  # noqa: PLC0415

    near = np.geomspace(1e-15, 0.1, 40)
    eps = np.concatenate([[1.0], np.geomspace(1e-300, 1e-9, 20), np.geomspace(1e-9, 1e9, 200), 1.0 + near, 1.0 - near])
    coarse = curve(eps, 1.0, k)
    monkeypatch.setattr(module, "_STEP", module._STEP / 4)
    monkeypatch.setattr(module, "_REACH", 3.5)
    monkeypatch.setattr(module, "_RULE", module._double_exponential())
    np.testing.assert_allclose(coarse, curve(eps, 1.0, k), rtol=1e-9)


@pytest.mark.parametrize("k", KS)
def test_the_slopes_far_away_and_near_the_centre(k: float) -> None:
    share = quad(lambda r: 2 * r * pressure(k, r), 0, 1, epsabs=1e-12)[0]
    mean_square = quad(lambda r: 2 * r**3 * pressure(k, r), 0, 1, epsabs=1e-12)[0] / share
    mean_inverse = quad(lambda r: 2 * pressure(k, r), 0, 1, epsabs=1e-12)[0] / share
    F, T = curve(np.array([1e7, 1e-7]), 1.0, k)
    assert T[0] * 1e7 == pytest.approx(mean_square / 2, rel=1e-8)
    assert F[1] * 1e7 == pytest.approx(mean_inverse / 2, rel=3e-6)


def test_the_ends_are_exact() -> None:
    assert UNIFORM.friction(np.array([3.0, 4.0, 0.0])).tolist() == pytest.approx([0.6, 0.8, 0.0], rel=1e-14)
    assert UNIFORM.friction(np.array([3.0, 4.0, 0.0]))[2] == 0.0
    np.testing.assert_allclose(UNIFORM.friction(np.array([0.0, 0.0, -5.0])), [0, 0, -0.04 / 3], rtol=1e-9, atol=0.0)
    np.testing.assert_array_equal(UNIFORM.direction(np.array([0.0, 0.0, -1.0])), [0.0, 0.0, -1.0])
    np.testing.assert_array_equal(UNIFORM.direction(np.array([0.0, 2.0, 0.0])), [0.0, 1.0, 0.0])


@settings(deadline=None, max_examples=50)
@given(st.floats(-12.0, 12.0), st.floats(-140.0, 140.0), st.sampled_from(KS))
def test_only_the_ratio_of_sliding_and_turning_matters(eps: float, size: float, k: float) -> None:
    dv = np.array([10.0**eps, 0.0, 1.0])
    patch = PressurePatch(1.0, 1.0, 1.0, k)
    np.testing.assert_allclose(patch.friction(10.0**size * dv), patch.friction(dv), rtol=1e-9, atol=1e-300)


def test_many_twists_at_once_are_each_for_itself() -> None:
    slides = np.random.default_rng(0).normal(size=(50, 60, 3)) * [1.0, 1.0, 50.0]
    f = UNIFORM.friction(slides)
    for answer, given_ in ((f, slides), (UNIFORM.support(slides), slides)):
        one = UNIFORM.friction if answer is f else UNIFORM.support
        np.testing.assert_allclose(answer[49, 7], one(given_[49, 7]), rtol=1e-13)
    np.testing.assert_allclose(UNIFORM.load(f[:5])[3, 7], UNIFORM.load(f[3, 7]), rtol=1e-13)
    assert UNIFORM.friction(np.empty((0, 3))).shape == (0, 3)


@pytest.mark.parametrize(("k", "radius", "force"), [(1.0, 0.0539, 4 / 3), (2.0, 0.0638, 1.441), (np.inf, 0.0704, 1.5)])
def test_how_far_the_ellipsoid_lies_outside(k: float, radius: float, force: float) -> None:
    patch, q = PressurePatch(1.0, 1.0, 1.0, k), np.linspace(0.0, 1.0, 4001)
    dv = np.column_stack([1.0 - q, 0.0 * q, q])
    exact, rough = patch.friction(dv), patch.ellipsoid().friction(dv)
    excess = 1.0 / patch.ellipsoid().load(exact) - 1.0
    assert excess.min() > -1e-9
    assert excess.max() == pytest.approx(radius, abs=1e-4)
    assert np.max(rough[1:-1, 0] / exact[1:-1, 0]) == pytest.approx(force, rel=1e-3)


@pytest.mark.parametrize("start", [0.6, 1.0])
def test_a_free_uniform_disc_stops_sliding_and_spinning_together(start: float) -> None:
    """Unit disc under unit friction acceleration: v' = -F, w' / 2 = -T; v / (w R) tends to 0.653."""

    def rates(_: float, state: np.ndarray) -> list[float]:
        F, T = curve(*np.maximum(state, 0.0), np.inf)
        return [-float(F), -2.0 * float(T)]

    def nearly_at_rest(_: float, state: np.ndarray) -> float:
        return float(max(state)) - 1e-5

    nearly_at_rest.terminal = True  # type: ignore[attr-defined]
    motion = solve_ivp(rates, (0, 10), [start, 1.0], method="LSODA", events=nearly_at_rest, rtol=1e-8, atol=1e-11)
    assert motion.status == 1
    assert motion.y[0, -1] / motion.y[1, -1] == pytest.approx(0.653, abs=1e-3)


@pytest.mark.parametrize("start", [0.02, 0.6, 20.0])
def test_every_free_uniform_disc_ends_at_the_same_ratio(start: float) -> None:
    """The ratio over the logarithm of w, since it is approached slowly: from 0 as w^(-1/4), from afar much faster."""

    def rate(_: float, eps: np.ndarray) -> np.ndarray:
        F, T = curve(eps, 1.0, np.inf)
        return (2.0 * eps * T - F) / (2.0 * T)

    ratio = solve_ivp(rate, (0.0, 60.0), [start], method="LSODA", rtol=1e-8, atol=1e-10).y[0]
    assert ratio[-1] == pytest.approx(0.653, abs=5e-4)
    assert np.all(np.diff(ratio) * np.sign(0.653 - start) > -1e-6)
    assert float(rate(0.0, np.array([1e-6]))[0]) == pytest.approx(0.25e-6, rel=1e-4)


@pytest.mark.parametrize(("name", "value"), [("mu", 0.0), ("f_N", -1.0), ("a", np.nan), ("k", 0.5), ("k", np.nan)])
def test_what_a_patch_is_made_of(name: str, value: float) -> None:
    numbers = {"mu": 0.38, "f_N": 1.25, "a": 0.0174, "k": 2.0} | {name: value}
    with pytest.raises(InputError, match=rf"^pressure patch: {name} must be a (positive )?number.*, got {value!r}$"):
        PressurePatch(**numbers)


def test_the_ellipsoid_has_the_same_largest_force_and_moment() -> None:
    patch = PressurePatch(mu=0.5, f_N=2.0, a=0.02, k=2.0)
    assert patch.ellipsoid() == SoftFinger(0.5, 2.0, 0.02, torsion_constant(2.0))
    np.testing.assert_array_equal(patch.semi_axes, patch.ellipsoid().semi_axes)
