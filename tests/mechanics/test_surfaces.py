"""What every limit surface must be: convex, the same in every frame, its own dual; and the point contact's corners."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mechanics_draws import ANGLES, FINGERS, SLIDES

from slidepipe.errors import InputError
from slidepipe.mechanics.limit_surface import GrowingFinger, LimitSurface, PointContact, SoftFinger
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.pressure_patch import PressurePatch

POINTS = st.builds(PointContact, mu=st.floats(0.05, 2.0), f_N=st.floats(0.1, 50.0))
PATCHES = st.builds(
    PressurePatch,
    mu=st.floats(0.05, 2.0),
    f_N=st.floats(0.1, 50.0),
    a=st.floats(0.001, 0.1),
    k=st.floats(1.0, 12.0) | st.just(np.inf),
)
SMOOTH = FINGERS | PATCHES
SURFACES = SMOOTH | POINTS
STEEP = arrays(float, 3, elements=st.floats(-1, 1)).filter(lambda dv: min(np.hypot(dv[0], dv[1]), abs(dv[2])) > 0.05)
EXAMPLES: list[LimitSurface] = [
    PointContact(0.5, 2.0),
    SoftFinger(0.5, 2.0, 0.02, 0.6),
    PressurePatch(0.5, 2.0, 0.02, 2.0),
]
few = settings(deadline=None, max_examples=40)


def reach(surface: LimitSurface) -> np.ndarray:
    """Largest force and moment: what wrenches are measured by."""
    return np.array([float(surface.support(axis)) for axis in np.eye(3)]) + 1e-300


def across(surface: LimitSurface, twist: np.ndarray) -> np.ndarray:
    """A twist that slides and turns by comparable amounts on this patch."""
    return twist / [1.0, 1.0, getattr(surface, "a", 1.0)]


@few
@given(SURFACES, SLIDES)
def test_friction_is_on_the_surface_and_has_the_supports_power(surface: LimitSurface, dv: np.ndarray) -> None:
    f = surface.friction(dv)
    assert f @ dv == pytest.approx(float(surface.support(dv)), rel=1e-9)
    if np.any(f[:2]) or f[2]:
        assert float(surface.load(f)) == pytest.approx(1.0, rel=1e-9)


@few
@given(SURFACES, STEEP, arrays(float, (30, 3), elements=st.floats(-1, 1)))
def test_no_wrench_inside_dissipates_more(surface: LimitSurface, twist: np.ndarray, inside: np.ndarray) -> None:
    dv = across(surface, twist)
    wrenches = inside * reach(surface) * [1.0, 1.0, not isinstance(surface, PointContact)]
    wrenches /= np.maximum(1.0, surface.load(wrenches))[:, None]
    assert np.all(wrenches @ dv <= surface.friction(dv) @ dv * (1 + 1e-9))


@few
@given(SURFACES, STEEP, STEEP)
def test_a_wrench_and_a_twist_are_dual(surface: LimitSurface, share: np.ndarray, twist: np.ndarray) -> None:
    """load(f) is the largest f.dv / support(dv), and the twist that reaches it is direction(f)."""
    f = share * reach(surface) * [1.0, 1.0, not isinstance(surface, PointContact)]
    best, other = surface.direction(f), across(surface, twist)
    assert float(surface.load(f)) == pytest.approx(f @ best / float(surface.support(best)), rel=1e-9)
    assert f @ other <= surface.load(f) * surface.support(other) * (1 + 1e-9)
    scale = reach(surface)
    np.testing.assert_allclose(surface.friction(best) / scale, f / surface.load(f) / scale, atol=1e-9)


@few
@given(SMOOTH, SLIDES)
def test_the_direction_of_a_twists_wrench_is_the_twist(surface: LimitSurface, dv: np.ndarray) -> None:
    f = surface.friction(dv)
    np.testing.assert_allclose(surface.direction(3.0 * f), dv / np.linalg.norm(dv), atol=1e-6)


@few
@given(SMOOTH, STEEP)
def test_the_surface_is_normal_to_the_twist(surface: LimitSurface, twist: np.ndarray) -> None:
    """Finite differences: the support's gradient is the wrench, the load's gradient is along the twist."""
    dv = across(surface, twist)
    steps, f = 1e-5 * np.diag(np.abs(across(surface, np.ones(3)))), surface.friction(dv)
    slope = (surface.support(dv + steps) - surface.support(dv - steps)) / (2 * np.diag(steps))
    np.testing.assert_allclose(slope / reach(surface), f / reach(surface), atol=1e-6)
    steps = 1e-5 * np.diag(reach(surface))
    normal = (surface.load(f + steps) - surface.load(f - steps)) / (2 * np.diag(steps))
    np.testing.assert_allclose(normal * reach(surface), dv / surface.support(dv) * reach(surface), atol=1e-6)


@few
@given(SURFACES, SLIDES, ANGLES)
def test_every_frame_about_the_normal_is_as_good(surface: LimitSurface, dv: np.ndarray, angle: float) -> None:
    turn, flip, f = rotation(angle), np.array([1.0, -1.0, -1.0]), surface.friction(dv)
    np.testing.assert_allclose(surface.friction(turn @ dv) / reach(surface), turn @ f / reach(surface), atol=1e-9)
    np.testing.assert_allclose(surface.friction(flip * dv), flip * f, rtol=1e-12)
    assert float(surface.support(turn @ dv)) == pytest.approx(float(surface.support(dv)), rel=1e-9)
    if f[2] == 0.0 or not isinstance(surface, PointContact):
        assert float(surface.load(turn @ f)) == pytest.approx(float(surface.load(f)), rel=1e-9)


@few
@given(PATCHES, STEEP, st.integers(0, 2**32 - 1))
def test_any_field_of_friction_on_the_patch_is_inside(patch: PressurePatch, twist: np.ndarray, seed: int) -> None:
    """Forces of random directions within Coulomb's bound at points of the patch, which bear equal shares."""
    rng = np.random.default_rng(seed)
    edge = np.linspace(0.0, 1.0, 4001)
    p = np.ones(4001) if np.isinf(patch.k) else (1.0 - edge**patch.k) ** (1.0 / patch.k)
    borne = np.cumsum(edge * p)
    r = np.interp((np.arange(3000) + 0.5) / 3000, borne / borne[-1], edge)
    phi, way = rng.uniform(0, 2 * np.pi, 3000), rng.normal() + rng.normal() * rng.uniform(0, 2 * np.pi, 3000)
    force = patch.mu * patch.f_N / 3000 * np.stack([np.cos(way), np.sin(way)])
    f = np.array([*force.sum(axis=1), patch.a * np.sum(r * (np.cos(phi) * force[1] - np.sin(phi) * force[0]))])
    assert float(patch.load(f)) <= 1.002
    dv = across(patch, twist)
    assert f @ dv <= 1.002 * float(patch.support(dv))


