"""The zones that a drawing may state, by feature: what each holds, and the components that are drawn [mm].

A plane has the offset of its centre along the outward normal and its rises from there to the edges at +a/2 along x and
at +b/2 along y (at the radius, of a round one); an axis has the lateral displacements of its two ends, a cone its shift
along the axis too; a point has three coordinates. `Zone.matrix` embeds what is drawn in these: all of them, or the few
that the zone limits.
"""

import math

import numpy as np

from tol3d.assembly.model import Cone
from tol3d.assembly.zones.balls import Flat, Line, Sphere
from tol3d.assembly.zones.cross_section import CrossSection, Diamond, Disc
from tol3d.assembly.zones.ends import Ends, FlatEnds
from tol3d.assembly.zones.face import Face
from tol3d.assembly.zones.mixed import EndsAlong, FlatEndsAlong, FlatEndsRound
from tol3d.assembly.zones.motions import Motions
from tol3d.assembly.zones.round_surfaces import BallSurface, RoundSurface
from tol3d.assembly.zones.zone import Shape, Zone
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

LEAST_SINE = 1e-9  # of the angle of two directions; nearer ones are one
PLANE = ("offset", "rise x", "rise y")
AXIS = ("start x", "start y", "end x", "end y")
POINT = ("x", "y", "z")
THREE = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
FOUR = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def rectangle(width: float, orientation: float | None = None, outward: float | None = None, form: float = 0.0) -> Zone:
    """Zone of a rectangular plane: |offset| + |rise x| + |rise y| <= t/2, |rise x| + |rise y| <= t_o/2."""
    return Zone(Shape(Face(Diamond()), PLANE, THREE), width, orientation, outward, form)


def round_face(width: float, orientation: float | None = None, outward: float | None = None, form: float = 0.0) -> Zone:
    """Zone of a round plane: |offset| + hypot(rise x, rise y) <= t/2, hypot(rise x, rise y) <= t_o/2."""
    return Zone(Shape(Face(Disc()), PLANE, THREE), width, orientation, outward, form)


def rectangle_orientation(width: float) -> Zone:
    """Orientation zone of a rectangular plane, without location: |rise x| + |rise y| <= t/2."""
    return _rises(Diamond(), width)


def round_face_orientation(width: float) -> Zone:
    """Orientation zone of a round plane, without location: hypot(rise x, rise y) <= t/2; axial run-out too."""
    return _rises(Disc(), width)


def axis(width: float, orientation: float | None = None, form: float = 0.0) -> Zone:
    """Zone of an axis in a cylinder of diameter t: both ends in discs of t/2, half their difference within t_o/2."""
    return Zone(Shape(Ends(), AXIS, FOUR, (0.5, 0.0, 0.5, 0.0)), width, orientation, form=form)


def axis_orientation(width: float) -> Zone:
    """Orientation zone of an axis in a cylinder of diameter t, without location: ends opposite, in discs of t/2."""
    opposite = ((-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0))
    return Zone(Shape(Flat(Disc()), ("end x", "end y"), opposite), width)


def axis_section(width: float, form: float = 0.0, slant: float = 1.0) -> Zone:
    """Zone of an axis at one section, in a disc of diameter t: both ends equal; circular run-out.

    Args:
        width: t.
        form: taken from it.
        slant: displacement of the axis over what is read: 1 / cos of the half angle of a cone.
    """
    equal = ((slant, 0.0), (0.0, slant), (slant, 0.0), (0.0, slant))
    return Zone(Shape(Flat(Disc()), ("x", "y"), equal), width, form=form)


def flat_axis(width: float, along: tuple[float, float], orientation: float | None = None, form: float = 0.0) -> Zone:
    """Zone of an axis between planes t apart whose normal is `along` (x, y): both ends within ±t/2 along it."""
    x, y = _unit(along)
    ends = ((x, 0.0), (y, 0.0), (0.0, x), (0.0, y))
    return Zone(Shape(FlatEnds(), ("start", "end"), ends, (0.5, 0.5)), width, orientation, form=form)


def flat_axis_orientation(width: float, along: tuple[float, float]) -> Zone:
    """Orientation zone of an axis between planes t apart whose normal is `along` (x, y), without location."""
    x, y = _unit(along)
    return Zone(Shape(Line(), ("end",), ((-x,), (-y,), (x,), (y,))), width)


def axis_along(width: float, along: tuple[float, float], orientation: float, form: float = 0.0) -> Zone:
    """Zone of an axis in a cylinder of diameter t, its orientation between planes t_o apart whose normal is `along`."""
    x, y = _unit(along)
    turn = ((x, -y, 0.0, 0.0), (y, x, 0.0, 0.0), (0.0, 0.0, x, -y), (0.0, 0.0, y, x))
    names = ("start along", "start across", "end along", "end across")
    return Zone(Shape(EndsAlong(), names, turn, (0.5, 0.0, 0.5, 0.0)), width, orientation, form=form)


def flat_axis_round(width: float, along: tuple[float, float], orientation: float, form: float = 0.0) -> Zone:
    """Zone of an axis between planes t apart whose normal is `along`, its orientation in a cylinder of diameter t_o."""
    x, y = _unit(along)
    ends = ((x, 0.0, y), (y, 0.0, -x), (0.0, x, -y), (0.0, y, x))
    shape = Shape(FlatEndsRound(), ("start", "end", "across"), ends, (0.5, 0.5, 0.0))
    return Zone(shape, width, orientation, form=form)


