"""Scene to model: text becomes meaning, units become mm and rad, gears become geometry or are refused."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

import tol3d.gearing.model.train_measures  # noqa: F401  (registers its kinds)
from tol3d.errors import GeometryError, SceneError
from tol3d.gearing.grammar.measures import GearStudyOptions
from tol3d.gearing.grammar.moves import GearMeshSpec, meshes_of
from tol3d.gearing.grammar.parts import GearSpec, HousingSpec
from tol3d.gearing.grammar.tolerances.gears import MeasuredOverSpec, ToothThicknessSpec
from tol3d.gearing.links import StatedLink
from tol3d.gearing.model.brought import NOTHING, Brought, brought_into, with_shared_shafts
from tol3d.gearing.model.faces import narrower_faces, refuse_no_common_face
from tol3d.gearing.model.layout import Layout, layout_of
from tol3d.gearing.model.links import links_between_shafts, links_of
from tol3d.gearing.model.measure import Measure
from tol3d.gearing.model.mesh_measures import measure_of
from tol3d.gearing.model.model import GearPart, Housing, Model
from tol3d.gearing.model.nominal import Nominal
from tol3d.gearing.model.pairs import assembly_warning, internal, pair_of, undercut_warning
from tol3d.gearing.model.reversals import refuse_opposed_loads
from tol3d.gearing.model.shaft_trees import refuse_no_trees, refuse_revolving
from tol3d.gearing.model.slides import idle_slides, refuse_shared_thrust
from tol3d.gearing.model.trains import (
    arms_of,
    loaded_flank,
    loose_gears,
    refuse_bearings,
    refuse_misfits,
    refuse_other_ratios,
    refuse_second_laws,
    shafts_of,
    stated_links_of,
    trains_of,
)
from tol3d.gearing.shafts import Arm, Mesh, Train
from tol3d.gears import LEFT, RIGHT, Gear, InternalGear, SpurGear
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.tooth_measures import SAME_NOMINAL, Span, ToothMeasure
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, larger_end, warned
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions.drawn import nominal_size, typed_sizes
from tol3d.statistics.distributions.size_limits import sizes_written

THICKNESS: Final = Implausible(0.1, "state the deviation of the thickness from nominal, and check the unit")

WHOLE_SIZE: Final = 0.5  # share of a nominal size from which a "deviation" is the size itself
FOREIGN_SIZE: Final = 0.25  # pitches of the arc; no teeth are thinned by as much


def implausible_teeth(scene: Scene, gears: Mapping[str, Gear]) -> Iterator[str]:
    """Warnings of tooth thicknesses off by more than a tenth.

    Args:
        scene: with the tolerances.
        gears: by their names, nominal; tolerances of others are left out.

    Raises:
        SceneError: a tooth is thinned until its flanks meet at the tip, or beyond.
    """
    for name, spec in scene.of(ToothThicknessSpec).items():
        if (gear := gears.get(spec.of)) is None:
            continue
        refuse_other_measure(scene, name, spec, gear)
        law = spec.law_on(gear, scene.files)
        arc = gear.thickness_radius / gear.section_arm if spec.is_normal else 1.0
        path: KeyPath = ("tolerances", name, "distribution")
        sign = spec.sign_in(ring=isinstance(gear, InternalGear))
        sentence = _whole_sizes(spec, scene, "tooth thickness", gear.section_thickness)
        if sentence and typed_sizes(spec.distribution.drawn) is None:
            raise scene.refuse(path, sentence)
        thinnest, left = min(sign * extreme for extreme in law.extremes) * arc, gear.section_thickness
        if -thinnest >= gear.section_tip:
            words = f"expected teeth of {spec.of!r} ({left:.4g} mm thick) that are thinner by less than "
            words += f"{gear.section_tip:.4g} mm, where their flanks meet at the tip, got {thinnest:.4g} mm"
            raise scene.refuse(path, f"{words}; {THICKNESS.advice}")
        if min(sign * extreme for extreme in law.extremes) > 0.0:
            words = "expected teeth that are thinner than nominal, got thicker ones in every build"
            grows = isinstance(gear, InternalGear) and spec.over is not None  # as the teeth get thinner
            advice = f"allowances of a drawing are {'positive' if grows else 'negative'}: check the sign"
            is_typed = typed_sizes(spec.distribution.drawn) is not None
            if is_typed and spec.over is not None and isinstance(gear, CylindricalGear):
                side = f"{'larger' if grows else 'smaller'} than the nominal {spec.over.size(gear):.4f} mm"
                advice = f"sizes of a drawing are {side}: look at k, pins, x and teeth"
            yield warned(scene.origin, path, f"{words}; {advice}")
        if sentence := _reversed(spec):
            yield warned(scene.origin, path, sentence)
        if sentence := _other_nominal(spec, gear):
            yield warned(scene.origin, path, sentence)
        if sentence := THICKNESS.sentence(f"the tooth thickness of {spec.of!r}", left, larger_end(law) * arc):
            yield warned(scene.origin, path, sentence)


def refuse_other_measure(scene: Scene, name: str, spec: ToothThicknessSpec, gear: Gear) -> None:
    """Refuse a span or pins of a gear that has none, or that touch outside the flanks, also with its limits.

    Raises:
        SceneError: with what would do.
    """
    if not isinstance(spec.measured, MeasuredOverSpec):
        return
    path: KeyPath = ("tolerances", name, "measured")
    if not isinstance(gear, SpurGear | InternalGear):
        word = "a span" if spec.measured.key == "span" else spec.measured.key
        raise scene.refuse(path, f"expected arc or normal, got {word}: {spec.of!r} is a bevel gear")
    try:
        measure = spec.measured.measure
        measure.require_reach(gear)
        for sentence in (
            _another_measure(spec, measure, gear),
            _whole_sizes(spec, scene, measure.words, measure.size(gear)),
        ):
            if sentence:
                raise scene.refuse(("tolerances", name, "distribution"), sentence)
        for size in spec.distribution.resolve(scene.files).extremes:
            arc = measure.thickness(gear, measure.size(gear) + size) - gear.tooth_thickness
            measure.require_reach(replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + arc))
    except GeometryError as error:
        raise scene.refuse((*path, spec.measured.key), str(error)) from None


def _whole_sizes(spec: ToothThicknessSpec, scene: Scene, words: str, nominal: float) -> str:
    """Sentence for limits that are the size itself instead of its deviations from nominal [mm]; "" for deviations."""
    low, high = sorted(spec.distribution.resolve(scene.files).extremes)
    if low < WHOLE_SIZE * nominal:
        return ""
    deviations = f"{low - nominal:+.4g}/{high - nominal:+.4g} mm".replace("-0/", "0/").replace("+0/", "0/")
    typed = (
        "" if spec.over is None or words != spec.over.words else f", as limits of the size {low:.7g} / {high:.7g} mm"
    )
    return (
        f"expected deviations from the nominal {words} of {nominal:.4f} mm, "
        f"got {low:.7g} to {high:.7g} mm, which are whole sizes; as deviations they are {deviations}{typed}"
    )


def _another_measure(spec: ToothThicknessSpec, measure: ToothMeasure, gear: CylindricalGear) -> str:
    """Sentence for limits of a size that lie more than a quarter of a pitch off the nominal one; "" for others.

    Each tooth more adds a pitch of the base circles to a span.

    Raises:
        GeometryError: pins are never at such a size.
    """
    text = typed_sizes(spec.distribution.drawn)
    pair = sizes_written(text)
    if pair is None:
        return ""
    middle, nominal = (pair[0].internal + pair[1].internal) / 2, measure.size(gear)
    pitch = 2 * math.pi * gear.thickness_radius / gear.teeth
    if abs(measure.thickness(gear, middle) - gear.tooth_thickness) < FOREIGN_SIZE * pitch:
        return ""
    words = f"expected limits near the nominal {measure.words} of {nominal:.4f} mm, got {text}"
    if isinstance(measure, Span):
        other = Span.nearest(gear, middle)
        if other != measure and other.teeth > 0:
            return f"{words}, which is near the {other.words}, {other.size(gear):.4f} mm; look at k"
    return f"{words}; look at teeth, module and profile shift, and at what the size is over"


def _reversed(spec: ToothThicknessSpec) -> str:
    """Sentence for limits of a size of which the upper one stands first; "" for others."""
    text = typed_sizes(spec.distribution.drawn)
    pair = sizes_written(text)
    if pair is None or pair[0].internal < pair[1].internal:
        return ""
    return f"expected the lower limit of the size first, got {text}; read as {pair[1]} to {pair[0]}"


def _other_nominal(spec: ToothThicknessSpec, gear: Gear) -> str:
    """A nominal size in front of limits that is not the gear's; "" where there is none, or nothing else is measured."""
    stated = None if spec.over is None else nominal_size(spec.distribution.drawn)
    if spec.over is None or stated is None or not isinstance(gear, SpurGear | InternalGear):
        return ""
    size = spec.over.size(gear)
    if abs(size - stated.internal) < SAME_NOMINAL:
        return ""
    words = f"expected a nominal {spec.over.words} of {size:.4f} mm, from which the limits of {spec.of!r} count"
    return f"{words}, got {stated}; look at teeth, module and profile shift"