@pytest.mark.parametrize("surface", EXAMPLES, ids=lambda one: type(one).__name__)
def test_nothing_slides_nothing_is_used(surface: LimitSurface) -> None:
    assert float(surface.support(np.zeros(3))) == 0.0
    assert float(surface.load(np.zeros(3))) == 0.0
    with pytest.raises(InputError, match="the friction of a contact that does not slide is not given by eq"):
        surface.friction(np.zeros((2, 3)))
    with pytest.raises(InputError, match="a wrench of zero has no direction in which the contact slides"):
        surface.direction(np.zeros(3))


@pytest.mark.parametrize("surface", EXAMPLES, ids=lambda one: type(one).__name__)
def test_wrenches_and_twists_are_finite_triples(surface: LimitSurface) -> None:
    with pytest.raises(InputError, match=r"f must be finite numbers, got nan$"):
        surface.direction(np.array([1.0, np.nan, 0.0]))
    with pytest.raises(InputError, match=r"dv must have shape \(\.\.\., 3\), got \(2,\)$"):
        surface.support(np.zeros(2))


def test_a_point_contact_has_no_moment() -> None:
    finger = PointContact(mu=0.5, f_N=2.0)
    assert finger.load(np.array([[0.0, 0.0, 1e-300], [0.0, 1.5, 0.0]])).tolist() == [np.inf, 1.5]
    with pytest.raises(InputError, match="a wrench with a moment cannot be scaled to the surface"):
        finger.direction(np.array([1.0, 0.0, 0.1]))
    np.testing.assert_array_equal(finger.friction(np.array([0.0, 0.0, 2.0])), np.zeros(3))
    with pytest.raises(InputError, match=r"^point contact: mu must be a positive number, got -1.0$"):
        PointContact(-1.0, 2.0)


@given(POINTS, SLIDES)
def test_a_point_contact_is_a_soft_finger_without_a_patch(finger: PointContact, dv: np.ndarray) -> None:
    narrow = SoftFinger(finger.mu, finger.f_N, 1e-12, 0.6)
    np.testing.assert_array_equal(finger.semi_axes[:2], narrow.semi_axes[:2])
    if np.hypot(dv[0], dv[1]) > 1e-3:
        np.testing.assert_allclose(finger.friction(dv), narrow.friction(dv), atol=1e-9 * finger.f_N)


@given(st.floats(0.1, 50.0), st.floats(0.001, 0.1), st.floats(0.0, 1.0))
def test_a_patch_that_grows_with_the_force(f_N: float, delta: float, gamma: float) -> None:
    finger = SoftFinger.growing(mu=0.4, f_N=f_N, delta=delta, gamma=gamma, c=0.6)
    assert finger.a == pytest.approx(delta * f_N**gamma, rel=1e-12)
    np.testing.assert_array_equal(finger.semi_axes, SoftFinger(0.4, f_N, finger.a, 0.6).semi_axes)
    pressed = replace(finger, f_N=8.0 * f_N)
    assert isinstance(pressed, GrowingFinger)
    assert pressed.semi_axes[2] == pytest.approx(finger.semi_axes[2] * 8.0 ** (1.0 + gamma), rel=1e-12)


@pytest.mark.parametrize(
    ("name", "value"), [("mu", 0.0), ("f_N", -1.0), ("delta", np.nan), ("gamma", -0.1), ("c", 0.0)]
)
def test_what_a_growing_finger_is_made_of(name: str, value: float) -> None:
    numbers = {"mu": 0.4, "f_N": 1.0, "delta": 0.01, "gamma": 0.3, "c": 0.6} | {name: value}
    with pytest.raises(InputError, match=rf"^soft finger: {name} must be a .*number.*, got {value!r}$"):
        SoftFinger.growing(**numbers)
