"""Guides of docs/ against the grammar and the scenes that they quote; test_site.py holds the reference of fields."""

from collections.abc import Sequence
from typing import get_args

import pytest
from guides import first_column, known_words, prose, quoted, words
from places import SCENES
from said_fields import fields_said, fields_within, unsaid

from tol3d import load_scene
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.grammar.zone import LawUnion
from tol3d.assembly.model.datum_frame import Simulator
from tol3d.assembly.model.statuses import WITH_CLEARANCES
from tol3d.gearing.cycloid.mechanism import CYCLOID
from tol3d.gearing.engines import STATUS_TEXT
from tol3d.gearing.planetary.mechanism import PLANETARY
from tol3d.scene.bundled import bundled_scenes
from tol3d.scene.schema import SECTIONS
from tol3d.statistics.samplers.replicates import SamplerKind
from tol3d.study.system.mechanism import Mechanism
from tol3d.units import FACTORS

OTHERS: dict[str, str] = {
    "scene": "no on r1 b3 c2",  # of YAML 1.1; of the scene of many parts
    "results": "status ok interferes ppk_reason limited correlated correlated_of r",
    "gear_pairs": "",
    "trains": "interferes",
    "assemblies": "gauge ok singular overlap view export law_sigmas_um",
    "moves": "",
}
"""Words of the prose of guides that are none of the grammar."""
LAWS = [get_args(law.model_fields["kind"].annotation)[0] for law in get_args(get_args(LawUnion)[0])]


@pytest.mark.parametrize("page", OTHERS)
def test_every_word_of_a_guide_that_looks_like_a_field_is_one(page: str) -> None:
    known = {*known_words(), *(unit for units in FACTORS.values() for unit in units), *bundled_scenes()}
    assert words(prose(page)) - known - set(OTHERS[page].split()) == set()


@pytest.mark.parametrize(
    ("page", "head", "expected"),
    [
        ("assemblies", "simulator", get_args(Simulator)),
        (
            "assemblies",
            "law",
            [get_args(law.model_fields["kind"].annotation)[0] for law in get_args(get_args(LawUnion)[0])],
        ),
        ("assemblies", "status", WITH_CLEARANCES.texts),
        ("moves", "relation", get_args(RelationSpec.model_fields["kind"].annotation)),
        ("results", "status", tuple(STATUS_TEXT.values())),
        ("scene", "section", SECTIONS),
        ("scene", "engine", ("exact", "fcl", "analytic")),
        ("scene", "sampler", get_args(SamplerKind)),
    ],
)
def test_a_table_of_a_guide_has_every_value(page: str, head: str, expected: Sequence[str]) -> None:
    assert first_column(page, head) == set(expected)


QUOTING = [
    (CYCLOID, ("every_cycloid_field", "rv_250aii", "rv_bearing_play", "rv_train"), 6),
    (PLANETARY, ("every_planetary_field", "reducer_3k", "reducer_3k_flexible", "reducer_3k_train"), 5),
]


@pytest.mark.parametrize(("mechanism", "scenes", "count"), QUOTING)
def test_what_a_page_quotes_stands_in_its_scenes(mechanism: Mechanism, scenes: tuple[str, ...], count: int) -> None:
    text = "".join((SCENES / f"{name}.yaml").read_text("utf-8") for name in scenes)
    assert len(quoted(mechanism.name)) == count
    assert [lines for lines in quoted(mechanism.name) if lines not in text] == []


@pytest.mark.parametrize(("mechanism", "scenes", "count"), QUOTING)
def test_the_scenes_of_a_page_use_every_field_of_every_kind(
    mechanism: Mechanism, scenes: tuple[str, ...], count: int
) -> None:
    kinds = [spec for section in SECTIONS for spec in mechanism.specs(section)]
    own = mechanism.starters.partition(":")[0]
    known = {field for spec in kinds for field in fields_within(spec) if field[0].__module__.startswith(own)}
    said = {field for name in scenes for field in fields_said(load_scene(SCENES / f"{name}.yaml"))}
    beside = {"expansion", "description"}  # any part, tolerance or measure may have
    assert {(model.__name__, field) for model, field in unsaid(known, said) if field not in beside} == set()
