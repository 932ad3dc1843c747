"""Tolerances that act not only by their deviations: also by gauges, by inspections, by reducing another zone."""

from dataclasses import replace

from tol3d.assembly.from_scene.contributors import Effects
from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.from_scene.measures import named_by
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.tolerances.location import FormSpec, LocationSpec, OrientationSpec
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec
from tol3d.scene import Scene


def mark_held(scene: Scene, drawing: Drawing, effects: Effects, frames: DatumFrames) -> None:
    """Add to contributors the other effects of their tolerances: gauges, inspections, reduced zones."""
    held: dict[str, str] = {}
    inspected = {
        feature
        for name, names in named_by(scene).items()
        if getattr(scene.measures[name], "modifier", None) is not None
        for feature in names
    }
    gauged = {
        f"{own.part}.{feature}"
        for name, own in frames.made.items()
        for datum in frames.specs[name]
        if datum.gauge is not None
        for feature in datum.features
    }
    for own in drawing.stated:
        if isinstance(own, str):
            continue
        sized = isinstance(own.spec, SizeSpec) and own.spec.limits is None
        if own.feature in gauged and (sized or isinstance(own.spec, LocationSpec | OrientationSpec)):
            held[own.name] = "sizes a gauge of a datum"
        elif own.feature in inspected and sized:
            held[own.name] = "sizes the zone that a measure inspects"
        elif isinstance(own.spec, FormSpec | OrientationSpec) and drawing.of(own.feature, LocationSpec):
            held[own.name] = "narrows another zone"
    for k, each in enumerate(effects.contributors):
        if each.name in held:
            effects.contributors[k] = replace(each, held=held[each.name])
