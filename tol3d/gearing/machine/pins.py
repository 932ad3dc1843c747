"""The pins of carriers that are drawn as features of parts: nominal places, effects of displacements on links.

Of each pin, and of the axis about which the part turns, both ends are read as those of a shaft in bores are, seen by
their own part.

Effect of bores on the parts on the axis of a link: sun, rings, carrier and pin ring are offset as their bores are.

A part whose bores no move names is taken to lie on the axis of the first part that has some.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.model import Assembly, Shape
from tol3d.gearing.links import Moved, StatedLink, pin_name
from tol3d.gearing.machine.grammar.bores import CarrierPinsSpec
from tol3d.gearing.machine.nominal import AZIMUTH_AS_WRITTEN, SAME_DIRECTION, SAME_PLACE, Bore, Housed, HousedShaft
from tol3d.gearing.model import Model
from tol3d.gearing.model.brought import shaft_of
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene


@dataclass(frozen=True, eq=False)
class Pins:
    """The pins of a carrier.

    Args:
        link: that has the carrier.
        axis: of the part, x towards the first pin.
        pins: x outwards.
    """

    link: str
    axis: HousedShaft
    pins: tuple[HousedShaft, ...]

    @property
    def shafts(self) -> tuple[HousedShaft, ...]:
        """All that is read."""
        return (self.axis, *self.pins)

    def moved(self) -> Iterator[Moved]:
        """Effects of displacements of the axis and of the pins on the places of the pins."""
        for k, pin in enumerate(self.pins):
            middle = (pin.bores[0].place + pin.bores[1].place) / 2
            for own, sign in ((pin, 1.0), (self.axis, -1.0)):
                turned = sign * pin.frame[:3, :2].T @ own.frame[:3, :2]
                at = float((middle - own.frame[:3, 3]) @ own.frame[:3, 2])
                ends = [own.along(bore) for bore in own.bores]
                for end in range(2):
                    share = (at - ends[1 - end]) / (ends[end] - ends[1 - end])
                    (xx, xy), (yx, yy) = (share * turned).tolist()
                    yield Moved(displacement_name(own, end), pin_name(k), ((xx, xy), (yx, yy)))


def pins_of(scene: Scene, model: Model, assembly: Assembly) -> tuple[Pins, ...]:
    """The pins of all carriers that are drawn.

    Raises:
        SceneError: pins that are not where the planets or cranks of a carrier turn, or no carrier's.
    """
    found: dict[str, Pins] = {}
    for name, spec in scene.of(CarrierPinsSpec).items():
        link = next((own for own in model.links if spec.carrier in own.levels and own.pins), None)
        if link is None:
            words = f"expected the carrier of a planetary set or an RV reducer of a train, got {spec.carrier!r}"
            raise scene.refuse(("moves", name, "carrier"), words)
        if link.name in found:
            words = f"expected a carrier whose pins no other move draws, got {spec.carrier!r}"
            raise scene.refuse(("moves", name, "carrier"), words)
        found[link.name] = _drawn(scene, name, spec, link, assembly)
    return tuple(found.values())


def with_pins(model: Model, pins: Sequence[Pins]) -> Model:
    """Gears whose links see where their pins lie."""
    of = {pin.link: tuple(pin.moved()) for pin in pins}
    links = tuple(replace(link, moved=(*link.moved, *of.get(link.name, ()))) for link in model.links)
    return replace(model, links=links)


def _drawn(scene: Scene, name: str, spec: CarrierPinsSpec, link: StatedLink, assembly: Assembly) -> Pins:
    if len(spec.pins) != len(link.pins):
        words = f"expected {len(link.pins)} pins, as {link.name!r} has, got {len(spec.pins)}"
        raise scene.refuse(("moves", name, "pins"), words)
    host = part_of(spec.axis)
    for k, own in enumerate(spec.pins):
        if part_of(own) != host:
            words = f"expected a pin of {host!r}, as the axis is, got {own!r}"
            raise scene.refuse(("moves", name, "pins", k), words)
    (_, centre), places = _pose(assembly, spec.axis), [_pose(assembly, pin)[1] for pin in spec.pins]
    z = centre[:3, 2]
    towards = [pose[:3, 3] - centre[:3, 3] for pose in places]
    flat = [each - z * (each @ z) for each in towards]
    x = flat[0] / np.linalg.norm(flat[0])
    for k, (pose, off, polar) in enumerate(zip(places, flat, link.pins, strict=True)):
        _refuse_misplaced(scene, ("moves", name, "pins", k), spec.pins[k], (pose, off), (x, z), polar)
    made = [_line(name, f"{link.name} axis", assembly, spec.axis, _frame(centre[:3, 3], x, z))]
    for k, (pose, off) in enumerate(zip(places, flat, strict=True)):
        frame = _frame(pose[:3, 3], off / np.linalg.norm(off), z)
        made.append(_line(name, f"{link.name} pin {k + 1}", assembly, spec.pins[k], frame))
    return Pins(link.name, made[0], tuple(made[1:]))


def _refuse_misplaced(
    scene: Scene,
    here: tuple[str | int, ...],
    name: str,
    pin: tuple[Array, Array],
    axes: tuple[Array, Array],
    polar: tuple[float, float],
) -> None:
    """Refuse a pin that leans against the axis or lies elsewhere.

    Args:
        scene: with the pin.
        here: its place in it.
        name: of its feature.
        pin: its frame (4, 4), and its place off the axis (3,).
        axes: towards the first pin, and along the axis.
        polar: radius [mm] and azimuth [rad] that it should have.
    """
    (frame, off), (x, z), (radius, azimuth) = pin, axes, polar
    lean = float(np.linalg.norm(np.cross(frame[:3, 2], z)))
    if lean > SAME_DIRECTION:
        raise scene.refuse(here, f"expected a pin along the axis, got {name!r} at {1e3 * lean:.4g} mrad")
    away = float(np.linalg.norm(off))
    if abs(away - radius) > SAME_PLACE:
        raise scene.refuse(here, f"expected a pin {radius:.9g} mm off the axis, got {name!r} at {away:.9g} mm")
    turned = math.atan2(off @ np.cross(z, x), off @ x)
    if abs(math.remainder(turned - azimuth, 2 * math.pi)) > AZIMUTH_AS_WRITTEN:
        words = f"expected {math.degrees(azimuth) % 360:.7g} deg from the first pin to {name!r}, counter-clockwise"
        raise scene.refuse(here, f"{words} about the axis, got {math.degrees(turned) % 360:.7g} deg")


def _pose(assembly: Assembly, name: str) -> tuple[Shape, Array]:
    """Shape of a feature, and its frame nominally in the world (4, 4)."""
    own = assembly.features[name]
    return own.shape, np.asarray(assembly.part[own.part].pose @ own.frame)


def _line(move: str, name: str, assembly: Assembly, feature: str, frame: Array) -> HousedShaft:
    shape, pose = _pose(assembly, feature)
    low, high = shape.ends @ pose[:3, :3].T + pose[:3, 3]
    ends = Bore(feature, 0, low), Bore(feature, 1, high)
    return HousedShaft(move, name, ends, frame, assembly.features[feature].part, "of pins of")


def _frame(origin: Array, x: Array, z: Array) -> Array:
    made = np.eye(4)
    made[:3, 0], made[:3, 1], made[:3, 2], made[:3, 3] = x, np.cross(z, x), z, origin
    return made


def displacement_name(shaft: HousedShaft, k: int) -> str:
    """The contributor that displaces one of the two points of a shaft's axis; scenes cannot name one so."""
    return f".{shaft.shaft} at {shaft.bores[k].words}"