def model_from_scene(scene: Scene) -> Model:
    """Model of a scene, with links added by other mechanisms.

    Raises:
        SceneError: gears that cannot be made or run together, with their numbers and key.
    """
    brought = brought_into(scene)
    for gear in (name for name in loose_gears(scene) if name not in brought.owners):
        raise scene.refuse(("parts", gear), f"{gear!r} is used by no move; put it into a mesh or take it out")
    refuse_bearings(scene)
    refuse_second_laws(scene)
    shafts, arms = shafts_of(scene), arms_of(scene)
    meshes, layout = meshes_of_scene(scene, brought)
    refuse_revolving(scene, layout, arms)
    refuse_misfits(scene, meshes, layout)
    trains = trains_of(scene, layout)
    refuse_other_ratios(scene, meshes, layout)
    meshes = tuple(_loaded(scene, mesh, trains, layout, arms) for mesh in meshes)
    by_name = {mesh.name: mesh for mesh in meshes}
    nominal = Nominal(scene, by_name, layout)
    brought, contributors = with_shared_shafts(
        scene,
        brought,
        tuple(
            brought.contributors.get(str(name)) or nominal.contributor(str(name), spec)
            for name, spec in scene.tolerances.items()
        ),
    )
    model = Model(
        name=scene.scene,
        gears=tuple(_gears(scene, by_name, brought)),
        housings=tuple(
            Housing(name, internal(part.expansion))
            for name, part in scene.parts.items()
            if isinstance(part, HousingSpec)
        ),
        contributors=contributors,
        meshes=meshes,
        measures=(),
        profile_steps=scene.options(GearStudyOptions).profile_steps,
        warnings=(*_warnings(meshes), *implausible_teeth(scene, _by_name(meshes)), *brought.warnings),
        shafts=shafts,
        links=_links(scene, brought),
        arms=arms,
        trains=trains,
    )
    measures = tuple(jumping(model, measure_of(scene, name, model)) for name in scene.measures)
    model = replace(model, measures=measures)
    refuse_shared_thrust(scene, model)
    refuse_opposed_loads(scene, model)
    refuse_no_common_face(scene, model)
    idle = (warned(scene.origin, ("tolerances", name), sentence) for name, sentence in idle_slides(model))
    return replace(model, warnings=(*model.warnings, *narrower_faces(model), *idle))


