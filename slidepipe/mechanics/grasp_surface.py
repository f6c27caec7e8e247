"""The grasp limit surface, eq. (16), of any mixture of contacts that move as one.

The set that it bounds is the Minkowski sum of the contacts' sets, each mapped by G_i of eq. (15). Sums of convex sets
add their support functions and their support points, so that nothing has to be sampled and hulled.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import about_com
from slidepipe.mechanics.grasp import carried
from slidepipe.mechanics.limit_surface import LimitSurface, moving, triples
from slidepipe.series import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class SurfaceMesh:
    """A closed triangle mesh whose vertices lie on a limit surface; the set's inside is behind every face.

    Attributes
    ----------
    vertices : (V, 3)
        Wrenches, N and N m.
    normals : (V, 3)
        Twist whose support point each vertex is: an outward normal of the surface there. Not of unit length.
    faces : (F, 3) int
        Vertices of each triangle, counter-clockwise from outside.
    """

    vertices: FloatArray
    normals: FloatArray
    faces: IntArray


@dataclass(frozen=True, slots=True)
class GraspSurface:
    """The grasp limit surface in {b} of fingers that move as one.

    Attributes
    ----------
    contacts : sequence of LimitSurface
        Such as SoftFinger, PressurePatch, PointContact; isotropic, so that the fingers' angles do not matter.
    positions : (n, 2) or (n, 3)
        Where they touch, r_fi in {b}, m; a third column, their angles, is left unread.

    Notes
    -----
    A point contact at ``r_i`` makes two flat pieces, discs of radius ``mu f_N`` in the tilted plane of the wrenches
    ``G_i f``: all their points have the normal of the twist about ``r_i``. There :meth:`friction` returns the disc's
    centre if the velocity at the contact comes out as exactly zero, and a point of its rim if rounding leaves a trace
    of it; the power is the same. For every other twist the point is unique. Point contacts at one place only make the
    whole surface flat, without inside. Edges, where one point has many normals, need no care: the point is unique.

    Examples
    --------
    >>> from slidepipe.mechanics.limit_surface import PointContact
    >>> finger = PointContact(mu=0.5, f_N=2.0)
    >>> grasp = GraspSurface([finger, finger], [[0.03, 0.0], [-0.03, 0.0]])
    >>> grasp.friction(np.array([0.0, 0.0, 1.0]))
    array([0.  , 0.  , 0.06])
    """

    contacts: Sequence[LimitSurface]
    positions: FloatArray

    def __post_init__(self) -> None:
        contacts = tuple(self.contacts)
        if not contacts:
            raise InputError("grasp surface: contacts must be one or more, got none")
        r = np.array(self.positions, dtype=float)
        if r.ndim != 2 or r.shape[0] != len(contacts) or r.shape[1] not in {2, 3}:
            raise InputError(f"grasp surface: positions must be ({len(contacts)}, 2) or (.., 3), got shape {r.shape}")
        if not np.all(np.isfinite(r[:, :2])):
            raise InputError(f"grasp surface: positions must be finite numbers, got {self.positions!r}")
        r = np.column_stack([r[:, :2], np.zeros(len(contacts))])
        r.setflags(write=False)
        object.__setattr__(self, "contacts", contacts)
        object.__setattr__(self, "positions", r)

    def support(self, dv_b: FloatArray) -> FloatArray:
        """The most of ``w . dv_b`` (...) over the surface, W: ``sum_i h_i(G_i^T dv_b)``, exact.

        Parameters
        ----------
        dv_b : (..., 3)
            Velocity of the fingers relative to the object, taken at the CoM, in {b}, m/s and rad/s.
        """
        dv_b = triples("grasp surface", "dv_b", dv_b)
        return np.asarray(np.sum([one.support(carried(dv_b, r)) for one, r in self._each()], axis=0))

    def friction(self, dv_b: FloatArray) -> FloatArray:
        """Wrench (..., 3) about the CoM with the most power at ``dv_b`` (..., 3): the point with that normal."""
        dv_b = moving("grasp surface", dv_b)
        each = [about_com(one.friction(carried(dv_b, r)), r) for one, r in self._each()]
        return np.asarray(np.sum(each, axis=0))

    @property
    def moment_arm(self) -> float:
        """Largest moment about the CoM over the sum of the largest forces, m; 1 where no moment is possible."""
        force = sum(float(one.support(np.array([1.0, 0.0, 0.0]))) for one in self.contacts)
        arm = float(self.support(np.array([0.0, 0.0, 1.0]))) / force
        return arm if arm > 0.0 else 1.0

    def mesh(self, level: int = 4) -> SurfaceMesh:
        """The surface as triangles: the support points of an icosphere's normals.

        The sphere is that of twists whose turning counts by :attr:`moment_arm`. Every vertex is on the surface and the
        polyhedron inside it; flat pieces are spanned by faces between points of their rims.

        Parameters
        ----------
        level : int
            How often the icosahedron is refined, 0 to 8: ``10 * 4**level + 2`` vertices.

        Examples
        --------
        >>> from slidepipe.mechanics.limit_surface import SoftFinger
        >>> mesh = GraspSurface([SoftFinger(0.5, 2.0, 0.02, 0.6)], [[0.0, 0.0]]).mesh(2)
        >>> mesh.vertices.shape, mesh.faces.shape
        ((162, 3), (320, 3))
        """
        if not (isinstance(level, int) and 0 <= level <= 8):
            raise InputError(f"grasp surface: level must be an integer from 0 to 8, got {level!r}")
        sphere, faces = icosphere(level)
        normals = sphere / [1.0, 1.0, self.moment_arm]
        return SurfaceMesh(self.friction(normals), normals, faces)

    def _each(self) -> list[tuple[LimitSurface, FloatArray]]:
        return list(zip(self.contacts, self.positions, strict=True))


def icosphere(level: int) -> tuple[FloatArray, IntArray]:
    """Unit vectors (V, 3) and triangles (F, 3), counter-clockwise from outside: an icosahedron refined ``level`` times.

    Examples
    --------
    >>> [len(part) for part in icosphere(1)]
    [42, 80]
    """
    g = (1.0 + np.sqrt(5.0)) / 2.0
    ring = np.array([[-1.0, g, 0.0], [1.0, g, 0.0], [-1.0, -g, 0.0], [1.0, -g, 0.0]])
    points = np.concatenate([np.roll(ring, turn, axis=1) for turn in range(3)]) / np.sqrt(1.0 + g * g)
    distance = np.linalg.norm(points[:, None] - points[None], axis=-1)
    near = (distance > 0.0) & (distance < 1.1)  # an edge has 1.05, the next distance is 1.7
    corners = [
        (i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[k, i]
    ]
    faces = np.array([t if np.linalg.det(points[list(t)]) > 0.0 else t[::-1] for t in corners], dtype=np.int64)
    for _ in range(level):
        points, faces = _refined(points, faces)
    return points, faces


def _refined(points: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Every triangle cut into four at the middles of its edges, which are pushed out to the sphere."""
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, index = np.unique(sides, axis=0, return_inverse=True)
    ab, bc, ca = (index.reshape(-1) + len(points)).reshape(3, -1)
    middle = points[edges].sum(axis=1)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    a, b, c = faces.T
    quarters = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.concatenate([points, middle]), quarters