def with_bores(scene: Scene, model: Model, place: Housed) -> Model:
    """Gears whose links see where bores have their parts.

    Args:
        scene: of the gears.
        model: of them, still without bores.
        place: their shafts in bores.
    """
    return replace(model, links=tuple(_in_bores(scene, model, place, link) for link in model.links))


def _in_bores(scene: Scene, model: Model, place: Housed, link: StatedLink) -> StatedLink:
    on = {part: shaft_of(scene, part)[0] for part in link.levels}
    laid = [shaft for shaft in place.shafts if shaft in on.values()]  # in the order of the moves
    if not laid:
        return link
    first = place.shafts[laid[0]]
    driver = place.worlds[model.layout.root_of[link.driver]] @ model.layout.world_from_shaft[link.driver]
    moved = tuple(
        each
        for part, level in link.levels.items()
        for each in _moved(place.shafts.get(on[part], first), part, driver, level)
    )
    others = [part for part, shaft in on.items() if shaft not in laid]
    lie = "lies" if len(others) == 1 else "lie"
    words = f"{', '.join(others)} {lie} in no bores, and so on the axis of {first.shaft}" if others else ""
    return replace(link, moved=moved, assumed=words)


def _moved(shaft: HousedShaft, part: str, driver: Array, level: float) -> Iterator[Moved]:
    """Effect of both points of a shaft's axis on a part of a link.

    Args:
        shaft: in its bores.
        part: on it.
        driver: frame of the link's driver at rest, in the world of the parts (4, 4).
        level: of the part along the driver's z [mm].
    """
    own = shaft.frame
    z = float((driver[:3, 3] + level * driver[:3, 2] - own[:3, 3]) @ own[:3, 2])
    turned = driver[:3, :2].T @ own[:3, :2]
    places = [shaft.along(bore) for bore in shaft.bores]
    for k in range(2):
        share = (z - places[1 - k]) / (places[k] - places[1 - k])
        (xx, xy), (yx, yy) = (share * turned).tolist()
        yield Moved(displacement_name(shaft, k), part, ((xx, xy), (yx, yy)))
