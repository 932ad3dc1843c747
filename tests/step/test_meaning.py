"""Meaning of the 130 tolerances of six NIST models in a scene, against a table made by hand from the frames."""

import csv
from collections import Counter
from dataclasses import replace

import pytest
from nist import FILES, step_text
from places import TESTS

from tol3d.cad.step import frame
from tol3d.cad.step.datum import Compartment
from tol3d.cad.step.feature import NamedFeature
from tol3d.cad.step.meaning import MATERIAL, Meaning, Meanings, meanings, surfaces_of
from tol3d.cad.step.outline import StepText, disagreements, measured
from tol3d.cad.step.surfaces import Surface
from tol3d.cad.step.tolerance import ProjectedZone

with (TESTS / "step" / "expected.csv").open(encoding="utf-8", newline="") as opened:
    ROWS = list(csv.DictReader(opened))


@pytest.mark.parametrize("model", FILES)
def test_every_tolerance_has_the_frame_and_the_class_of_the_table(model: str) -> None:
    text = step_text(model)
    read = [
        (str(own.id), own.name, frame(own), meaning.how, meaning.kind, meaning.why)
        for own, meaning in zip(text.tolerances, meanings(text), strict=True)
    ]
    assert read == [
        tuple(row[each] for each in ("id", "name", "frame", "class", "kind", "remark"))
        for row in ROWS
        if row["model"] == model
    ]


def test_the_classes_add_up_to_the_files() -> None:
    assert Counter(row["class"] for row in ROWS) == {"said": 108, "approximately": 16, "left out": 6}
    found = [each for model in FILES for each in meanings(step_text(model))]
    assert len(found) == 130
    assert all(bool(each.why) == (each.how != "said") for each in found)
    assert all(bool(each.kind) == (each.how != "left out") for each in found)


def changed(model: str, identifier: int, **changes: object) -> Meaning:
    """The meaning of a tolerance in a file in which it is changed."""
    text = step_text(model)
    fields = {name: getattr(text, name) for name in ("file", "structure", "datums", "dimensions", "remarks")}
    tolerances = tuple(
        type(each)(**{**vars(each), **changes}) if each.id == identifier else each for each in text.tolerances
    )
    found = Meanings(StepText(tolerances=tolerances, **fields), surfaces_of(text)).all
    return next(each for each in found if each.tolerance == identifier)


def test_a_zone_of_no_width_is_left_out_with_that_reason() -> None:
    """A zone of 0 is one at MMC or LMC alone, of a feature whose size has limits."""
    bounded = [(model, row) for model in FILES for row in step_text(model).tolerances if {*row.modifiers} & MATERIAL]
    (model, own), sized = bounded[0], 0
    assert own.magnitude is not None
    for value, material, left in (
        (-0.02, (), True),
        (-0.02, own.modifiers, True),
        (0.0, (), True),
        (0.0, own.modifiers, False),
        (0.0, ("least material requirement",), False),
        (1e-5, (), False),
    ):
        magnitude = replace(own.magnitude, written=value)
        found = changed(model, own.id, magnitude=magnitude, modifiers=material)
        told = f"a zone of {magnitude}: expected one wider than 0, or 0 with Ⓜ or Ⓛ" if left else ""
        assert (found.how == "left out", found.why) == (left, told), (value, material)
        sized += not left
    assert sized == 3
    own = next(row for row in step_text("CTC-01").tolerances if row.id == 21)  # of a slot without limits
    assert own.magnitude is not None
    none, material = replace(own.magnitude, written=0.0), ("maximum material requirement",)
    told = "a zone of 0 mm, and without a size that has limits there is no bonus"
    assert changed("CTC-01", 21, magnitude=none, modifiers=material).why == told
    told = "a zone projected by 0 mm: expected a length above 0"
    assert changed("CTC-01", 21, projected=ProjectedZone(none, ())).why == told


def feature(model: str, identifier: int) -> NamedFeature:
    return next(each.feature for each in step_text(model).tolerances if each.id == identifier)


@pytest.mark.parametrize(
    ("kind", "how", "said", "why"),
    [
        ("surface profile", "said", "profile", ""),
        ("circular runout", "said", "circular_run_out", ""),
        ("roundness", "said", "roundness", ""),
        ("perpendicularity", "said", "perpendicularity", ""),
        ("cylindricity", "left out", "", "cylindricity of a cone"),
        ("symmetry", "left out", "", "symmetry of a cone"),
    ],
)
def test_a_cone_has_the_kinds_of_its_axis_and_of_its_surface(kind: str, how: str, said: str, why: str) -> None:
    own = feature("STC-06", 10498)
    surfaces = surfaces_of(step_text("STC-06"))
    cone = next(face for face in own.faces if surfaces[face].kind == "cone")
    found = changed("STC-06", 10498, feature=replace(own, groups=((cone,),)), kind=kind, modifiers=())
    assert (found.how, found.kind, found.why, found.shape) == (how, said, why, "a cone")


