"""The grasp limit surface of eq. (16): support function, support points and mesh, against sums of single wrenches."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mechanics_draws import ANGLES

from slidepipe.errors import InputError
from slidepipe.mechanics.grasp import Contact, Grasp
from slidepipe.mechanics.grasp_surface import GraspSurface, SurfaceMesh, icosphere
from slidepipe.mechanics.limit_surface import LimitSurface, PointContact, SoftFinger
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.pressure_patch import PressurePatch

POINT, SOFT, PATCH = PointContact(0.5, 2.0), SoftFinger(0.4, 1.5, 0.02, 0.6), PressurePatch(0.3, 3.0, 0.01, 2.0)
MIXED = GraspSurface([POINT, SOFT, PATCH], np.array([[0.03, 0.0], [-0.02, 0.01], [0.0, -0.04]]))
TWISTS = (
    arrays(float, 3, elements=st.floats(-1, 1)).filter(lambda n: np.linalg.norm(n) > 0.05).map(lambda n: n * [1, 1, 30])
)
few = settings(deadline=None, max_examples=40)


def matrix_g(r: np.ndarray) -> np.ndarray:
    """G_i of eq. (15), as printed."""
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-r[1], r[0], 1.0]])


def volume(mesh: SurfaceMesh) -> float:
    return float(np.sum(np.linalg.det(mesh.vertices[mesh.faces])) / 6.0)


@few
@given(TWISTS, st.integers(0, 2**32 - 1))
def test_every_sum_of_contact_wrenches_is_inside(dv: np.ndarray, seed: int) -> None:
    """The words of eq. (16): sum of k_i G_i f_i with f_i on LS_i and 0 <= k_i <= 1."""
    rng = np.random.default_rng(seed)
    total = np.zeros((50, 3))
    for contact, r in zip(MIXED.contacts, MIXED.positions, strict=True):
        f = contact.friction(rng.normal(size=(50, 3)) * [1.0, 1.0, 50.0])
        total += rng.uniform(size=(50, 1)) * f @ matrix_g(r).T
    assert np.all(total @ dv <= float(MIXED.support(dv)) * (1 + 1e-12))


@few
@given(TWISTS)
def test_the_point_with_a_normal_reaches_the_support(dv: np.ndarray) -> None:
    w = MIXED.friction(dv)
    assert w @ dv == pytest.approx(float(MIXED.support(dv)), rel=1e-9)
    parts = [matrix_g(r) @ c.friction(matrix_g(r).T @ dv) for c, r in zip(MIXED.contacts, MIXED.positions, strict=True)]
    np.testing.assert_allclose(w, np.sum(parts, axis=0), rtol=1e-9, atol=1e-12)


@few
@given(st.sampled_from([POINT, SOFT, PATCH]), st.integers(1, 6), TWISTS, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_equal_fingers_at_one_place_are_one_that_presses_as_hard(
    finger: LimitSurface, n: int, dv: np.ndarray, x: float, y: float
) -> None:
    one = type(finger)(
        finger.mu, n * finger.f_N, *(getattr(finger, s) for s in finger.__slots__ if s not in {"mu", "f_N"})
    )
    many = GraspSurface([finger] * n, [[x, y]] * n)
    single = GraspSurface([one], [[x, y]])
    np.testing.assert_allclose(many.friction(dv), single.friction(dv), rtol=1e-12, atol=1e-14)
    assert float(many.support(dv)) == pytest.approx(float(single.support(dv)), rel=1e-12)
    if not isinstance(finger, PointContact):
        np.testing.assert_allclose(volume(many.mesh(1)), volume(single.mesh(1)), rtol=1e-9)


@few
@given(TWISTS, ANGLES)
def test_a_turned_grasp_has_a_turned_surface(dv: np.ndarray, angle: float) -> None:
    turn = rotation(angle)
    turned = GraspSurface(MIXED.contacts, MIXED.positions @ turn.T)
    np.testing.assert_allclose(turned.friction(turn @ dv), turn @ MIXED.friction(dv), atol=1e-9)


@few
@given(TWISTS)
def test_soft_fingers_agree_with_the_grasp_of_ellipsoids(dv: np.ndarray) -> None:
    r = np.array([[0.03, 0.0, 1.0], [-0.02, 0.01, 2.0]])
    surface = GraspSurface([SOFT, SOFT], r)
    assert float(surface.support(dv)) == pytest.approx(float(Grasp([Contact(SOFT, one) for one in r]).support(dv)))


def test_two_point_contacts_turned_about_their_middle() -> None:
    pinch = GraspSurface([POINT, POINT], [[0.03, 0.0], [-0.03, 0.0]])
    np.testing.assert_allclose(pinch.friction(np.array([0.0, 0.0, 1.0])), [0.0, 0.0, 2 * 0.03], atol=1e-15)
    np.testing.assert_allclose(pinch.friction(np.array([1.0, 0.0, 0.0])), [2.0, 0.0, 0.0], atol=1e-15)
    assert pinch.moment_arm == pytest.approx(0.03)


def test_a_flat_piece_is_answered_by_its_centre() -> None:
    """Turning about the first of two point contacts: any force of it within the circle has the same power."""
    pair = GraspSurface([POINT, POINT], [[0.0, 0.0], [0.5, 0.0]])
    dv = np.array([0.0, 0.0, 1.0])
    centre = pair.friction(dv)
    np.testing.assert_array_equal(centre, [0.0, 1.0, 0.5])
    rim = centre + POINT.friction(np.array([[1.0, 2.0, 0.0], [-3.0, 1.0, 0.0]]))
    np.testing.assert_allclose(rim @ dv, float(pair.support(dv)), rtol=1e-15)


def test_the_mesh_is_a_closed_sphere_that_faces_outward() -> None:
    for level in range(4):
        points, faces = icosphere(level)
        assert (len(points), len(faces)) == (10 * 4**level + 2, 20 * 4**level)
        sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        there, back = {tuple(s) for s in sides.tolist()}, {tuple(s[::-1]) for s in sides.tolist()}
        assert there == back
        assert len(there) == len(sides)
        assert np.all(np.linalg.det(points[faces]) > 0.0)
        np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-14)


@pytest.mark.parametrize("grasp", [MIXED, GraspSurface([PATCH], [[0.05, 0.02]])], ids=["mixed", "patch"])
def test_no_vertex_of_the_mesh_is_beyond_the_tangent_plane_of_another(grasp: GraspSurface) -> None:
    mesh = grasp.mesh(2)
    support = grasp.support(mesh.normals)
    np.testing.assert_allclose(np.sum(mesh.vertices * mesh.normals, axis=1), support, rtol=1e-9)
    assert np.all(mesh.normals @ mesh.vertices.T <= support[:, None] * (1 + 1e-9))


def test_the_mesh_of_one_soft_finger_fills_its_ellipsoid() -> None:
    """Wherever it sits: G has determinant one. A polyhedron's volume is short by the square of its edges."""
    true = 4.0 / 3.0 * np.pi * np.prod(SOFT.semi_axes)
    for place in ([0.0, 0.0], [0.004, -0.003]):
        missing = np.array([1.0 - volume(GraspSurface([SOFT], [place]).mesh(level)) / true for level in (3, 4)])
        assert np.all((missing > 0.0) & (missing < [0.02, 0.005]))
        assert missing[0] / missing[1] == pytest.approx(4.0, rel=0.1)


