"""docs/scene.md against the JSON schema: every table names the fields that there are, and no others."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import pytest
from places import ROOT

from tol3d import Scene
from tol3d.gearing.engines import STATUS_TEXT
from tol3d.gearing.mechanism import GEARING
from tol3d.scene import Grammar
from tol3d.units import FACTORS

DOCS = (ROOT / "docs" / "scene.md").read_text("utf-8")
SCHEMA: Mapping[str, Any] = Grammar((GEARING,)).scene.model_json_schema()
FAILURES = "Builds that fail, and what ppm means"
KINDS = ("parts", "tolerances", "moves", "measures")

COMMON_TEXT = {
    "parts": "Every part may have",
    "tolerances": "Each has `kind`, `of`, `distribution`",
    "measures": "and besides `kind` and `of` have",
}
"""Where a section says what several kinds have; the paragraph counts for all of its kinds."""


@dataclass(frozen=True)
class Table:
    """A table of the page: the section it stands in, its head, its rows by their first cell's word."""

    section: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, tuple[str, ...]], ...]


def tables() -> Iterator[Table]:
    section, block = "", list[str]()
    for line in [*DOCS.splitlines(), ""]:
        if line.startswith("## "):
            section = line.removeprefix("## ")
        if line.startswith("|"):
            block.append(line)
        elif block:
            cells = [tuple(cell.strip() for cell in row.strip("|").split("|")) for row in block]
            yield Table(section, cells[0], tuple((row[0].strip("`"), row[1:]) for row in cells[2:]))
            block = []


def words(text: str) -> set[str]:
    """What stands between backticks and is one word, such as a field or one of its values."""
    return {word for word in re.findall(r"`([^`]+)`", text) if re.fullmatch(r"[a-z_0-9]+", word)}


def table(section: str, head: str = "kind") -> Table:
    return next(each for each in tables() if each.section == section and each.head[0] == head)


def definition(reference: Mapping[str, Any]) -> Mapping[str, Any]:
    return SCHEMA["$defs"][reference["$ref"].removeprefix("#/$defs/")]


def kinds(section: str) -> dict[str, Mapping[str, Any]]:
    """Definitions of the kinds of a part, tolerance, move or measure, as a scene's schema has them."""
    entries = SCHEMA["properties"][section]["additionalProperties"]
    return {kind: definition({"$ref": ref}) for kind, ref in entries["discriminator"]["mapping"].items()}


def laws() -> dict[str, Mapping[str, Any]]:
    spec = SCHEMA["$defs"]["EccentricitySpec"]["properties"]["distribution"]
    return {kind: definition({"$ref": ref}) for kind, ref in spec["discriminator"]["mapping"].items()}


def vocabulary(node: Any) -> Iterator[str]:
    """Every field and every value from a list that a definition knows, those of what it refers to too."""
    if isinstance(node, dict):
        yield from node.get("properties", ())
        yield from (str(value) for value in (*node.get("enum", ()), *([node["const"]] if "const" in node else [])))
        if "$ref" in node:
            yield from vocabulary(definition(node))
        for value in node.values():
            yield from vocabulary(value)
    elif isinstance(node, list):
        for value in node:
            yield from vocabulary(value)


def common(section: str) -> set[str]:
    """Words of the paragraph that says what all kinds of a section have."""
    start = COMMON_TEXT.get(section)
    if start is None:
        return set()
    paragraph = next(each for each in DOCS.split("\n\n") if start in each)
    return words(paragraph)


def section_kinds() -> list[tuple[str, str]]:
    return [(section, kind) for section in KINDS for kind in kinds(section)]


@pytest.mark.parametrize("section", KINDS)
def test_every_kind_has_a_row_and_every_row_is_a_kind(section: str) -> None:
    assert {kind for kind, _ in table(section.capitalize()).rows} == set(kinds(section))


@pytest.mark.parametrize(("section", "kind"), section_kinds())
def test_a_row_and_what_its_section_says_of_all_name_every_field(section: str, kind: str) -> None:
    cells = next(cells for row, cells in table(section.capitalize()).rows if row == kind)
    fields = set(kinds(section)[kind]["properties"]) - {"kind"}
    assert fields <= words(" ".join(cells)) | common(section)


@pytest.mark.parametrize(("section", "kind"), section_kinds())
def test_a_row_names_no_field_that_the_grammar_does_not_know(section: str, kind: str) -> None:
    cells = next(cells for row, cells in table(section.capitalize()).rows if row == kind)
    known = {*vocabulary(kinds(section)[kind]), *(other for each in KINDS for other in kinds(each))}
    if section == "tolerances":  # of a part, and by what it says of itself
        known |= {field for part in kinds("parts").values() for field in part["properties"]}
    assert words(" ".join(cells)) <= known


def test_the_table_of_distributions_names_the_fields_of_every_law() -> None:
    rows = table("Distributions").rows
    assert {kind for kind, _ in rows} == set(laws())
    for kind, law in laws().items():
        said = words(" ".join(cells[0] for row, cells in rows if row == kind))  # a normal one has two rows
        assert said == set(law["properties"]) - {"kind"}


def test_the_study_and_the_published_columns_are_told_field_by_field() -> None:
    text = DOCS[DOCS.index("## Study and published columns") :]
    study, published = SCHEMA["$defs"]["Study"], SCHEMA["$defs"]["PublishedMeasure"]
    first = next(paragraph for paragraph in text.split("\n\n") if paragraph.startswith("`study` has"))
    assert set(study["properties"]) == words(first) - {"study"} - {"tol3d"}
    last = next(paragraph for paragraph in text.split("\n\n") if paragraph.startswith("`published` holds"))
    quantiles = set(re.findall(r"`(p\d+\.\d+)`", last))
    assert set(published["properties"]) == words(last) - {"published"} | quantiles
    for head, field in (("engine", "engine"), ("sampler", "sampler")):
        values = {row.split("`")[0] for row, _ in table("Study and published columns", head).rows}
        assert values == set(study["properties"][field]["enum"])


def test_the_table_of_units_is_that_of_the_grammar() -> None:
    rows = {what: set(re.findall(r"`([^`]+)`", cells[0])) - {"µm"} for what, cells in table("Units", "what").rows}
    names = {"length": "length", "angle": "angle", "temperature": "temperature difference", "expansion": "expansion"}
    for dimension, units in FACTORS.items():
        row = next(row for what, row in rows.items() if what.startswith(names[dimension]))
        assert row == set(units)


def test_the_table_of_what_becomes_of_a_build_has_every_status() -> None:
    assert [status.strip("`") for status, _ in table(FAILURES, "status").rows] == [*STATUS_TEXT.values()]


def test_no_table_is_forgotten() -> None:
    known = {(section.capitalize(), "kind") for section in KINDS}
    known |= {("Distributions", "kind"), ("Units", "what"), (FAILURES, "status")}
    known |= {("Study and published columns", head) for head in ("engine", "sampler")}
    assert {(each.section, each.head[0].strip("`")) for each in tables()} == known


def test_every_word_of_the_page_that_looks_like_a_field_is_one() -> None:
    """Between backticks stand words of the grammar, or of the command line."""
    known = {*vocabulary(SCHEMA), *Scene.model_fields, *(unit for units in FACTORS.values() for unit in units)}
    known |= {kind for section in KINDS for kind in kinds(section)} | set(laws())
    others = {"no", "on", "status", "ok", "interferes", "ppk_by"}  # of YAML 1.1; of a run's columns and summary
    outside_of_code = re.sub(r"^```.*?^```", "", DOCS, flags=re.MULTILINE | re.DOTALL)
    assert words(outside_of_code) - known - others == set()
