"""Simulation: a system, its study, and published figures of it.

Lines of a scene that state tolerances, each with the contributors that it makes.

A line holds for each feature of a pattern, for each part that is like its own, and as often as its file is included:
their deviations are drawn each for itself, but they are one tolerance, which is changed as a whole.
"""

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final, Protocol, runtime_checkable

from tol3d.numerics.kept import Itself
from tol3d.scene import Scene
from tol3d.scene.place import Place
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.faults import Origin
from tol3d.study.system.method import ANALYTIC_METHOD, MethodKind
from tol3d.study.system.remembered import Remembered
from tol3d.study.system.system import Published, System
from tol3d.study.trials.study import Study, Until
from tol3d.units import Quantity

TOP: Final = Place(1, 1)


@runtime_checkable
class OfLine(Protocol, metaclass=Remembered):
    """A Contributor that is one of several which a line of the scene makes."""

    @property
    def line(self) -> str:
        """Name of the line, which is its tolerance's or begins with it; "" for the contributor's own name."""
        ...


@dataclass(frozen=True)
class Line:
    """A line that states a tolerance.

    Args:
        name: of the tolerance; of a file that is included several times "thickness of ring.yaml"; of what a move says
            that of its contributor.
        contributors: names of those that it makes.
        entries: names of its tolerances in the scene, one for each time that its file is included; none of a move.
        in_file: name of the tolerance in an included file; "" of the scene's own.
    """

    name: str
    contributors: tuple[str, ...]
    entries: tuple[str, ...] = ()
    in_file: str = ""


def lines_of(scene: Scene, contributors: Iterable[Contributor]) -> tuple[Line, ...]:
    """The lines of a scene, in the order of their first contributors."""
    origin = scene.origin
    tolerances = {name: origin.place(("tolerances", name)) for name in scene.tolerances}
    moves = {name: origin.place(("moves", name)) for name in scene.moves}
    counts = Counter(place for place in (*tolerances.values(), *moves.values()) if place.file)
    files = {str(own.path): name for name, own in origin.files.items()}
    in_files: dict[Place, str] = {}
    found: dict[str, Line] = {}
    for contributor in contributors:
        stated = contributor.line if isinstance(contributor, OfLine) else ""
        line = stated or contributor.name
        entry = line if line in tolerances else _entry(stated, tolerances)
        move = "" if entry else max((name for name in moves if line.endswith(f" of {name}")), key=len, default="")
        name, in_file = entry or move, ""
        place = (tolerances if entry else moves).get(name, TOP)
        if counts[place] > 1:
            file = files[place.file]
            if place not in in_files:
                in_files[place] = _name_in_file(name, place, origin.files[file].content)
            before, _, after = line.partition(name) if entry else line.rpartition(name)
            in_file = f"{before}{in_files[place]}{after}"
            line = f"{in_file} of {file}"
        known = found.get(line, Line(line, ()))
        entries = (*known.entries, *([entry] if entry and entry not in known.entries else []))
        found[line] = Line(line, (*known.contributors, contributor.name), entries, in_file)
    return tuple(found.values())


def _entry(line: str, tolerances: Iterable[str]) -> str:
    """The tolerance whose name a line begins with, the longest of several: of "holes shift" that is "holes"."""
    return max((name for name in tolerances if line.startswith(f"{name} ")), key=len, default="")


def _name_in_file(entry: str, place: Place, content: bytes) -> str:
    """The name that an entry has in its file, which stands at its place: without those of the includes."""
    words, lines = entry.split(" "), content.decode("utf-8", "replace").splitlines()
    text = lines[place.line - 1][place.column - 1 :] if place.line <= len(lines) else ""
    shorter = (" ".join(words[k:]) for k in range(len(words) - 1, 0, -1))
    return next((name for name in shorter if re.match(rf"""["']?{re.escape(name)}["']?\s*:""", text)), entry)


@dataclass(frozen=True)
class Seen:
    """Contributors without a slope that were redrawn in builds of a measure.

    Args:
        builds: their number; 0 where every contributor has a slope.
        names: of those that moved the measure; the others were not seen to act.
    """

    builds: int = 0
    names: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Simulation:
    """Everything that a trial and its statistics need; it pickles.

    Args:
        system: that is built and measured.
        study: settings for it.
        published: columns of others.
        requires: packages, besides those of every study, whose versions decide its results.
        presenter: import path of the system's presenter, see `tol3d.report.presenter`; "" for nothing.
        mechanism: the one that understood the scene; None of a system made without.
        implausible: warnings of its vocabularies on the scene.
        copula: which contributors are correlated.
        lines: of the scene, which state the tolerances; none of a system made without.
        seen: by system, what its measures were seen to depend on; filled at the first question, see acting.py.
    """

    system: System
    study: Study
    published: Published = field(default_factory=dict)
    requires: tuple[str, ...] = ()
    presenter: str = ""
    mechanism: Origin | None = None
    implausible: tuple[str, ...] = ()
    copula: Copula = INDEPENDENT
    lines: tuple[Line, ...] = ()
    seen: dict[Itself, Mapping[str, Seen]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def method(self) -> MethodKind:
        """The method that the study's engine names."""
        return self.system.methods[self.study.engine]

    @property
    def has_geometry(self) -> bool:
        """True if there is a 3D simulation beside the analytic method."""
        return self.study.engine != ANALYTIC_METHOD

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of conditions that may spoil the numbers of this study."""
        return (*self.implausible, *self.system.warnings, *self.study.warnings)


def study_of(scene: Scene) -> Study:
    """The study of a scene; an automatic one is its trials at most, and when it may stop before."""
    spec = scene.study
    return Study(
        trials=spec.at_most if spec.trials == "auto" else spec.trials,
        seed=spec.seed,
        sampler=spec.sampler,
        replicates=spec.parts,
        until=tuple(
            Until(name, _internal(errors.mean), _internal(errors.sigma)) for name, errors in spec.until.items()
        ),
        engine=spec.engine,
        witness=spec.witness,
        ppk_by=spec.ppk_by,
        accept_ppk=None if spec.accept is None else spec.accept.ppk,
        options=scene.grammar.options_of(scene),
    )


def _internal(quantity: Quantity | None) -> float | None:
    return None if quantity is None else quantity.internal