def jumping(model: Model, measure: Measure) -> Measure:
    """The measure; if single teeth deviate it jumps from position to position, as they come into contact."""
    meshes = [model.mesh(backlash.mesh) for _, backlash in measure.kind.backlashes]
    gears = {gear for mesh in meshes for gear in (mesh.driver, mesh.driven)}
    jumps = any(contributor.effect.deviates_teeth(gear) for contributor in model.contributors for gear in gears)
    return replace(measure, positions=replace(measure.positions, jumps=True)) if jumps else measure


def meshes_of_scene(scene: Scene, brought: Brought = NOTHING) -> tuple[tuple[Mesh, ...], Layout]:
    """The meshes of a scene, with their stated flanks, and the layout of its shafts.

    Raises:
        SceneError: gears that cannot be made or run together, or shafts that do not make trees.
    """
    shafts, stated = shafts_of(scene), _links(scene, brought)
    meshes = tuple(_mesh(scene, name, move) for name, move in scene.moves.items() if isinstance(move, GearMeshSpec))
    refuse_no_trees(scene, links_between_shafts(meshes, shafts, stated))
    return meshes, layout_of(meshes, shafts, stated)


def _links(scene: Scene, brought: Brought) -> tuple[StatedLink, ...]:
    """Links that are no meshes, in the order of the moves."""
    order = list(scene.moves)
    found = (*stated_links_of(scene), *(own.link for own in brought.links))
    return tuple(sorted(found, key=lambda link: order.index(link.name)))