def test_the_mesh_of_two_points_fills_the_sum_of_two_discs() -> None:
    """Discs of radius F in planes m = +-d f_y: at f_y the slice has width and height of two chords, shifted by d."""
    d, F = 0.05, POINT.mu * POINT.f_N
    made = volume(GraspSurface([POINT, POINT], [[d, 0.0], [-d, 0.0]]).mesh(6))
    y = (np.arange(4000) + 0.5) / 4000 * 2 * F - F
    chord = 2.0 * np.sqrt(F * F - y * y)
    cell = (2 * F / 4000) ** 2 * 2.0 * d  # (f_y1, f_y2) to (f_y, m): determinant 2 d; f_x spans both chords
    assert made == pytest.approx(cell * 2.0 * 4000 * chord.sum(), rel=3e-3)


@pytest.mark.parametrize(
    ("contacts", "positions", "message"),
    [
        ([], np.zeros((0, 2)), "contacts must be one or more, got none"),
        ([SOFT], np.zeros((2, 2)), r"positions must be \(1, 2\) or \(\.\., 3\), got shape \(2, 2\)"),
        ([SOFT], np.array([[np.nan, 0.0]]), "positions must be finite numbers"),
    ],
)
def test_what_a_grasp_is_made_of(contacts: list[LimitSurface], positions: np.ndarray, message: str) -> None:
    with pytest.raises(InputError, match=f"^grasp surface: {message}"):
        GraspSurface(contacts, positions)


def test_a_mesh_is_refined_so_and_so_often() -> None:
    with pytest.raises(InputError, match=r"^grasp surface: level must be an integer from 0 to 8, got 9$"):
        MIXED.mesh(9)
