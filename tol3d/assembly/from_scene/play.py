"""Moves with play: where pins, tabs, holes and slots engage nominally, and the draws of bolts and floats."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from tol3d.assembly.from_scene.effects import Effects
from tol3d.assembly.from_scene.features import poses_of
from tol3d.assembly.from_scene.moves import relations_of
from tol3d.assembly.from_scene.setting import Setting
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.moves import PlaySpec
from tol3d.assembly.grammar.moves.play import BoltSpec, EngagementSpec, RandomSpec, TowardSpec
from tol3d.assembly.model import Bolt, Contribution, Engage, Engagement, Feature, Floating
from tol3d.assembly.zones.float_draw import SHIFT_AND_TURN, FloatDraw, Law
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.study.system.draw import Scalar
from tol3d.study.system.plain import PlainContributor

FLAT = 1e-6
"""Sine of an angle that is none."""
SHORT = 1e-9
"""Length of an engagement that counts as none [mm]."""


def contributors_of(spec: PlaySpec, name: str, scene: Scene) -> Iterator[PlainContributor]:
    """Diameters of bolts that belong to no part; then the draw of a part with random play.

    Raises:
        SceneError: a law that leaves nothing of a bolt.
    """
    for k, pair in enumerate(spec.engaged):
        if (bolt := pair.through) is not None and bolt.distribution is not None:
            draw = Scalar(bolt.distribution.resolve(scene.files))
            _refuse_no_bolt(scene, name, k, bolt, draw)
            words = f"bolt through {pair.from_} and {pair.to}"
            yield PlainContributor(_bolt_name(name, k), "size", draw, description=words, nominal="size")
    if isinstance(spec.floating, RandomSpec):
        if not spec.floats_by_pairs(Drawing(scene)):
            float_draw = FloatDraw(("room",), (*SHIFT_AND_TURN, "start"))
        else:
            ends = ("",) if spec.relations else ("start ", "end ")
            names = [f"{end}{axis}" for end in ends for axis in "xy"] + ["across"] * (len(spec.engaged) - 1)
            laws: list[Law] = ["disc" for _ in ends]
            laws += ["interval" for _ in spec.engaged[1:]]
            float_draw = FloatDraw(tuple(laws), tuple(names))
        words = f"where {spec.part} lies in its room"
        yield PlainContributor(_float_name(name), "float", float_draw, "1", 1.0, words)


def _bolt_name(move: str, k: int) -> str:
    return f"bolt {k + 1} of {move}"


def _float_name(move: str) -> str:
    return f"float of {move}"


def _refuse_no_bolt(scene: Scene, name: str, k: int, spec: BoltSpec, draw: Scalar) -> None:
    assert spec.diameter is not None
    nominal, law = spec.diameter.internal, draw.distribution
    if nominal + law.low <= 0.0 or law.high >= nominal:
        words = f"expected deviations smaller than the nominal {nominal:g} mm, got {law.low:g} to {law.high:g} mm"
        raise scene.refuse(("moves", name, "pairs", k, "bolt", "distribution"), words)


def engaged(spec: PlaySpec, name: str, setting: Setting) -> Engage:
    """A move with play.

    Raises:
        SceneError: features that do not engage nominally; a hole that is smaller than its pin at the mean.
    """
    scene, effects, features = setting.scene, setting.effects, setting.features
    engagements, poses = [], poses_of(scene)  # as drawn: moves may tilt a part within its play
    for k, pair in enumerate(spec.engaged):
        here = ("moves", name, "pairs", k)
        if pair.through is not None:
            engagements.append(_bolted(setting, name, k, pair, pair.through, poses))
            continue
        found = _engagement(pair, features, poses)
        if isinstance(found, str):
            raise scene.refuse(here, found)
        clearance = _mean_size(effects, features[found.inner]) - _mean_size(effects, features[found.outer])
        if clearance < 0.0:
            words = f"expected a size of {found.inner!r} above that of {found.outer!r} at the mean"
            raise scene.refuse(here, f"{words}, got {-clearance * 1e3:.6g} um under it; nothing could be assembled")
        engagements.append(found)
    return Engage(name, spec.part, relations_of(spec.relations), tuple(engagements), _floating(name, spec, setting))


def _bolted(
    setting: Setting, name: str, k: int, pair: EngagementSpec, spec: BoltSpec, poses: Mapping[str, Array]
) -> Engagement:
    """Two holes and their bolt."""
    scene, effects, features = setting.scene, setting.effects, setting.features
    holes = [features[own] for own in (pair.from_, pair.to)]
    frames = [poses[part_of(own.name)] @ own.frame for own in holes]
    here = ("moves", name, "pairs", k)
    if np.linalg.norm(np.cross(frames[0][:3, 2], frames[1][:3, 2])) > FLAT:
        raise scene.refuse(here, "expected two holes that are nominally parallel, got them at an angle")
    places = [own.shape.ends for own in holes]
    ends = np.concatenate([own @ frame[:3, :3].T + frame[:3, 3] for own, frame in zip(places, frames, strict=True)])
    frame = frames[1].copy()
    frame[:3, 3] = ends.mean(axis=0)
    reach = float(np.abs((ends - frame[:3, 3]) @ frame[:3, 2]).max())
    if spec.of is None:
        assert spec.diameter is not None
        diameter: float = spec.diameter.internal
        contributor = _bolt_name(name, k)
        by: tuple[Contribution, ...] = (Contribution(contributor, setting.drawn[contributor], np.eye(1)),)
    else:
        shank = features[spec.of]
        diameter, by = shank.shape.nominal_size or 0.0, shank.mating_by
    mean = diameter + _mean_deviation(effects, by)
    for hole in holes:
        short = mean - _mean_size(effects, hole)
        if short > 0.0:
            words = (
                f"expected a size of {hole.name!r} above that of its bolt at the mean, got {short * 1e3:.6g} um under"
            )
            raise scene.refuse(here, f"{words} it; nothing could be assembled")
    bolt = Bolt(diameter, by, frame, reach)
    return Engagement(holes[0].name, holes[1].name, places[0], places[1], bolt)


def _floating(name: str, spec: PlaySpec, setting: Setting) -> Floating:
    match spec.floating:
        case RandomSpec():
            by_pairs = spec.floats_by_pairs(setting.drawing)
            return Floating("random", setting.drawn[_float_name(name)], by_pairs=by_pairs)
        case TowardSpec(along=along, at=at):
            return Floating("toward", at=at, along=unit(along))
    return Floating("centred")


def _mean_size(effects: Effects, feature: Feature) -> float:
    """At the means of its tolerances [mm]."""
    return (feature.shape.nominal_size or 0.0) + _mean_deviation(effects, feature.mating_by)


def _mean_deviation(effects: Effects, size_by: Sequence[Contribution]) -> float:
    contributors = {contributor.name: contributor for contributor in effects.contributors}
    return sum(float(own.matrix[0] @ contributors[own.contributor].draw.mean(turning=False)) for own in size_by)


def _engagement(pair: EngagementSpec, features: Mapping[str, Feature], poses: Mapping[str, Array]) -> Engagement | str:
    """The engagement of a pair, or the sentence that says why there is none."""
    one, other = features[pair.from_], features[pair.to]
    inner, outer = (one, other) if one.shape.inner else (other, one)
    seen = np.linalg.inv(poses[part_of(inner.name)] @ inner.frame) @ poses[part_of(outer.name)] @ outer.frame
    whose = {"from": one, "to": other}[pair.over] if pair.over else None
    over = () if whose is None else ("inner",) if whose is inner else ("outer",)
    axis = seen[:3, 2]
    match inner.shape.surface, outer.shape.surface:
        case "axis", _:
            if np.hypot(axis[0], axis[1]) > FLAT:
                return f"expected a pin nominally along the axis of its hole, got {outer.name!r} at an angle"
            ends = _overlap([inner.shape.ends[:, 2], seen[2, 3] + axis[2] * outer.shape.ends[:, 2]], over)
            places = np.zeros((2, 3))
            places[:, 2] = ends
        case _, "axis":
            if abs(axis[2]) > FLAT:
                return f"expected a pin nominally along the faces of its slot, got {outer.name!r} across them"
            inside = [_within(seen[r, 3], axis[r], inner.shape.reach[r]) for r in (0, 1)]
            slot = np.array([max(low for low, _ in inside), min(high for _, high in inside)])
            ends = _overlap([slot, outer.shape.ends[:, 2]], over)
            places = seen[:3, 3] + ends[:, None] * axis
            places[:, 2] = 0.0
        case _:
            if np.hypot(axis[0], axis[1]) > FLAT:
                return f"expected a tab nominally parallel to its slot, got {outer.name!r} at an angle"
            own, its = inner.shape.ends, outer.shape.ends @ seen[:3, :3].T + seen[:3, 3]
            ranges = [_overlap([np.sort(own[:, r])[[0, -1]], np.sort(its[:, r])[[0, -1]]], over) for r in (0, 1)]
            ends = min(ranges, key=lambda found: found[1] - found[0])
            places = np.array([[x, y, 0.0] for x in ranges[0] for y in ranges[1]])
    if ends[1] - ends[0] <= SHORT:
        words = f"expected features that share a stretch nominally, got {outer.name!r} outside {inner.name!r}"
        return f"{words}; place the parts, or say whose ends count as `over`"
    back = np.linalg.inv(seen)
    opposite = places @ back[:3, :3].T + back[:3, 3]
    # on the pin's axis or in the tab's middle, however far off its hole or slot it is drawn
    opposite[:, outer.shape.located] = 0.0
    return Engagement(inner.name, outer.name, places, opposite)


def _overlap(ranges: Sequence[Array], over: Sequence[str]) -> Array:
    """Intersection of two ranges, or the one that counts: lower and upper end."""
    inner, outer = (np.sort(own) for own in ranges)
    if over:
        return inner if over[0] == "inner" else outer
    return np.array([max(inner[0], outer[0]), min(inner[1], outer[1])])


def _within(start: float, slope: float, reach: float) -> tuple[float, float]:
    """Interval in which a line stays within -reach to reach."""
    if abs(slope) < FLAT:
        return (-np.inf, np.inf) if abs(start) <= reach else (np.inf, -np.inf)
    low, high = sorted(((-reach - start) / slope, (reach - start) / slope))
    return low, high
