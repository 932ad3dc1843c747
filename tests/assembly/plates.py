"""Features as texts, and two plates of which one lies on the other, pins in holes."""

from collections.abc import Mapping, Sequence

Place = tuple[float, float, float]


def plane(at: Place, normal: Sequence[float], extent: tuple[float, float] = (200, 200)) -> str:
    """A face [mm]."""
    return f"{{kind: plane, at: {_mm(at)}, normal: {[*normal]}, extent: {_mm(extent)}}}"


def pin(at: Place, diameter: float, length: float = 10) -> str:
    """An upright cylinder about its middle [mm]."""
    return f"{{kind: cylinder, at: {_mm(at)}, axis: [0, 0, 1], length: {length} mm, diameter: {diameter} mm}}"


def hole(at: Place, diameter: float, length: float = 10) -> str:
    """An upright hole about its middle [mm]."""
    return f"{pin(at, diameter, length)[:-1]}, hole: true}}"


def two_plates(
    lower: Mapping[str, str],
    upper: Mapping[str, str],
    pairs: Sequence[tuple[str, str]],
    tolerances: str,
    measures: str,
    *,
    names: tuple[str, str] = ("base", "plate"),
    move: str = "on",
    kind: str = "pattern",
    floating: str = "{kind: random}",
    middle: Place = (0, 0, 0),
) -> str:
    """A scene: the lower plate stands still, the upper one lies on it, faces `top` and `bottom` without deviations.

    Args:
        lower, upper: features of the plates besides these.
        pairs: a feature of the upper plate and one of the lower one, of which one is a pin and one a hole.
        tolerances, measures: lines of the scene.
        names: of both plates.
        move, kind: name and kind of the move that lays the upper plate.
        floating: where it lies within its play.
        middle: of both faces [mm].
    """
    base, plate = names
    faces = ({"top": plane(middle, (0, 0, 1))}, {"bottom": plane(middle, (0, 0, -1))})
    parts = "".join(
        f"  {name}:\n    kind: solid\n    features:\n{_lines(face | dict(own))}"
        for name, face, own in zip(names, faces, (lower, upper), strict=True)
    )
    listed = ", ".join(f"{{from: {plate}.{own}, to: {base}.{other}}}" for own, other in pairs)
    return f"""scene: two plates
parts:
{parts}tolerances:
{tolerances}
moves:
  table: {{kind: fix, part: {base}}}
  {move}:
    kind: {kind}
    part: {plate}
    relations: [{{kind: coincident, from: {plate}.bottom, to: {base}.top}}]
    pairs: [{listed}]
    float: {floating}
measures:
{measures}
"""


def _mm(lengths: Sequence[float]) -> str:
    return "[" + ", ".join(f"{own} mm" for own in lengths) + "]"


def _lines(features: Mapping[str, str]) -> str:
    return "".join(f"      {name}: {own}\n" for name, own in features.items())
