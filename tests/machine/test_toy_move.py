"""A move that another package brings: it places a part among others, with gears and a housing in the same scene."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
from machine.housed import BACKLASH, FOUR_BORES, GEARS, LAID, SHAFTS, housed_scene
from scene_texts import written

from tol3d import Overrides, SceneError, load_scene, run_scene
from tol3d.assembly.from_scene.setting import Setting
from tol3d.assembly.grammar.feature_name import FeatureName, part_of
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.model import Acts, Move
from tol3d.assembly.model.statuses import NO_CONTACT, OK
from tol3d.assembly.placing.placer import Placer
from tol3d.assembly.placing.poses import Pose
from tol3d.kinds import all_kinds
from tol3d.scene import Grammar, Scene
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions import StatedDistribution
from tol3d.study.system.draw import Scalar
from tol3d.study.system.mechanism import Mechanism
from tol3d.study.system.plain import PlainContributor

RUNS_OUT = 0.04
"""mm; the screw is no longer than that."""


RAISES = Acts("together", "carried by", f"{__name__}:raising", f"{__name__}:raised")


@dataclass(frozen=True, eq=False)
class Jack(Move):
    """A part on a screw that stands on a plane, raised along its normal."""

    acts: ClassVar[Acts] = RAISES

    part: str
    foot: str
    plane: str
    column: int

    @property
    def parts(self) -> tuple[str, ...]:
        return (self.part,)

    @property
    def carriers(self) -> tuple[str, ...]:
        return (part_of(self.plane),)

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return [(self.foot, self.plane)]


@dataclass(frozen=True, eq=False)
class Raising(Placer):
    move: Jack

    def placed(self, world: Any) -> Any:
        """As it lies nominally, risen along the plane's normal of the trial."""
        move, height = self.move, world.columns[self.move.column]
        own = Pose.of(world.assembly.part[move.part].pose)
        codes = np.where(height > RUNS_OUT, NO_CONTACT, OK).astype(np.int8)
        raised = height * world.placed(move.plane).direction
        return world.with_part_at(move.part, Pose(own.turn, own.shift + raised)), codes


def raising(move: Jack, nominal: Any) -> Raising:
    return Raising(move)


def raised(move: Jack, world: Any) -> Any:
    torsor = world.columns.zeros(6)
    torsor[:3, move.column] = world.axis(move.plane)
    return world.with_part_at(move.part, torsor)


class JackSpec(AssemblyMoveSpec):
    """A part on a jack."""

    acts = RAISES
    stated_by = f"{__name__}:jack_of"
    drawn_by = f"{__name__}:height_of"

    kind: Literal["jack"]
    part: Name
    foot: FeatureName
    on: FeatureName
    height: StatedDistribution

    @property
    def parts_placed(self) -> Sequence[tuple[KeyPath, str]]:
        return [(("part",), self.part)]

    def targets(self) -> Iterator[tuple[KeyPath, str]]:
        yield ("on",), self.on


def height_of(spec: JackSpec, name: str, scene: Scene) -> Sequence[PlainContributor]:
    return [PlainContributor(f"height of {name}", "jack", Scalar(spec.height.resolve(scene.files)))]


def jack_of(spec: JackSpec, name: str, setting: Setting) -> Jack:
    return Jack(name, spec.part, spec.foot, spec.on, setting.drawn[f"height of {name}"].start)


TOY = Mechanism(name="jacks", moves=(JackSpec,), extends=("assembly", "machine"))
KINDS = Grammar((*all_kinds().vocabularies, TOY))
PARTS = """
  table:
    kind: solid
    placed: {at: [0 mm, 0 mm, 60 mm]}
    features: {foot: {kind: point, at: [0 mm, 0 mm, -20 mm]}, top: {kind: point, at: [0 mm, 0 mm, 5 mm]}}"""
LIFTED = """
  lifted:
    kind: jack
    part: table
    foot: table.foot
    on: housing.lid
    height: {kind: uniform, lower: -20 um, upper: 50 um}"""
LID = "\n      lid: {kind: plane, at: [0 mm, 0 mm, 40 mm], normal: [0, 0, 1], extent: [200 mm, 100 mm]}"
READ = "\n  table up: {kind: gap, from: housing.floor, to: table.top, along: [0, 0, 1]}"
TOLERANCES = (
    "\n  thick: {kind: tooth_thickness, of: pinion, distribution: {kind: normal, lower: -60 um, upper: -30 um}}"
)


def test_a_toy_move_stands_beside_gears_in_a_housing(tmp_path: Path) -> None:
    text = housed_scene(
        tolerances=TOLERANCES,
        features=FOUR_BORES + LID,
        parts=SHAFTS + GEARS + PARTS,
        moves=LIFTED + LAID,
        measures=BACKLASH + READ,
    )
    place = written(text, tmp_path)
    scene = load_scene(place, KINDS)
    run = run_scene(scene, overrides=Overrides(trials=1000), out=tmp_path / "run", kinds=KINDS)
    own = run.summary["measures"]["table up"]
    count = own["status"]["no contact"]
    assert count == pytest.approx(1000 * 10 / 70, abs=4 * np.sqrt(1000 * 10 / 70 * 60 / 70))
    assert own["geometric"]["mean"] == pytest.approx(105e3 + 10.0, abs=4 * 60 / np.sqrt(12 * 1000))
    assert own["agreement"]["explanation"]["faults"] == []
    assert [each["name"] for each in own["contributors"]] == ["height of lifted"]
    assert run.summary["measures"]["backlash"]["status"]["ok"] == 1000


def test_a_toy_move_before_what_it_stands_on_is_refused(tmp_path: Path) -> None:
    place = tmp_path / "scene.yaml"
    later = f"{LIFTED}\n  base: {{kind: fix, part: housing}}"
    own = housed_scene(tolerances=" {}", features=LID, parts=PARTS, moves=later, measures=READ, fixed="")
    place.write_text(own.replace("housing.floor", "housing.lid"), "utf-8")
    with pytest.raises(SceneError) as refused:
        load_scene(place, KINDS)
    words = "expected a feature of a part that is placed already, got 'housing.lid'; put the move that places 'housing'"
    assert f"moves.lifted.on: {words} before this one" in str(refused.value)