def test_a_cone_is_a_datum_regardless_of_size_alone() -> None:
    text, surfaces = step_text("STC-06"), surfaces_of(step_text("STC-06"))
    cone = next(face for face in feature("STC-06", 10498).faces if surfaces[face].kind == "cone")
    first = next(each for each in text.tolerances if each.datums and not each.datums[0].references[0].modifiers)
    letter = first.datums[0].references[0]
    fields = {name: getattr(text, name) for name in ("file", "structure", "tolerances", "dimensions", "remarks")}
    datums = tuple(
        replace(each, features=(replace(each.features[0], groups=((cone,),)),))
        if each.letter == letter.letter
        else each
        for each in text.datums
    )
    found = Meanings(StepText(datums=datums, **fields), surfaces)
    bounded = replace(letter, modifiers=("maximum material requirement",))
    assert found.datum_obstacle(first.datums[0]) == ""
    told = found.datum_obstacle(replace(first.datums[0], references=(bounded,)))
    assert told == f"datum {letter.letter} of a cone at its boundary"


def test_modifiers_without_a_word_are_dropped_aloud() -> None:
    assert changed("FTC-10", 19674, modifiers=("free state",)).why == "the free state is dropped"
    tangent = changed("CTC-01", 56, modifiers=("tangent plane",))
    assert (tangent.how, tangent.why) == ("approximately", "the tangent plane is taken as the face itself")
    assert "separate requirement is dropped" in changed("FTC-10", 19674, modifiers=("separate requirement",)).why


def test_datums_at_their_least_material_boundary_are_said_but_not_at_two_boundaries_together() -> None:
    """Holes B and C of CTC-01; E, F and G of FTC-10 as one datum, two of them at the maximum boundary."""

    def least(model: str, identifier: int, letters: str) -> tuple[Compartment, ...]:
        own = next(each for each in step_text(model).tolerances if each.id == identifier)
        return tuple(
            replace(
                each,
                references=tuple(
                    replace(one, modifiers=("least material requirement",)) if one.letter in letters else one
                    for one in each.references
                ),
            )
            for each in own.datums
        )

    assert changed("CTC-01", 21, datums=least("CTC-01", 21, "BC")).how == "said"
    mixed = changed("FTC-10", 19248, datums=least("FTC-10", 19248, "E"))
    assert (mixed.how, mixed.why) == ("left out", "the common datum E-F-G at different boundaries of its features")


def test_a_bonus_needs_a_size_with_limits() -> None:
    text = step_text("FTC-10")
    holes = next(each for each in meanings(text) if each.tolerance == 19313)
    assert holes.how == "said"
    sizes = tuple(
        each for each in text.dimensions if set(each.features[0].faces) != set(feature("FTC-10", 19313).faces)
    )
    bare = StepText(text.file, text.structure, text.datums, text.tolerances, sizes, ())
    found = next(each for each in meanings(bare) if each.tolerance == 19313)
    assert (found.how, found.why) == ("approximately", "without a size that has limits there is no bonus")


def test_an_orientation_that_does_not_refine_its_location_only_limits() -> None:
    other_zone = changed("FTC-10", 19125, zone="width")
    assert (other_zone.how, other_zone.kind) == ("approximately", "inspected_orientation")
    assert "in a direction that the file does not say" in other_zone.why  # D is square to the hole
    along_a = changed("FTC-07", 14579, kind="parallelism", zone="width")  # along A, within a round position
    assert (along_a.how, along_a.kind) == ("said", "parallelism")
    to_another = next(each for each in step_text("FTC-10").tolerances if each.id == 18842)
    other_datum = changed("FTC-10", 19125, datums=to_another.datums)
    assert "its datums are not the first of #19103" in other_datum.why


def test_a_tolerance_without_a_value_or_a_kind_is_left_out() -> None:
    assert changed("FTC-10", 19125, magnitude=None).why == "the file states no value"
    assert (
        changed("FTC-10", 19125, kind="geometric tolerance without a kind").why
        == "the file states no kind of tolerance"
    )


def test_nominal_sizes_and_distances_are_those_of_the_faces() -> None:
    compared = 0
    for model in FILES:
        text, surfaces = step_text(model), surfaces_of(step_text(model))
        assert list(disagreements(text, surfaces)) == []
        compared += sum(measured(each, surfaces) is not None and each.nominal is not None for each in text.dimensions)
    assert compared == 100


def test_a_wrong_unit_is_remarked_upon() -> None:
    text = step_text("STC-06")
    inches = {
        face: Surface(own.kind, own.at, own.direction, own.radius / 25.4) for face, own in surfaces_of(text).items()
    }
    assert any("is ⌀0.8125 ±0.02 where its faces have 0.8125 mm" in each.why for each in disagreements(text, inches))
