"""A cover on a base as a scene, their features stated in the world and written in frames of any origin and turn."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
Vector = Sequence[float] | Array

HOLES = ((15.0, 20.0), (95.0, 55.0))
ALONG = np.array([80.0, 35.0, 0.0]) / np.hypot(80, 35)
ACROSS = np.array([-ALONG[1], ALONG[0], 0.0])


def listed(vector: Vector, unit: str = "") -> str:
    return "[" + ", ".join(f"{float(own)!r}{unit}" for own in vector) + "]"


@dataclass
class Drawn:
    """A part whose features are stated in the world and written in its own frame."""

    turn: Array
    shift: Array
    lines: list[str] = field(default_factory=list)

    def at(self, point: Vector) -> str:
        return listed(self.turn.T @ (np.asarray(point, float) - self.shift), " mm")

    def way(self, direction: Vector) -> str:
        return listed(self.turn.T @ np.asarray(direction, float))

    def add(self, name: str, kind: str, at: Vector, way: tuple[str, Vector], more: str = "") -> None:
        word, direction = way
        self.lines.append(f"      {name}: {{kind: {kind}, at: {self.at(at)}, {word}: {self.way(direction)}{more}}}\n")

    def plane(self, name: str, at: Vector, normal: Vector, x: Vector, extent: tuple[int, int]) -> None:
        size = f"extent: [{extent[0]} mm, {extent[1]} mm]"
        self.add(name, "plane", at, ("normal", normal), f", {size}, along: {self.way(x)}")

    def round(
        self, name: str, at: Vector, diameter: float, axis: Vector = (0, 0, 1), length: float = 8.0, *, hole: bool
    ) -> None:
        more = f", length: {length} mm, diameter: {diameter} mm, hole: {str(hole).lower()}"
        self.add(name, "cylinder", at, ("axis", axis), more)

    @property
    def text(self) -> str:
        placed = f"at: {listed(self.shift, ' mm')}, z: {listed(self.turn[:, 2])}, x: {listed(self.turn[:, 0])}"
        return f"    kind: solid\n    placed: {{{placed}}}\n    features:\n{''.join(self.lines)}"


def base(turn: Array, shift: Array) -> Drawn:
    own = Drawn(turn, shift)
    own.plane("top", (60, 40, 0), (0, 0, 1), (1, 0, 0), (120, 80))
    own.plane("back", (60, 0, 5), (0, 1, 0), (1, 0, 0), (120, 10))
    own.plane("left", (0, 40, 5), (1, 0, 0), (0, 1, 0), (80, 10))
    for k, (x, y) in enumerate(HOLES, 1):
        own.round(f"pin {k}", (x, y, 4), 8.0, hole=False)
    own.round("bore", (60, 40, -10), 12.0, (0.2, 0, 1), 40.0, hole=True)
    own.add("rim", "point", (119, 41, 7), ("normal", (0.2, 0, 1)))
    return own


def cover(turn: Array, shift: Array) -> Drawn:
    own = Drawn(turn, shift)
    own.plane("under", (60, 40, 0), (0, 0, -1), (1, 0, 0), (110, 70))
    own.plane("side", (60, 0, 5), (0, -1, 0), (1, 0, 0), (110, 9))
    own.plane("end", (0, 40, 5), (-1, 0, 0), (0, 1, 0), (70, 9))
    for k, (x, y) in enumerate(((10, 10), (110, 12), (55, 72), (50, 44)), 1):
        own.add(f"A{k}", "point", (x, y, 0), ("normal", (0, 0, -1)))
    for k, x in enumerate((10, 110), 1):
        own.add(f"B{k}", "point", (x, 0, 3), ("normal", (0, -1, 0)))
    own.add("C1", "point", (0, 40, 3), ("normal", (-1, 0, 0)))
    own.round("hole", (*HOLES[0], 4), 8.1, hole=True)
    own.round("hole 2", (*HOLES[1], 4), 8.12, hole=True)
    slot = f", along: {own.way(ALONG)}, extent: [14 mm, 8 mm], width: 8.08 mm"
    own.add("slot", "slot", (*HOLES[1], 4), ("normal", ACROSS), slot)
    own.add("tip", "point", (119, 41, 7), ("normal", (0, 0, 1)))
    return own


def tolerances(scale: float) -> str:
    """Zones and laws of all kinds; `scale` shrinks them all."""
    zones = {
        "base.back": ("perpendicularity", "width", 0.05, "top"),
        "base.left": ("profile", "width", 0.06, "top, back"),
        "base.pin 1": ("position", "diameter", 0.03, "top, back, left"),
        "base.pin 2": ("position", "diameter", 0.03, "top, pin 1"),
        "base.bore": ("position", "diameter", 0.02, "top, pin 1-pin 2, left"),
        "base.rim": ("position", "diameter", 0.05, "bore, top"),
        "cover.side": ("profile", "width", 0.04, "under"),
        "cover.end": ("profile", "width", 0.04, "under, {feature: side, simulator: fitted}"),
        "cover.hole": ("position", "diameter", 0.02, "under"),
        "cover.slot": ("position", "width", 0.03, "under, hole"),
        "cover.hole 2": ("position", "diameter", 0.03, "under, hole"),
        "cover.tip": ("position", "diameter", 0.05, "under, hole, hole 2"),
    }
    found = "".join(
        f"  {name.replace('.', ' ')}: {{kind: {kind}, of: {name}, zone: {{{word}: {width * scale!r} mm}}, "
        f"law: {{kind: uniform}}, datums: [{datums}]}}\n"
        for name, (kind, word, width, datums) in zones.items()
    )
    return found + "".join(
        f"  size of {name.replace('.', ' ')}: {{kind: size, of: {name}, "
        f"distribution: {{kind: normal, mean: 0 mm, sigma: {0.004 * scale!r} mm}}}}\n"
        for name in ("base.pin 1", "base.pin 2", "cover.hole", "cover.slot", "cover.hole 2")
    )


def pairs(*names: str) -> str:
    return "[" + ", ".join(f"{{from: cover.{own.split(':')[0]}, to: base.{own.split(':')[1]}}}" for own in names) + "]"


PRIMARY, SECONDARY = ("A1:top", "A2:top", "A3:top"), ("B1:back", "B2:back")
FLAT = "relations: [{kind: coincident, from: cover.under, to: base.top}]"
MOVES = {
    "three_two_one": f"primary: {pairs(*PRIMARY)}, secondary: {pairs(*SECONDARY)}, tertiary: {pairs('C1:left')}",
    "six_plane": f"pairs: {pairs(*PRIMARY, *SECONDARY, 'C1:left')}",
    "mate": "relations: [{kind: coincident, from: cover.under, to: base.top}, {kind: coaxial, from: cover.hole, "
    "to: base.pin 1}, {kind: coaxial, from: cover.hole 2, to: base.pin 2}]",
    "best_fit": f"pairs: {pairs('hole:pin 1', 'hole 2:pin 2', 'tip:rim')}",
    "pin_and_hole": f"{FLAT}, pairs: {pairs('hole:pin 1', 'slot:pin 2')}, float: {{kind: random}}",
    "pattern": f"{FLAT}, pairs: {pairs('hole:pin 1', 'hole 2:pin 2')}, float: {{kind: centred}}",
    "rest": f"contacts: {pairs(*PRIMARY, 'A4:top', *SECONDARY, 'C1:left')}, "
    "force: {direction: [-0.2, -0.25, -1], at: WEIGHT}",
}


def scene(kind: str, seed: int, scale: float) -> str:
    rng = np.random.default_rng(seed)
    frames = [(Rotation.random(rng=rng).as_matrix(), rng.uniform(-50, 50, 3)) for _ in range(2)]
    parts = {"base": base(*frames[0]), "cover": cover(*frames[1])}
    move = MOVES[kind].replace("WEIGHT", parts["cover"].at((70, 50, 2)))
    rocking = ", rocking: largest" if kind == "rest" else ""
    measures = "".join(
        f"  {name}: {{kind: {what}, from: {own}, to: {other}{way}{rocking}}}\n"
        for name, what, own, other, way in (
            ("x", "gap", "base.rim", "cover.tip", f", along: {parts['base'].way((1, 0, 0))}"),
            ("y", "gap", "base.rim", "cover.tip", f", along: {parts['base'].way((0, 1, 0))}, datums: [top, pin 1]"),
            ("z", "flush", "cover.tip", "base.bore", f", along: {parts['cover'].way((0, 0, 1))}"),
            ("yaw", "angle", "base.back", "cover.side", f", about: {parts['base'].way((0, 0, 1))}"),
            ("roll", "angle", "base.bore", "cover.hole", f", about: {parts['base'].way((0, 1, 0))}"),
            ("height", "point_plane", "cover.tip", "base.top", ""),
        )
    )
    listed_parts = "".join(f"  {name}:\n{own.text}" for name, own in parts.items())
    return (
        f"scene: any frames\nparts:\n{listed_parts}tolerances:\n{tolerances(scale)}"
        f"moves:\n  bench: {{kind: fix, part: base}}\n  lay: {{kind: {kind}, part: cover, {move}}}\n"
        f"measures:\n{measures}"
    )
