"""Added kinds as contributing.md describes them, from outside the package: a measure and a zone law of assemblies.

The measure is half of a size; the law puts an axis at one end of x in its zone, or the other.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_texts import written
from toys.registered import known

from tol3d import Overrides, load_scene, open_run, run_scene
from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, FeatureMeasureSpec
from tol3d.assembly.grammar.measures.gap import AngleSpec
from tol3d.assembly.grammar.measures.inspected import InspectedSizeSpec
from tol3d.assembly.grammar.tolerances.location import PositionSpec
from tol3d.assembly.grammar.zone import LawSpec
from tol3d.assembly.mechanism import ASSEMBLY
from tol3d.assembly.model.measures import Measured, Reading
from tol3d.assembly.placing import measuring as placing
from tol3d.assembly.placing.world import World as PlacedWorld
from tol3d.assembly.torsors import measures as torsors
from tol3d.assembly.torsors.world import World as TorsorWorld
from tol3d.assembly.zones import Confined, Zone, catalogue
from tol3d.assembly.zones.zone import Ratio, UnitLaw
from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.scene.entry import kind_of
from tol3d.scene.place import KeyPath
from tol3d.study.system.mechanism import Mechanism

Array = NDArray[np.float64]


class RadiusSpec(InspectedSizeSpec):
    """Half of a size."""

    reads = Reading("radius", f"{__name__}:half_placed", f"{__name__}:half_displaced", is_linear=True)

    kind: Literal["radius"]  # type: ignore[assignment]


def half_placed(measured: Measured, world: PlacedWorld) -> Array:
    return placing.size(measured, world) / 2


def half_displaced(measured: Measured, world: TorsorWorld) -> Array:
    return torsors.size(measured, world) / 2


class TwoEndsSpec(LawSpec):
    """At either end of x."""

    draws = f"{__name__}:two_ends"

    kind: Literal["two_ends"]


class StrangeSpec(LawSpec):
    """A law without a draw."""

    kind: Literal["strange"]


class TwoEndsPositionSpec(PositionSpec):
    """A position with a law of its own."""

    kind: Literal["two_ends_position"]  # type: ignore[assignment]
    law: TwoEndsSpec  # type: ignore[assignment]


class StrangePositionSpec(PositionSpec):
    """A position with a law that nothing draws."""

    kind: Literal["strange_position"]  # type: ignore[assignment]
    law: StrangeSpec  # type: ignore[assignment]


@dataclass(frozen=True)
class TwoEnds(UnitLaw):
    """Law of a section: x = ±1."""

    uniforms = 1

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw."""
        return np.copysign(1.0, uniforms[0] - 0.5), np.zeros(len(uniforms[0]))

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw."""
        return np.diag([1.0, 0.0])


def two_ends(law: TwoEndsSpec, zone: Zone, files: Files) -> Confined:
    return Confined(catalogue.axis_section(zone.width), TwoEnds(), "two ends")


OWN = Mechanism(
    name="own",
    extends=("assembly",),
    tolerances=(TwoEndsPositionSpec,),
    measures=(RadiusSpec,),
    summary="tol3d.assembly.summary_types:SUMMARY_KINDS",
    presenter=ASSEMBLY.presenter,
)
SCENE = """
scene: kinds of one's own
parts:
  plate:
    kind: solid
    features:
      bore: {kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 4 mm, diameter: 30 mm, hole: true}
      upright: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 4 mm}
tolerances:
  lies: {kind: two_ends_position, of: plate.bore, zone: {diameter: 0.1 mm}, law: {kind: two_ends}}
  size: {kind: size, of: plate.bore, distribution: {kind: uniform, lower: 0 mm, upper: 0.2 mm}}
moves:
  machine: {kind: fix, part: plate}
measures:
  x: {kind: gap, from: plate.upright, to: plate.bore, along: [1, 0, 0]}
  radius: {kind: radius, of: plate.bore}
"""


class WithoutSpec(AngleSpec):
    """A measure that one method cannot read."""

    reads = Reading("without", AngleSpec.reads.placing, "tol3d.assembly.torsors.measures:forgotten")

    kind: Literal["without"]  # type: ignore[assignment]


class UnreadSpec(FeatureMeasureSpec):
    """A measure that no method reads."""

    kind: Literal["unread"]

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return ()


NO_READING = "its reading by torsors: expected `package.module:function`, got '{}', where nothing is"


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Path]:
    path = written(SCENE, tmp_path)
    with known(OWN):
        yield path


def test_a_law_without_a_draw_is_refused_as_it_is_registered() -> None:
    own = Mechanism(name="own", extends=("assembly",), tolerances=(StrangePositionSpec,))
    words = "own.tolerances: strange_position lacks `draws` of the law StrangeSpec, got ''"
    with pytest.raises(InputError, match=f"^{re.escape(words)}$"), known(own):
        pass


@pytest.mark.parametrize(
    ("spec", "lack"),
    [(WithoutSpec, NO_READING.format(WithoutSpec.reads.torsors)), (UnreadSpec, "`reads`, how both methods read it")],
    ids=lambda own: own.__name__ if isinstance(own, type) else "",
)
def test_a_measure_that_a_method_cannot_read_is_refused_as_it_is_registered(
    spec: type[AssemblyMeasureSpec], lack: str
) -> None:
    own = Mechanism(name="own", extends=("assembly",), measures=(spec,))
    with pytest.raises(InputError, match=rf"^own\.measures: {kind_of(spec)} lacks {re.escape(lack)}$"), known(own):
        pass


def test_a_measure_and_a_law_of_one_s_own_run_and_are_read_again(scene: Path, tmp_path: Path) -> None:
    run_scene(load_scene(scene), overrides=Overrides(trials=40), out=tmp_path / "run")
    run = open_run(tmp_path / "run")
    assert set(np.round(run.columns("geometric:x")["geometric:x"], 9)) == {-50.0, 50.0}
    assert run.summary["measures"]["x"]["laws"] == {"lies": "two ends in its zone"}
    radius = run.summary["measures"]["radius"]
    assert (radius["kind"], radius["of"]) == ("radius", ["plate.bore"])
    drawn = run.columns("size [um]")["size [um]"]
    for method in ("geometric", "analytic"):
        assert run.columns(f"{method}:radius")[f"{method}:radius"] == pytest.approx(15_000 + drawn / 2, abs=1e-6)
