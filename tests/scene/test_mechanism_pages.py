"""The pages that list the kinds of mechanisms, against the JSON schema and the scenes that they quote."""

import pytest
from kinds_page import words
from mechanism_pages import ASSEMBLIES, CYCLOIDS, PLANETARIES, SCENE, MechanismPage
from places import SCENES
from said_fields import fields_said, fields_within, unsaid

from tol3d import load_scene
from tol3d.scene.schema import SECTIONS

PAGES = [pytest.param(page, id=page.name) for page in (SCENE, ASSEMBLIES, CYCLOIDS, PLANETARIES)]
QUOTING = PAGES[2:]  # parts of scenes; docs/scene.md quotes none, docs/assemblies.md whole ones


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("page", PAGES)
def test_every_kind_has_a_row_and_every_row_is_a_kind(page: MechanismPage, section: str) -> None:
    rows = [kind for kind, _ in page.kinds.table(section.capitalize()).rows]
    assert sorted(rows) == sorted(page.kinds.kinds(section))


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("page", PAGES)
def test_a_row_and_what_its_section_says_of_all_name_every_field(page: MechanismPage, section: str) -> None:
    unnamed = {kind: page.kinds.unnamed(section, kind) for kind in page.kinds.kinds(section)}
    assert unnamed == {kind: set() for kind in unnamed}


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("page", PAGES)
def test_a_row_names_no_field_that_the_grammar_does_not_know(page: MechanismPage, section: str) -> None:
    strange = {kind: page.kinds.strange(section, kind) for kind in page.kinds.kinds(section)}
    assert strange == {kind: set() for kind in strange}


@pytest.mark.parametrize("page", QUOTING)
def test_what_a_page_quotes_stands_in_its_scenes(page: MechanismPage) -> None:
    text = "".join((SCENES / f"{name}.yaml").read_text("utf-8") for name in page.scenes)
    assert len(page.quoted) == page.quotes
    assert [quoted for quoted in page.quoted if quoted not in text] == []


@pytest.mark.parametrize("page", QUOTING)
def test_the_scenes_of_a_page_use_every_field_of_every_kind(page: MechanismPage) -> None:
    kinds = [spec for section in SECTIONS for spec in page.mechanism.specs(section)]
    own = page.mechanism.starters.partition(":")[0]
    known = {field for spec in kinds for field in fields_within(spec) if field[0].__module__.startswith(own)}
    said = {field for name in page.scenes for field in fields_said(load_scene(SCENES / f"{name}.yaml"))}
    beside = {"expansion", "description"}  # any part, tolerance or measure may have
    assert {(model.__name__, field) for model, field in unsaid(known, said) if field not in beside} == set()


@pytest.mark.parametrize("page", QUOTING)
def test_every_word_of_the_sections_of_kinds_is_one_of_the_grammar(page: MechanismPage) -> None:
    kinds = page.kinds.text[page.kinds.text.index("## Parts") :]
    known = {*page.kinds.vocabulary(page.kinds.schema)} | {kind for each in SECTIONS for kind in page.kinds.kinds(each)}
    assert words(kinds) - known - page.beside == set()
