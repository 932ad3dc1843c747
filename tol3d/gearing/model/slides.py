"""Shafts that slide through their axial play, as helical gears make them do, and by how much that turns a train.

A gear of twist kappa = tan(beta)/r, right hand positive, that slides by dz in the teeth of a mate at rest screws by
kappa dz and opens no gap. So the thrust of a mesh on its gear is -kappa T, T its torque; where T changes sides, the
shaft moves the way it yields. Of a shaft with the meshes "in" and "out", whose torques are opposite, the thrust is
-T (kappa_in - kappa_out), and its play c turns what it drives by c |kappa_in - kappa_out| more, whichever of the two is
larger and whichever side comes first: the optimum of the linear programme over all turns and shifts. A shaft at an end
of the train has one mesh, an idler the same twist twice. Friction beyond the thrust, springs and weights that hold the
shaft are left out: they make it less.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final

import numpy as np

from tol3d.gearing.model.links import Link, LoadPath, Parallel, links_of
from tol3d.gearing.model.measure import AnyStage, Mix, ParallelStage, Slide
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.networks import Network
from tol3d.gearing.shafts import Mesh
from tol3d.gears.cylindrical_gear import SAME_LEAD
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene

MOST_MIXES: Final = 2000  # each is compared in every trial; two paths of six shafts that slide have eight


def sliding_shafts(model: Model) -> tuple[str, ...]:
    """Shafts with axial play, in the order of the contributors."""
    driving = (shaft for link in model.links for shaft in (link.driver, link.driven) if link.twists)
    shafts = dict.fromkeys((*(shaft for shaft, _ in model.layout.carrying.values()), *driving))
    acting = [contributor.effect for contributor in model.contributors]
    return tuple(shaft for shaft in shafts if any(effect.slides(shaft) for effect in acting))


def slides_of_mesh(model: Model, mesh: Mesh, gear: str) -> tuple[Slide, ...]:
    """Turns of one gear of a mesh, the other one held: the twist of the one that turns, whichever slides."""
    twist = abs(mesh.gear(gear).twist)
    shafts = [model.layout.carrying[own][0] for own in (mesh.driver, mesh.driven)]
    sliding = sliding_shafts(model) if twist else ()
    return tuple(Slide(shaft, twist) for shaft in shafts if shaft in sliding)


def slides_along(model: Model, path: LoadPath) -> Mapping[str, tuple[Slide, ...]]:
    """Turns by the shafts of a load path, by the link at which each counts: at the shaft which that drives."""
    found: dict[str, tuple[Slide, ...]] = {}
    for shaft in sliding_shafts(model):
        if any(isinstance(element, Parallel) for element in _at(path, shaft)):
            continue  # see with_shared_slides
        met = {link: twist for link in links_of(tuple(_at(path, shaft))) if (twist := _twist(model, link, shaft))}
        if not (twist := _unbalanced([*met.values()])):
            continue
        link = next((own for own in met if own.driven == shaft), next(iter(met)))
        rate = 1.0 if link.driven == shaft else abs(float(link.rate))
        found[link.name] = (*found.get(link.name, ()), Slide(shaft, rate * twist))
    return found


def _unbalanced(twists: Sequence[float]) -> float:
    """Size of the twist by which a shaft of one or two links slides; 0 of one whose thrusts cancel."""
    left = abs(twists[0] - twists[1]) if len(twists) == 2 else abs(sum(twists))
    return left if left > SAME_LEAD * max(map(abs, twists), default=0.0) else 0.0


def _twist(model: Model, link: Link, shaft: str) -> float:
    """Twist of a shaft in the teeth of a link [rad/mm]."""
    mesh = model.mesh_of(link.name)
    if mesh is None:
        return model.link(link.name).twists.get(shaft, 0.0)
    return mesh.gear(mesh.driver if link.driver == shaft else mesh.driven).twist


def _at(path: LoadPath, shaft: str) -> list[Link | Parallel]:
    """The elements of a load path that meet at a shaft."""
    return [element for element in path if any(shaft in _shafts(link) for link in links_of((element,)))]


def _shafts(link: Link) -> tuple[str, ...]:
    return link.shafts if link.carrier is None else (*link.shafts, link.carrier)


def with_shared_slides(model: Model, stages: tuple[AnyStage, ...]) -> tuple[AnyStage, ...]:
    """The stages, those of load paths in parallel with the bounds by shafts of theirs that slide.

    Path p lets the shaft where the paths join turn from low_p + a_p . s to high_p + a_p . s, s the shifts of the
    shafts, each within half of its play on either side, and a_p by how much a shift turns that shaft. The largest turn
    that all of them allow is the least of all vertices of the dual programme: weights w of the paths that add up to 1,
    sum(w high) (of a weight below 0, low) + sum of c/2 |sum(w a)| over the shafts; every vertex has as many paths as
    shafts whose sum is 0, and one more. A shaft that goes on to a mesh behind or before the paths turns that as well.
    """
    shafts = sliding_shafts(model)
    return tuple(
        _shared(model, stages, stage, shafts) if shafts and isinstance(stage, ParallelStage) else stage
        for stage in stages
    )


def _shared(model: Model, stages: Sequence[AnyStage], own: ParallelStage, shafts: Sequence[str]) -> ParallelStage:
    touched = {shaft for path in own.paths for stage in path for shaft in shafts if _screwed(model, stage, shaft)}
    found = [shaft for shaft in shafts if shaft in touched]
    series = {shaft: sum(_screwed(model, stage, shaft) for stage in stages if stage is not own) for shaft in found}
    turned = np.array(
        [
            [sum(_screwed(model, stage, shaft) for stage in path) + series[shaft] / (own.sense * own.factor)
             for shaft in found]
            for path in own.paths
        ]
    )  # fmt: skip
    if not found or own.loops or _mixes(*turned.shape) > MOST_MIXES:  # see refuse_shared_thrust
        return own
    mixes, gaps = ([_mix(weights, turned, found) for weights in _vertices(turned, total)] for total in (1.0, 0.0))
    return replace(own, mixes=tuple(dict.fromkeys(mixes)), gaps=tuple(dict.fromkeys(gaps)))


def _mixes(paths: int, shafts: int) -> int:
    """Largest number of vertices of a total of 1."""
    return sum(math.comb(paths, size) * math.comb(shafts, size - 1) for size in range(1, paths + 1))


def _screwed(model: Model, stage: AnyStage, shaft: str) -> float:
    """Turn of the shaft at which a stage is read per shift of another one [rad/mm]: kappa of the driven gear."""
    if isinstance(stage, ParallelStage) or stage.backlash is None:
        return 0.0
    mesh = model.mesh(stage.link)
    twist = stage.sense * stage.factor * mesh.gear(mesh.driven).twist
    moved = 0.0
    for gear, towards in ((mesh.driven, twist), (mesh.driver, -twist)):
        carrier, carried = model.layout.carrying[gear]
        moved += towards * carried.sense * (carrier == shaft)
    return moved


def _vertices(turned: Array, total: float) -> Iterator[Array]:
    """Weights (paths,) with a total of which as many slides vanish as leave no freedom; of a total of 0 both signs."""
    paths, shafts = turned.shape
    for size in range(1 if total else 2, paths + 1):
        for support in combinations(range(paths), size):
            for zero in combinations(range(shafts), size - 1 if total else size - 2):
                rows = np.vstack([np.ones(size), turned[np.ix_(support, zero)].T])
                wanted = np.zeros(len(rows))
                wanted[0] = total
                if not total:
                    rows, wanted = np.vstack([rows, np.eye(size)[:1]]), np.append(wanted, 1.0)
                scale = np.abs(rows).max(axis=1, keepdims=True)
                if not scale.all() or abs(np.linalg.det(rows / scale)) < SAME_LEAD:
                    continue
                weights = np.zeros(paths)
                weights[list(support)] = np.linalg.solve(rows, wanted)
                yield from (weights,) if total else (weights, -weights)


def _mix(weights: Array, turned: Array, shafts: Sequence[str]) -> Mix:
    """Bound by some weights; a slide that vanishes but for rounding is none."""
    slid = np.abs(weights @ turned)
    least = SAME_LEAD * np.abs(turned).max()
    slides = (Slide(shaft, float(own)) for shaft, own in zip(shafts, slid, strict=True) if own > least)
    return Mix(tuple(weights.tolist()), tuple(slides))


def refuse_shared_thrust(scene: Scene, model: Model) -> None:
    """Refuse helical shafts with axial play at which load paths meet otherwise than in parallel, or in several groups.

    Raises:
        SceneError: at the tolerance.
    """
    for contributor in model.contributors:
        for shaft in filter(contributor.effect.slides, sliding_shafts(model)):
            for path in _paths(model):
                met = _at(path, shaft)
                helical = [link for link in links_of(tuple(met)) if _is_helical(model, link)]
                parallel = [element for element in met if isinstance(element, Parallel)]
                mixed = any(isinstance(own, Network) or _is_nested(own) or _is_large(model, own) for own in parallel)
                turned = any(link.carrier for link in (links_of(path) if parallel else helical))
                sets = bool(parallel) and any(model.mesh_of(link.name) is None for link in helical)
                many = len(parallel) > 1 or (not parallel and len(met) > 2)
                if helical and (mixed or turned or sets or many):
                    words = f"expected a shaft in one load path, or in simple parallel ones, got {shaft!r}: how the "
                    advice = "load paths that meet at it share its thrust is not simulated; hold it along its axis"
                    raise scene.refuse(("tolerances", contributor.name, "of"), f"{words}{advice}")


def _is_helical(model: Model, link: Link) -> bool:
    return any(_twist(model, link, shaft) for shaft in _shafts(link))


def _is_large(model: Model, group: Parallel) -> bool:
    met = {shaft for link in links_of((group,)) for shaft in _shafts(link)}
    return _mixes(len(group.paths), len(met.intersection(sliding_shafts(model)))) > MOST_MIXES


def _is_nested(group: Parallel) -> bool:
    return any(isinstance(element, Parallel) for path in group.paths for element in path)


def _paths(model: Model) -> Iterator[LoadPath]:
    """Load paths of the trains, and of their measures at other shafts."""
    ends = {(train.held, train.output) for train in model.trains}
    for measure in model.measures:
        if (shaft := getattr(measure.kind, "shaft", None)) is not None:
            ends.add((getattr(measure.kind, "held", ""), shaft))
    return (model.layout.load_path(held, shaft) for held, shaft in sorted(ends))


def idle_slides(model: Model) -> Iterator[tuple[str, str]]:
    """Axial plays that no measure reads, with the reason."""
    read = {shaft for measure in model.measures for shaft in measure.kind.sliding}
    for contributor in model.contributors:
        if contributor.kind != "axial_play":
            continue
        for shaft in filter(contributor.effect.slides, sliding_shafts(model)):
            if shaft in read:
                continue
            if not any(_twist(model, link, shaft) for link in model.layout.links if shaft in link.shafts):
                yield contributor.name, f"acts on nothing: no gear on {shaft!r} is helical, and spur gears do not screw"
            else:
                words = "no angular backlash, lost motion or swing is measured that depends on it, or thrusts of equal "
                yield contributor.name, f"acts on nothing: {words}leads and hands cancel on {shaft!r}"
