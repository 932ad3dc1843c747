"""Tolerances that act not only by their deviations: also by gauges, by inspections, by reducing another zone."""

from dataclasses import replace

from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.from_scene.effects import Effects
from tol3d.assembly.from_scene.measures import named_by
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.tolerances.location import FormSpec, LocationSpec, OrientationSpec
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec


def with_held(drawing: Drawing, effects: Effects, frames: DatumFrames) -> Effects:
    """Effects whose contributors say what else their tolerances act on: gauges, inspections, reduced zones."""
    scene, held = drawing.scene, dict[str, str]()
    inspected = {
        feature
        for name, names in named_by(scene).items()
        if getattr(scene.measures[name], "modifier", None) is not None
        for feature in names
    }
    gauged = {
        f"{frames.made[name].part}.{feature}"
        for name, datums in frames.specs.items()
        for datum in datums
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
    marked = (replace(own, held=held[own.name]) if own.name in held else own for own in effects.contributors)
    return replace(effects, contributors=tuple(marked))
