"""What contributing.md says of adding kinds, done from outside the package: a measure and a zone law of assemblies.

The measure is half of a size; the law puts an axis at one end of x in its zone, or the other.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from toys.registered import known

from tol3d import Overrides, load_scene, open_run, run_scene
from tol3d.assembly.from_scene.zones import drawn_by
from tol3d.assembly.grammar.measures.inspected_size import InspectedSizeSpec
from tol3d.assembly.grammar.tolerances import PositionSpec
from tol3d.assembly.mechanism import ASSEMBLY
from tol3d.assembly.zones import Confined, Zone, catalogue
from tol3d.assembly.zones.domain import Ratio, UnitLaw
from tol3d.files import Files
from tol3d.strict import Strict
from tol3d.system.mechanism import Mechanism

Array = NDArray[np.float64]


class BoreSpec(InspectedSizeSpec):
    """A size by another name."""

    kind: Literal["bore_size"]  # type: ignore[assignment]


class TwoEndsSpec(Strict):
    """At either end of x."""

    kind: Literal["two_ends"]


class StrangeSpec(Strict):
    """A law without a draw."""

    kind: Literal["strange"]


class TwoEndsPositionSpec(PositionSpec):
    """A position with a law of its own."""

    kind: Literal["two_ends_position"]  # type: ignore[assignment]
    law: TwoEndsSpec  # type: ignore[assignment]


@dataclass(frozen=True)
class TwoEnds(UnitLaw):
    """Of a section: x = ±1."""

    uniforms = 1

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw."""
        return np.copysign(1.0, uniforms[0] - 0.5), np.zeros(len(uniforms[0]))

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw."""
        return np.diag([1.0, 0.0])


@drawn_by.register
def _(law: TwoEndsSpec, zone: Zone, files: Files) -> Confined:
    return Confined(catalogue.axis_section(zone.width), TwoEnds(), "two ends")


OWN = Mechanism(
    name="own",
    extends=("assembly",),
    tolerances=(TwoEndsPositionSpec,),
    measures=(BoreSpec,),
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
  diameter: {kind: bore_size, of: plate.bore}
"""


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Path]:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    with known(OWN):
        yield path


def test_a_law_that_nobody_registered_is_named_and_not_drawn_as_uniform() -> None:
    with pytest.raises(TypeError, match="no draw by the law StrangeSpec: register it at drawn_by"):
        drawn_by(StrangeSpec(kind="strange"), catalogue.axis_section(0.1), {})


def test_a_measure_and_a_law_of_one_s_own_run_and_are_read_again(scene: Path, tmp_path: Path) -> None:
    run_scene(load_scene(scene), overrides=Overrides(trials=40), out=tmp_path / "run")
    run = open_run(tmp_path / "run")
    assert set(np.round(run.columns("geometric:x")["geometric:x"], 9)) == {-50.0, 50.0}
    assert run.summary["measures"]["x"]["laws"] == {"lies": "two ends in its zone"}
    diameter = run.summary["measures"]["diameter"]
    assert (diameter["kind"], diameter["of"]) == ("bore_size", ["plate.bore"])
    sizes, drawn = (run.columns(name)[name] for name in ("geometric:diameter", "size [um]"))
    assert sizes == pytest.approx(30_000 + drawn, abs=1e-6)
