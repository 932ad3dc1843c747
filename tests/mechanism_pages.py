"""The pages of docs/ that list the kinds of a mechanism."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from kinds_page import KindsPage, row_of
from places import ROOT

from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, TimedSpec
from tol3d.assembly.mechanism import ASSEMBLY
from tol3d.gearing.cycloid.mechanism import CYCLOID
from tol3d.gearing.mechanism import GEARING
from tol3d.gearing.planetary.mechanism import PLANETARY
from tol3d.scene import Grammar
from tol3d.study.system.mechanism import Mechanism


@dataclass(frozen=True)
class MechanismPage:
    """A page of docs/.

    Args:
        name: of its file.
        mechanism: whose kinds it lists.
        common: see KindsPage.
        scenes: that use every field between them, and that it quotes.
        quotes: how many times.
        beside: words of its sections of kinds that are kinds of another mechanism.
    """

    name: str
    mechanism: Mechanism
    common: Mapping[str, Sequence[str]]
    scenes: tuple[str, ...] = ()
    quotes: int = 0
    beside: frozenset[str] = frozenset()

    @cached_property
    def kinds(self) -> KindsPage:
        """Its tables, and the schema of scenes of this mechanism."""
        schema = Grammar((self.mechanism,)).scene.model_json_schema()
        return KindsPage(self.path.read_text("utf-8"), schema, self.common)

    @property
    def path(self) -> Path:
        """Path of the page."""
        return ROOT / "docs" / f"{self.name}.md"

    @property
    def quoted(self) -> list[str]:
        """Quotations from scenes."""
        return re.findall(r"```yaml\n(.*?)```", self.kinds.text, re.DOTALL)


SCENE = MechanismPage(
    "scene",
    GEARING,
    {
        "parts": ["Every part may have"],
        "tolerances": ["Each has `kind`, `of`, `distribution`"],
        "measures": ["Each has `kind` and `of`, and may have"],
    },
)
ASSEMBLIES = MechanismPage(
    "assemblies",
    ASSEMBLY,
    {
        "tolerances": ["Each has `kind` and, optionally, `description`"],
        "moves": ["A pair has `from`"],
        "measures": ["Each has `kind` and may have `lower_limit`"],
    },
)
CYCLOIDS = MechanismPage(
    "cycloid",
    CYCLOID,
    {
        "parts": ["Every part may have"],
        "tolerances": ["Beside `kind`, each has"],
        "measures": ["The first two are angles of the output, the last"],
    },
    ("every_cycloid_field", "rv_250aii", "rv_bearing_play", "rv_train"),
    quotes=6,
    beside=frozenset({"tooth_thickness", "eccentricity"}),
)
PLANETARIES = MechanismPage(
    "planetary",
    PLANETARY,
    {
        "parts": ["Every part may have"],
        "tolerances": ["Beside `kind`, each has"],
        "measures": ["All are angles, and besides"],
    },
    ("every_planetary_field", "reducer_3k", "reducer_3k_flexible", "reducer_3k_train"),
    quotes=5,
    beside=frozenset({"tooth_thickness", "eccentricity", "clocking"}),
)


def measure_rows() -> str:
    """The rows of docs/assemblies.md that list the kinds of measures: of every class its own, in the order of files."""
    of_all = set(AssemblyMeasureSpec.model_fields) | set(TimedSpec.model_fields)
    dimensions = {spec: spec.dimension if hasattr(spec, "reads") else "as both" for spec in ASSEMBLY.measures}
    return "\n".join(row_of(spec, dimension, of_all) for spec, dimension in dimensions.items())


def written(text: str) -> str:
    """The page with these rows in the place of those that it has."""
    head, rows, rest = re.split(r"(?<=\| what is read \|\n\|---\|---\|---\|---\|\n)((?:\|.*\n)*)", text, maxsplit=1)
    return f"{head}{measure_rows()}\n{rest}" if rows else text


if __name__ == "__main__":  # python tests/mechanism_pages.py: the page anew
    ASSEMBLIES.path.write_text(written(ASSEMBLIES.path.read_text("utf-8")), "utf-8")