def _mesh(scene: Scene, name: str, move: GearMeshSpec) -> Mesh:
    return Mesh(
        name=name,
        driver=move.driver,
        driven=move.driven,
        pair=pair_of(move, name, scene),
        working_flank=LEFT if move.working_flank == "left" else RIGHT,
        housing=getattr(move, "housing", None),
        azimuth=move.azimuth.internal,
    )


def _loaded(scene: Scene, mesh: Mesh, trains: tuple[Train, ...], layout: Layout, arms: tuple[Arm, ...]) -> Mesh:
    """The mesh with the working flank by the load, if the scene states none."""
    move = scene.moves[mesh.name]
    if not isinstance(move, GearMeshSpec) or move.working_flank != "either":
        return mesh
    root = layout.root_of[layout.carrying[mesh.driver][0]]
    own = [train for train in trains if train.driven == root]
    through = [t for t in own if mesh.name in {link.name for link in links_of(layout.load_path(t.driven, t.output))}]
    loading = through or [replace(train, gravity=None) for train in own]  # gravity does not load a branch
    flanks = {loaded_flank(mesh, train, layout, arms): train.name for train in loading}
    if len(flanks) == 2:
        raise scene.refuse(
            ("moves", mesh.name, "working_flank"),
            f"expected right or left, got either: {' and '.join(map(repr, flanks.values()))} load other flanks of it",
        )
    for flank in flanks:
        return replace(mesh, working_flank=flank)
    raise scene.refuse(
        ("moves", mesh.name, "working_flank"),
        f"expected right or left, got either: no train gives the load; add a move of kind train that drives {root!r}",
    )


def _gears(scene: Scene, meshes: dict[str, Mesh], brought: Brought) -> Iterator[GearPart]:
    for name, part in scene.parts.items():
        if isinstance(part, GearSpec) and name not in brought.owners:
            first, *others = meshes_of(name, scene.moves)
            gear = meshes[first].gear(name)
            for other in others:
                if meshes[other].gear(name) != gear:
                    raise _other_shape(scene, name, first, other)
            yield GearPart(name, gear, internal(part.expansion))


def _other_shape(scene: Scene, gear: str, first: str, other: str) -> SceneError:
    """A bevel gear's pitch angle follows from its mate."""
    return scene.refuse(
        ("moves", other),
        f"{gear!r} would need another pitch angle than in {first!r}: a bevel gear can be in several meshes only where "
        "shaft angle and mate are alike",
    )


def _by_name(meshes: tuple[Mesh, ...]) -> Mapping[str, Gear]:
    return {name: mesh.gear(name) for mesh in meshes for name in (mesh.driver, mesh.driven)}


def _warnings(meshes: tuple[Mesh, ...]) -> Iterator[str]:
    for mesh in meshes:
        for name in (mesh.driver, mesh.driven):
            if warning := undercut_warning(mesh.gear(name)):
                yield f"{name}: {warning}"
        if warning := assembly_warning(mesh.pair):
            yield f"{mesh.name}: {warning}"
