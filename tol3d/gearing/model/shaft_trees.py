"""Checks that the shafts of a scene make trees that a motor can turn."""

from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np

from tol3d.errors import SceneError
from tol3d.gearing.model.layout import Layout
from tol3d.gearing.model.links import Link, first_drivers, loop_of, turns_of, upstream
from tol3d.gearing.shafts import Arm
from tol3d.scene import Scene

ON_THE_AXIS = 1e-6  # mm, and rad


def refuse_no_trees(scene: Scene, links: Sequence[Link]) -> None:
    """Refuse shafts that do not make trees, carriers that no motor turns, or load paths that join and would lock.

    Several links may drive a shaft only if they come from one first shaft and give one ratio.

    Raises:
        SceneError: at the link that is too many.
    """
    for link in links:
        if link.driver == link.driven:
            sentence = f"driver and driven sit on the same shaft, {link.driver!r}: it would lock itself"
            raise scene.refuse(("moves", link.name), sentence)
    first = first_drivers(links)
    if loop := loop_of(list(first.values())):
        raise _loop(scene, first[loop[-1]].name, loop)
    for link in links:
        if link.carrier is not None:
            _refuse_carrier(scene, first, link, link.carrier)
    turns = turns_of(links)
    for shaft, own in turns.items():
        if not own:
            sentence = f"expected a shaft that turns, got {shaft!r}, which its driver and its carrier leave at rest"
            raise scene.refuse(("moves", first[shaft].name), sentence)
    for link in links:
        if first[link.driven] is not link:
            _refuse_second(scene, first, link, turns)


def _refuse_carrier(scene: Scene, first: Mapping[str, Link], link: Link, carrier: str) -> None:
    """Refuse a carrier that turns by the link itself, or in another tree, or on parallel load paths."""
    here = ("moves", link.name)
    if first[link.driven] is not link:
        raise scene.refuse(here, f"a link on a carrier, {carrier!r}, cannot close parallel load paths; take out one")
    if link in (*upstream(first, carrier), *upstream(first, link.driver)):
        raise scene.refuse(here, f"expected a carrier that turns without this link, got {carrier!r}, which it drives")
    roots = [_path_from_root(first, shaft)[0] for shaft in (link.driver, carrier)]
    if roots[0] != roots[1]:
        sentence = f"expected a carrier that {roots[0]!r} turns, as it does {link.driver!r}, got {carrier!r}"
        raise scene.refuse(here, sentence)


def _refuse_second(scene: Scene, first: Mapping[str, Link], link: Link, turns: Mapping[str, Fraction]) -> None:
    """Refuse a second link to a shaft unless it closes parallel load paths."""
    here, before = ("moves", link.name), first[link.driven]
    paths = [_path_from_root(first, shaft) for shaft in (link.driver, link.driven)]
    if link.driven in paths[0]:
        raise _loop(scene, link.name, (*paths[0][paths[0].index(link.driven) :], link.driven))
    if paths[0][0] != paths[1][0]:
        raise scene.refuse(
            here,
            f"two drivers: {link.driven!r} is driven by {link.driver!r} here and by {before.driver!r} in "
            f"{before.name!r}, and these are not driven together; turn driver and driven round, or take out one",
        )
    rates = turns[link.driver] * link.rate, turns[link.driven]
    if rates[0] != rates[1]:
        raise scene.refuse(
            here,
            f"a loop of shafts that locks: {link.driven!r} turns {ratio_text(rates[0])} times with {paths[0][0]!r} "
            f"here and {ratio_text(rates[1])} times by {before.name!r}; give both load paths one ratio, or take out "
            "one",
        )
    each = [set(upstream(first, shaft)) for shaft in (link.driver, link.driven)]
    for own in each[0] ^ each[1]:
        if own.carrier is not None:
            raise scene.refuse(
                here,
                f"expected load paths without a carrier, got {own.name!r} on one of them, which {own.carrier!r} "
                "carries; parallel load paths rest in the world",
            )


def _path_from_root(first: Mapping[str, Link], shaft: str) -> list[str]:
    """The shafts from a root to a shaft."""
    return [shaft] if shaft not in first else [*_path_from_root(first, first[shaft].driver), shaft]


def _loop(scene: Scene, link: str, shafts: Sequence[str]) -> SceneError:
    text = " → ".join(map(repr, shafts))
    return scene.refuse(("moves", link), f"a loop of shafts: {text}; no motor can turn them: take out a link")


def refuse_revolving(scene: Scene, layout: Layout, arms: Sequence[Arm]) -> None:
    """Refuse a gear mesh, a plain link or an arm fixed in the world on a shaft whose axis goes round with a carrier.

    Raises:
        SceneError: at the move, or the arm.
    """
    revolving = _revolving(layout)
    resting = [(("moves", link.name), shaft) for link in layout.links if not link.carrier for shaft in link.shafts]
    for place, shaft in (*resting, *((("parts", arm.name), arm.on) for arm in arms)):
        if carrier := revolving.get(shaft):
            sentence = f"expected a shaft whose axis rests, got {shaft!r}, whose axis {carrier!r} takes round"
            raise scene.refuse(place, sentence)


def _revolving(layout: Layout) -> Mapping[str, str]:
    """Shafts whose axes go round, with the carrier of each."""
    found: dict[str, str] = {}
    for shaft, link in layout.driving.items():
        if link.carrier is not None and not _on_one_axis(layout, shaft, link.carrier):
            found[shaft] = link.carrier
    return found


def _on_one_axis(layout: Layout, shaft: str, carrier: str) -> bool:
    here, there = layout.world_from_shaft[shaft], layout.world_from_shaft[carrier]
    apart = np.cross(here[:3, 3] - there[:3, 3], there[:3, 2])
    askew = np.cross(here[:3, 2], there[:3, 2])
    return bool(max(np.abs(apart).max(), np.abs(askew).max()) < ON_THE_AXIS)


def ratio_text(ratio: Fraction) -> str:
    """A ratio in six digits."""
    return f"{float(ratio):.6g}"
