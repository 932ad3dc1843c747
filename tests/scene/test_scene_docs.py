"""docs/scene.md against the JSON schema: every table names the fields that there are, and no others."""

import re
from collections.abc import Mapping
from typing import Any

from kinds_page import words
from mechanism_pages import SCENE

from tol3d import Scene
from tol3d.gearing.engines import STATUS_TEXT
from tol3d.scene.schema import SECTIONS
from tol3d.units import FACTORS

PAGE = SCENE.kinds
DOCS, SCHEMA = PAGE.text, PAGE.schema
FAILURES = "Builds that fail, and what ppm means"


def laws() -> dict[str, Mapping[str, Any]]:
    return PAGE.mapping(SCHEMA["$defs"]["EccentricitySpec"]["properties"]["distribution"])


def test_the_table_of_distributions_names_the_fields_of_every_law() -> None:
    rows = PAGE.table("Distributions").rows
    assert {kind for kind, _ in rows} == set(laws())
    for kind, law in laws().items():
        said = words(" ".join(cells[0] for row, cells in rows if row == kind))  # a normal one has two rows
        assert said == set(law["properties"]) - {"kind"}


def test_the_study_and_the_published_columns_are_told_field_by_field() -> None:
    text = DOCS[DOCS.index("## Study and published columns") :]
    study, published = SCHEMA["$defs"]["Study"], SCHEMA["$defs"]["PublishedMeasure"]
    first = next(paragraph for paragraph in text.split("\n\n") if paragraph.startswith("`study` has"))
    assert set(study["properties"]) == words(first) - {"study"} - {"tol3d"}
    last = next(paragraph for paragraph in text.split("\n\n") if paragraph.startswith("**Of a measure"))
    inner = ("Share", "Histogram", "Agreement", "Curve", "Spectrum")
    known = set(published["properties"]).union(*(SCHEMA["$defs"][f"Published{own}"]["properties"] for own in inner))
    assert known == words(last) | set(re.findall(r"`(p\d+\.\d+(?:_95)?)`", last))
    for head, field in (("engine", "engine"), ("sampler", "sampler")):
        values = {row.split("`")[0] for row, _ in PAGE.table("Study and published columns", head).rows}
        assert values == set(study["properties"][field]["enum"])


def test_the_table_of_what_is_published_of_the_whole_has_every_key_and_its_fields() -> None:
    rows = PAGE.table("Study and published columns", "key").rows
    column = SCHEMA["$defs"]["PublishedColumn"]["properties"]
    assert {key for row, _ in rows for key in words(f"`{row}`")} == set(column)
    fields: dict[str, tuple[str, ...]] = {
        "joint": ("Joint", "Yield", "Correlation"),
        "trains": ("Train", "Stage", "Ends"),
    }
    fields |= {"study": ("Study",), "timing": ("Timing",)}
    for key, models in fields.items():
        said = words(next(" ".join(cells) for row, cells in rows if row.strip("`") == key))
        assert said == {field for own in models for field in SCHEMA["$defs"][f"Published{own}"]["properties"]}


def test_the_table_of_units_is_that_of_the_grammar() -> None:
    rows = {what: set(re.findall(r"`([^`]+)`", cells[0])) - {"µm"} for what, cells in PAGE.table("Units", "what").rows}
    names = {"length": "length", "angle": "angle", "temperature": "temperature difference", "expansion": "expansion"}
    names |= {"force": "force", "stiffness": "stiffness", "mass": "mass", "count": "count"}
    for dimension, units in FACTORS.items():
        row = next(row for what, row in rows.items() if what.startswith(names[dimension]))
        assert row == set(units)


def test_the_table_of_what_becomes_of_a_build_has_every_status() -> None:
    assert [status.strip("`") for status, _ in PAGE.table(FAILURES, "status").rows] == [*STATUS_TEXT.values()]


def test_no_table_is_forgotten() -> None:
    known = {(section.capitalize(), "kind") for section in SECTIONS}
    known |= {("Distributions", "kind"), ("Units", "what"), (FAILURES, "status")}
    known |= {("Study and published columns", head) for head in ("engine", "sampler", "key")}
    assert {(each.section, each.head[0].strip("`")) for each in PAGE.tables} == known


def test_every_word_of_the_page_that_looks_like_a_field_is_one() -> None:
    """Between backticks stand words of the grammar, or of the command line."""
    known = {*PAGE.vocabulary(SCHEMA), *Scene.model_fields, *(unit for units in FACTORS.values() for unit in units)}
    known |= {kind for section in SECTIONS for kind in PAGE.kinds(section)} | set(laws())
    others = {"no", "on", "status", "ok", "interferes", "ppk_reason"}  # of YAML 1.1; of a run's columns and summary
    others |= {"joint", "limited", "yields", "yield_ppm", "yield_ppm_95", "within"}
    others |= {"like", "pattern", "placed", "r1", "b3", "c2"}  # of assemblies, and of the scene of many parts
    others |= {"correlated", "correlated_of", "r", "r_low_95", "r_high_95"}
    assert words(PAGE.prose) - known - others == set()