def flat_axis_along(
    width: float, along: tuple[float, float], turned: tuple[float, float], orientation: float, form: float = 0.0
) -> Zone:
    """Zone of an axis between planes t apart whose normal is `along`, its orientation between others along `turned`."""
    (x, y), other = _unit(along), _unit(turned)
    sine, cosine = x * other[1] - y * other[0], x * other[0] + y * other[1]
    if abs(sine) < LEAST_SINE:
        raise InputError("zone: expected two directions apart, got one twice")
    across = np.array([[y], [-x], [-y], [x]]) @ np.array([[0.5 * cosine, -0.5 * cosine, 1.0]]) / sine
    ends = np.array([[x, 0.0, 0.0], [y, 0.0, 0.0], [0.0, x, 0.0], [0.0, y, 0.0]]) + across
    shape = Shape(FlatEndsAlong(), ("start", "end", "turned"), tuple(map(tuple, ends.tolist())), (0.5, 0.5, 0.0))
    return Zone(shape, width, orientation, form=form)


def point_in_sphere(width: float) -> Zone:
    """Zone of a point in a sphere of diameter t."""
    return Zone(Shape(Sphere(), POINT, THREE), width)


def point_in_disc(width: float) -> Zone:
    """Zone of a point in a disc of diameter t in its x-y plane."""
    return Zone(Shape(Flat(Disc()), ("x", "y"), ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0))), width)


def point_between_planes(
    width: float, along: tuple[float, float, float] = (0.0, 0.0, 1.0), outward: float | None = None
) -> Zone:
    """Zone of a point between planes t apart whose normal is `along`; for a point of a surface, its profile."""
    return Zone(Shape(Line(), ("along",), tuple((own,) for own in _unit(along))), width, outward=outward)


def pattern_motion(width: float, shifts: int, turns: int) -> Zone:
    """Motion of a pattern as a whole: |shift| + |turn| <= t/2, a turn as the way of the feature that it moves most.

    Args:
        width: t.
        shifts: directions in which it may shift, 1 to 3.
        turns: directions about which it may turn, 0 to 3.
    """
    count = shifts + turns
    names = [f"shift {own}" for own in "xyz"[:shifts]]
    names += ["turn"] if turns == 1 else [f"turn {own}" for own in "xyz"[:turns]]
    unit = tuple(tuple(row) for row in np.eye(count).tolist())
    return Zone(Shape(Motions(shifts, turns), tuple(names), unit), width)


def cylinder_surface(width: float, outward: float | None = None, form: float = 0.0) -> Zone:
    """Zone of a cylinder's surface: |outward| + the farther end of its axis <= t/2, outward by the radius."""
    axis = tuple((0.0, *row) for row in FOUR)
    return Zone(Shape(RoundSurface(), ("outward", *AXIS), axis, (0.0, 0.5, 0.0, 0.5, 0.0)), width, None, outward, form)


def cone_surface(width: float, cone: Cone, outward: float | None = None, form: float = 0.0) -> Zone:
    """Zone of a cone's surface: |outward| + the farther of its ends <= t/2, all as displacements square to the surface.

    Its axis, its lean and its place along the axis follow from these.
    """
    embedding = np.zeros((5, 5))
    embedding[:4, 1:] = ends_by_surface(cone)
    embedding[4, 0] = (1.0 if cone.inner else -1.0) / math.sin(cone.angle)
    middle = (embedding[0] + embedding[2]) / 2
    shape = Shape(RoundSurface(), ("outward", *AXIS), _rows(embedding), tuple(middle.tolist()))
    return Zone(shape, width, None, outward, form)


def cone_run_out(width: float, cone: Cone, form: float = 0.0) -> Zone:
    """Zone of a cone's total run-out, read square to its surface: at both ends in discs of t/2."""
    ends = ends_by_surface(cone)
    return Zone(Shape(Ends(), AXIS, _rows(ends), tuple(((ends[0] + ends[2]) / 2).tolist())), width, form=form)


def ends_by_surface(cone: Cone) -> Array:
    """(4, 4): displacements of a cone's surface at both its ends, square to it, x and y -> those of its axis' ends."""
    return np.kron(np.linalg.inv(cone.surface_by_axis), np.eye(2))


def _rows(matrix: Array) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(row) for row in matrix.tolist())


def sphere_surface(width: float, outward: float | None = None, form: float = 0.0) -> Zone:
    """Zone of a ball's surface: |outward| + the offset of its centre <= t/2, outward by the radius."""
    centre = tuple((0.0, *row) for row in THREE)
    return Zone(Shape(BallSurface(), ("outward", *POINT), centre, (0.0, 1.0, 0.0, 0.0)), width, None, outward, form)


def _rises(section: CrossSection, width: float) -> Zone:
    return Zone(Shape(Flat(section), PLANE[1:], ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))), width)


def _unit(direction: tuple[float, ...]) -> tuple[float, ...]:
    size = math.hypot(*direction)
    if not 0.0 < size < math.inf:
        raise InputError(f"zone: expected a direction other than 0, got {direction}")
    return tuple(own / size for own in direction)
