"""Pages of docs/ that list kinds in tables, and the JSON schema that they are held to."""

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from tol3d.scene.entry import Entry, kind_of
from tol3d.scene.schema import SECTIONS

Definition = Mapping[str, Any]


@dataclass(frozen=True)
class Table:
    """A table of a page.

    Args:
        section: in which it stands.
        head: of its columns.
        rows: by their first cell's word.
    """

    section: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, tuple[str, ...]], ...]


def row_of(spec: type[Entry], dimension: str, of_all: Set[str]) -> str:
    """The row of a kind of measure, from its class: word, dimension, fields but those of all, and its docstring."""
    fields = {field.alias or name: field for name, field in spec.model_fields.items() if name not in {"kind", *of_all}}
    needed = [f"`{name}`" for name, field in fields.items() if field.is_required()]
    others = ", ".join(f"`{name}`" for name, field in fields.items() if not field.is_required())
    said = " ".join((spec.__doc__ or "").split()).removesuffix(".")
    cells = (f"`{kind_of(spec)}`", dimension, ", ".join([*needed, *([f"[{others}]"] if others else [])]), said)
    return f"| {' | '.join(cells)} |"


def words(text: str) -> set[str]:
    """Texts between backticks that are one word, such as a field or one of its values."""
    return {word for word in re.findall(r"`([^`]+)`", text) if re.fullmatch(r"[a-z_0-9]+", word)}


@dataclass(frozen=True)
class KindsPage:
    """A page, and the grammar of the kinds that it lists.

    Args:
        text: the page's.
        schema: JSON schema of scenes of these kinds.
        common: where a section says what several kinds have: words of paragraphs, which count for all of its kinds.
    """

    text: str
    schema: Definition
    common: Mapping[str, Sequence[str]]

    @cached_property
    def tables(self) -> tuple[Table, ...]:
        """Every table, in order."""
        return tuple(self._tables())

    def _tables(self) -> Iterator[Table]:
        section, block = "", list[str]()
        for line in [*self.text.splitlines(), ""]:
            if line.startswith("## "):
                section = line.removeprefix("## ")
            if line.startswith("|"):
                block.append(line)
            elif block:
                cells = [tuple(cell.strip() for cell in row.strip("|").split("|")) for row in block]
                yield Table(section, cells[0], tuple((row[0].strip("`"), row[1:]) for row in cells[2:]))
                block = []

    @property
    def prose(self) -> str:
        """Without what stands in fences."""
        return re.sub(r"^```.*?^```", "", self.text, flags=re.MULTILINE | re.DOTALL)

    def table(self, section: str, head: str = "kind") -> Table:
        """The first of a section with a head."""
        return next(each for each in self.tables if each.section == section and each.head[0] == head)

    def row(self, section: str, word: str) -> str:
        """Row of a section's table of kinds for one of them."""
        cells = next(cells for row, cells in self.table(section.capitalize()).rows if row == word)
        return " ".join(cells)

    def definition(self, reference: Definition) -> Definition:
        """Definition that a reference of the schema refers to."""
        found: Definition = self.schema["$defs"][reference["$ref"].removeprefix("#/$defs/")]
        return found

    def mapping(self, union: Definition) -> dict[str, Definition]:
        """Definitions of a union's kinds, by their words."""
        if "$ref" in union:  # of a single kind
            own = self.definition(union)
            return {own["properties"]["kind"]["const"]: own}
        return {kind: self.definition({"$ref": ref}) for kind, ref in union["discriminator"]["mapping"].items()}

    def kinds(self, section: str) -> dict[str, Definition]:
        """Definitions of the kinds of a part, tolerance, move or measure, as a scene's schema has them."""
        return self.mapping(self.schema["properties"][section]["additionalProperties"])

    def vocabulary(self, node: Any) -> Iterator[str]:
        """Every field and every value from a list that a definition knows, those of what it refers to too."""
        if isinstance(node, dict):
            yield from node.get("properties", ())
            yield from (str(value) for value in (*node.get("enum", ()), *([node["const"]] if "const" in node else [])))
            if "$ref" in node:
                yield from self.vocabulary(self.definition(node))
            for value in node.values():
                yield from self.vocabulary(value)
        elif isinstance(node, list):
            for value in node:
                yield from self.vocabulary(value)

    def common_words(self, section: str) -> set[str]:
        """Words of the paragraphs that say what all kinds of a section have."""
        paragraphs = self.text.split("\n\n")
        return {
            word
            for start in self.common.get(section, ())
            for word in words(next(each for each in paragraphs if start in each))
        }

    def unnamed(self, section: str, kind: str) -> set[str]:
        """Fields of a kind that neither its row nor what its section says of all names."""
        fields = set(self.kinds(section)[kind]["properties"]) - {"kind"}
        return fields - words(self.row(section, kind)) - self.common_words(section)

    def strange(self, section: str, kind: str) -> set[str]:
        """Words of a kind's row that are none of its fields and values, nor kinds, nor fields of the part it is of."""
        kinds = {other for each in SECTIONS for other in self.kinds(each)}
        of_parts = {field for part in self.kinds("parts").values() for field in part["properties"]}
        known = set(self.vocabulary(self.kinds(section)[kind])) | kinds
        return words(self.row(section, kind)) - known - (of_parts if section != "parts" else set())
