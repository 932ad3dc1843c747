"""Effect of bores on the parts on the axis of a link: sun, rings, carrier and pin ring are offset as their bores are.

A part whose bores no move names is taken to lie on the axis of the first part that has some.
"""

from collections.abc import Iterator
from dataclasses import replace

from tol3d.gearing.links import Moved, StatedLink
from tol3d.gearing.model import Model
from tol3d.gearing.model.brought import shaft_of
from tol3d.machine.nominal import Housed, HousedShaft
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene


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
