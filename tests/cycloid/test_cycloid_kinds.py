"""docs/cycloid.md against the JSON schema and the scenes that it quotes."""

import re
from collections.abc import Mapping
from typing import Any

import pytest
from kinds_page import KindsPage, words
from places import ROOT, SCENES
from said_fields import fields_said, fields_within, unsaid

from tol3d import load_scene
from tol3d.cycloid.mechanism import CYCLOID
from tol3d.scene import Grammar
from tol3d.scene.schema import SECTIONS

DOCS = (ROOT / "docs" / "cycloid.md").read_text("utf-8")
SCHEMA: Mapping[str, Any] = Grammar((CYCLOID,)).scene.model_json_schema()
COMMON = {
    "parts": ["Every part may have"],
    "tolerances": ["Beside `kind`, each has"],
    "measures": ["All are angles of the output, and besides"],
}
PAGE = KindsPage(DOCS, SCHEMA, COMMON)
QUOTED = re.findall(r"```yaml\n(.*?)```", DOCS, re.DOTALL)
OF_GEARS = {"tooth_thickness", "eccentricity"}
FIELD_SCENES = ("every_cycloid_field", "rv_250aii")


def test_what_the_page_quotes_stands_in_the_scenes() -> None:
    text = "".join((SCENES / f"{name}.yaml").read_text("utf-8") for name in FIELD_SCENES)
    assert len(QUOTED) == 3
    assert all(quoted in text for quoted in QUOTED)


def test_the_scenes_use_every_field_of_every_kind() -> None:
    kinds = [spec for section in SECTIONS for spec in CYCLOID.specs(section)]
    known = {own for spec in kinds for own in fields_within(spec) if own[0].__module__.startswith("tol3d.cycloid")}
    said = {own for name in FIELD_SCENES for own in fields_said(load_scene(SCENES / f"{name}.yaml"))}
    beside = {"expansion", "description"}  # any part, tolerance or measure may have
    assert {(model.__name__, field) for model, field in unsaid(known, said) if field not in beside} == set()


@pytest.mark.parametrize("section", SECTIONS)
def test_every_kind_has_a_row_and_every_row_is_a_kind(section: str) -> None:
    assert {kind for kind, _ in PAGE.table(section.capitalize()).rows} == set(PAGE.kinds(section))


@pytest.mark.parametrize(("section", "kind"), PAGE.section_kinds)
def test_a_row_and_what_its_section_says_of_all_name_every_field(section: str, kind: str) -> None:
    assert PAGE.unnamed(section, kind) == set()


@pytest.mark.parametrize(("section", "kind"), PAGE.section_kinds)
def test_a_row_names_no_field_that_the_grammar_does_not_know(section: str, kind: str) -> None:
    assert PAGE.strange(section, kind) == set()


def test_every_word_of_the_sections_of_kinds_is_one_of_the_grammar() -> None:
    kinds = DOCS[DOCS.index("## Parts") :]
    known = {*PAGE.vocabulary(SCHEMA)} | {kind for section in SECTIONS for kind in PAGE.kinds(section)}
    assert words(kinds) - known - OF_GEARS == set()
