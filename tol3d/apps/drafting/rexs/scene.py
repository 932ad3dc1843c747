"""A scene from a REXS file, checked as `tol3d check` does, so that it runs as it is written."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tol3d.apps.drafting.draft import LONGEST, TRIALS, settled
from tol3d.apps.drafting.entry import Entry, Scene
from tol3d.apps.drafting.rexs.assembly import chosen_bearings, measures, moves, nominal, parts, trains_of
from tol3d.apps.drafting.rexs.container import read_document
from tol3d.apps.drafting.rexs.document import RexsError
from tol3d.apps.drafting.rexs.gearbox import NOISE, Gearbox, Stage
from tol3d.apps.drafting.rexs.kinematics import Mounting, drives, mounting
from tol3d.apps.drafting.rexs.limits import tolerances, um
from tol3d.apps.drafting.rexs.named import Named, named, scene_shafts
from tol3d.apps.drafting.rexs.reading import gearbox_of
from tol3d.apps.drafting.words import cleaned, comment, scalar
from tol3d.cad.step import shown
from tol3d.errors import InputError, SceneError
from tol3d.files import FileContent
from tol3d.simulate import Overrides, load_text, simulation_of

SCENE: Final = Path("scene.yaml")
TIGHT: Final = 5e-4  # mm; normal backlash that is told as none
MOST_NOTES: Final = 12  # lines on the screen; all of them are in the scene


@dataclass(frozen=True)
class GearboxDraft:
    """A scene drafted from a gearbox.

    Args:
        file: name of the file.
        gearbox: that it states.
        entries: in the order in which they are written.
        remarks: lines on what is left out or read otherwise.
    """

    file: str
    gearbox: Gearbox
    entries: Sequence[Entry]
    remarks: Sequence[str]

    def scene(self) -> tuple[str, Mapping[int, Entry]]:
        """The text, and by its lines the tolerances, which alone may be written otherwise or left out."""
        text, by_line = Scene(self._head(), "", self.entries, [*self._tail()]).written()
        return text, {line: entry for line, entry in by_line.items() if entry.section == "tolerances"}

    def _head(self) -> list[str]:
        name = cleaned(shown(self.file).partition(".rexs")[0], "/\\:") or "from REXS"
        return [
            f"# Drafted by tol3d new --from {comment(self.file)}; yours to edit. Tolerances behind # are not in the",
            "# file: fill in those that your drawings have. What is left out is listed at the end.",
            f"scene: {scalar(name)}",
            "default_law: {kind: normal, sigmas: 3}  # of limits as the file has them",
        ]

    def _tail(self) -> Iterator[str]:
        yield from ("", f"study: {{trials: {TRIALS}, seed: 1}}", "")
        yield from (f"# {line}" for line in self._told())
        left = self._left_out()
        if left:
            yield "# Left out, or otherwise than in the file:"
            yield from (f"#   {comment(line, LONGEST)}" for line in left)

    def notes(self) -> Iterator[str]:
        """Notes to read before the scene: counts, meshes without backlash, and omissions."""
        yield from self._told()
        left = self._left_out()
        yield from (f"left out: {comment(line, LONGEST)}" for line in left[:MOST_NOTES])
        if left[MOST_NOTES:]:
            yield f"left out: {len(left) - MOST_NOTES} more, see the end of the scene"

    def _told(self) -> Iterator[str]:
        """Counts of tolerances, those that are missing, and what the nominal gears leave."""
        own = [entry for entry in self.entries if entry.section == "tolerances"]
        said = sum(entry.stands and not entry.blank for entry in own)
        asked = [entry.name.strip('"') for entry in own if entry.blank]
        yield f"Tolerances from {comment(self.file)}: {said or 'none, all builds are nominal'}."
        if asked:
            yield f"Not in the file, to fill in: {comment(', '.join(asked), LONGEST)}."
        for stage in self.gearbox.stages:
            backlash = stage.normal_backlash
            if backlash is not None and backlash < TIGHT:
                why = "no backlash" if backlash >= -stage.by_rounding else "teeth that interfere"
                told = f"; {_rounding_words(stage)}" if backlash < -NOISE else ""
                yield f"cylindrical_stage {stage.id} has {why} without tolerances: {nominal(stage)}{told}."

    def _left_out(self) -> list[str]:
        own = [entry for entry in self.entries if entry.section == "tolerances"]
        lines = [*self.remarks]
        for entry in own:
            lines += [f"{entry.label}: {loss}" for loss in entry.losses]
            lines += [f"{entry.label}: {entry.refused}"] if entry.refused else []
            lines += [f"{other.comment}: not drafted beside {entry.wording.comment}" for other in entry.wordings[1:]]
        return lines


def gearbox_scene_from(content: FileContent) -> tuple[str, GearboxDraft]:
    """A scene from a REXS file that `tol3d check` accepts and `tol3d run` runs, and its draft.

    Raises:
        RexsError: the file cannot be read, or states what no scene can have; with the file's name.
    """
    try:
        drafted = gearbox_draft(content)
        return _settled(drafted), drafted
    except InputError as error:
        raise RexsError(f"{content.path}: {error}") from None


def _settled(drafted: GearboxDraft) -> str:
    """The text that a check accepts.

    Raises:
        RexsError: gears, moves or measures are refused; with the tolerances that were left out before.
    """
    try:
        return settled(drafted, _check)
    except SceneError as error:
        problem = error.problems[0]
        place = f"{problem.path}: " if problem.path else ""
        stages = [own for own in drafted.gearbox.stages if (own.normal_backlash or 0.0) < -own.by_rounding]
        tight = "".join(f"; cylindrical_stage {own.id}: {nominal(own)}, {_rounding_words(own)}" for own in stages)
        lost = [f"; left out: {entry.label}: {entry.refused}" for entry in drafted.entries if entry.refused]
        raise RexsError(f"its scene cannot be simulated: {place}{problem.sentence}{tight}{''.join(lost)}") from None


def gearbox_draft(content: FileContent) -> GearboxDraft:
    """A scene from a REXS file, not yet checked.

    Raises:
        RexsError: the file cannot be read.
    """
    gearbox = gearbox_of(read_document(content))
    stages = [*gearbox.stages, *(stage for own in gearbox.sets for stage in own.stages)]
    shafts = scene_shafts(gearbox)
    bearings, others = chosen_bearings(gearbox, shafts)
    names = named(gearbox, shafts, bearings)
    mounted = [(drive, mounting(drive, gearbox)) for drive in drives(gearbox)]
    trains = list(trains_of(mounted, gearbox, names))
    entries = [
        *parts(gearbox, names, _all_places(mounted), bearings, _rounding(stages)),
        *tolerances(gearbox, names, bearings),
        *moves(mounted, trains, names),
        *measures(gearbox, trains, names),
    ]
    remarks = [*gearbox.left_out, *others, *_unsaid(gearbox, names)]
    remarks += [own for _, at in mounted for own in at.remarks]
    return GearboxDraft(content.path.name, gearbox, entries, remarks)


def _all_places(mounted: Sequence[tuple[object, Mounting]]) -> Mounting:
    senses = {part: sense for _, places in mounted for part, sense in places.senses.items()}
    return Mounting({}, senses, ())


def _rounding(stages: Sequence[Stage]) -> dict[int, float]:
    """Profile shift that gears without limits have too much of, where the file's rounding can make teeth interfere.

    Scenes whose nominal teeth interfere, by however little, are refused.
    """
    less = dict[int, float]()
    for stage in stages:
        excess = sum(gear.profile_shift or 0.0 for gear in stage.gears) - (stage.tight_shift or 0.0)
        if -stage.by_rounding <= (stage.normal_backlash or 0.0) < 0.0 and not any(gear.stated for gear in stage.gears):
            less[stage.second.id] = max(excess, less.get(stage.second.id, 0.0))
    return less


def _rounding_words(stage: Stage) -> str:
    """Words on what rounding can do to the backlash of a stage, and on x that is less for it."""
    by = um(float(f"{1e-9 * round(1e9 * stage.by_rounding):.2g}"))
    less = _rounding([stage])
    told = f"rounding of the last digits of x and center_distance can take {by}"
    return f"{told}: x of gear {stage.second.id} is less by {less[stage.second.id]:.2g} in the scene" if less else told


def _unsaid(gearbox: Gearbox, names: Named) -> Iterator[str]:
    """Lines on what the parts of a scene cannot have."""
    drafted = {gear.id for gear in gearbox.single_teeth}
    in_rings = {gear.id: gear for stage in gearbox.stages if stage.ring for gear in stage.gears}
    in_sets = {gear.id: gear for own in gearbox.sets for mesh in own.meshes for gear in mesh}
    for where, gears in (("planetary sets", in_sets), ("meshes with rings", in_rings)):
        for gear in gears.values():
            if gear.classes and gear.id not in drafted:
                grades = ", ".join(map(str, sorted({*gear.classes.values()})))
                yield f"{names.of(gear)}: class {grades} of ISO 1328-1: single teeth of {where} do not deviate"


def _check(text: str) -> None:
    """Raise SceneError if a scene cannot be simulated."""
    simulation_of(load_text(text, SCENE), Overrides())
