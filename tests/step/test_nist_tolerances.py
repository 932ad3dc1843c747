"""All 130 tolerances of six NIST models against expressions over the raw text, and NIST's own frames."""

import re
from itertools import chain
from typing import Any

import pytest
from nist import FILES, bodies, references, starting, step_text

from tol3d.cad.step import Tolerance, frame

COUNTS = {"CTC-01": 6, "FTC-07": 27, "FTC-10": 40, "STC-06": 25, "STC-07": 22, "CTC-05": 10}
DATUMS = {"CTC-01": 3, "FTC-07": 5, "FTC-10": 11, "STC-06": 6, "STC-07": 5, "CTC-05": 4}
SIGNS = {
    "STRAIGHTNESS": "⏤", "FLATNESS": "▱", "ROUNDNESS": "○", "CYLINDRICITY": "⌭", "SURFACE_PROFILE": "⌓",
    "PERPENDICULARITY": "⊥", "PARALLELISM": "∥", "POSITION": "⌖", "CONCENTRICITY": "◎", "SYMMETRY": "⌯",
    "CIRCULAR_RUNOUT": "↗", "TOTAL_RUNOUT": "⌰",
}  # fmt: skip
MARKS = {"MAXIMUM_MATERIAL_REQUIREMENT": "Ⓜ", "LEAST_MATERIAL_REQUIREMENT": "Ⓛ", "STATISTICAL_TOLERANCE": "⟨ST⟩"}
MODELS = tuple(FILES)


def targets_of(model: str, letter: str) -> Any:
    """Targets of a datum of that letter, which there is."""
    datum = step_text(model).datum(letter)
    assert datum is not None
    return datum.targets


def crude_number(model: str, identifier: int) -> str:
    """The number of a measure as written, without its point at the end."""
    (found,) = re.findall(r"MEASURE[(]([^()]+)[)]", bodies(model)[identifier])[:1]
    return f"{float(found):.9g}"


def crude_factor(model: str, identifier: int) -> float:
    """One of a measure's unit in mm."""
    body = bodies(model)[references(bodies(model)[identifier])[0]]
    if "'INCH'" in body.upper():
        return 25.4
    assert ".MILLI.,.METRE." in body
    return 1.0


def crude_datum(model: str, body: str) -> str:
    """A datum of a frame: the first reference to a datum, whose last string is its letter."""
    datum = next(each for each in references(body) if "DATUM(" in bodies(model)[each][:6])
    letter: str = re.findall(r"'([^']*)'", bodies(model)[datum])[-1]
    return letter + "".join(f" {mark}" for word, mark in MARKS.items() if word in body)


def crude_compartment(model: str, identifier: int) -> str:
    body = bodies(model)[identifier]
    common = re.search(r"COMMON_DATUM_LIST\(\(([^()]*)\)\)", body)
    if common:
        return "-".join(crude_datum(model, bodies(model)[each]) for each in references(common.group(1)))
    return crude_datum(model, body)


def crude_frame(model: str, identifier: int) -> str:
    """The frame of a tolerance by expressions over the text."""
    own = bodies(model)[identifier]
    kind = next(word for word in SIGNS if f"{word}_TOLERANCE(" in own)
    general = re.search(r"(?:GEOMETRIC_TOLERANCE|\w+_TOLERANCE)\('[^']*','[^']*',#(\d+),#(\d+)", own)
    assert general is not None
    value = crude_number(model, int(general.group(1)))
    zones = {each: body for each, body in starting(model, r"TOLERANCE_ZONE\(").items() if f"(#{identifier})" in body}
    for zone in zones.values():
        form = bodies(model)[references(zone)[-1]]
        value = ("S⌀" if "'spherical'" in form else "⌀" if "cylind" in form else "") + value
    if "DEFINED_UNIT(" in own:
        unit = re.search(r"DEFINED_UNIT\(#(\d+)\)", own)
        assert unit is not None
        value += f" / {'⌀' if '.CIRCULAR.' in own else ''}{crude_number(model, int(unit.group(1)))}"
    value += "".join(f" {mark}" for word, mark in MARKS.items() if f".{word}." in own)
    projections = [references(body) for body in starting(model, r"PROJECTED_ZONE_DEFINITION\(").values()]
    lengths = {crude_number(model, length) for zone, _, length in projections if zone in zones}
    value += "".join(f" Ⓟ {each}" for each in lengths)
    systems = [each for each in references(own) if "DATUM_SYSTEM(" in bodies(model)[each]]
    listed = [re.search(r"\(([#\d,]+)\)\)$", bodies(model)[each]) for each in systems]
    compartments = [each for found in listed if found for each in references(found.group(1))]
    return " | ".join([SIGNS[kind], value, *(crude_compartment(model, each) for each in compartments)])


def crude_faces(model: str, aspect: int) -> set[int]:
    """All faces that hang on an aspect and on what it relates to, datums aside."""
    all_bodies = bodies(model)
    reached, grown = {aspect}, True
    related = [
        references(body)
        for body in starting(model, r"SHAPE_ASPECT_(DERIVING_)?RELATIONSHIP\(").values()
        if not all_bodies[references(body)[1]].startswith("DATUM(")
    ]
    while grown:
        more = {second for first, second in related if first in reached} - reached
        reached |= more
        grown = bool(more)
    usage = r"(GEOMETRIC_ITEM_SPECIFIC|ITEM_IDENTIFIED_REPRESENTATION)_USAGE\("
    usages = [references(body) for body in starting(model, usage).values()]
    named = chain.from_iterable(items for of, _, *items in usages if of in reached)
    return {each for each in named if all_bodies[each].startswith("ADVANCED_FACE(")}


def crude_feature(model: str, identifier: int) -> int:
    found = re.search(r"TOLERANCE\('[^']*','[^']*',#\d+,#(\d+)", bodies(model)[identifier])
    assert found is not None
    return int(found.group(1))


@pytest.mark.parametrize("model", MODELS)
def test_every_tolerance_of_the_text_is_read_with_its_magnitude(model: str) -> None:
    crude = set(starting(model, r"(\((\w+\(\))?GEOMETRIC_TOLERANCE|[A-Z_]+_TOLERANCE)\('"))
    read = step_text(model).tolerances
    assert {each.id for each in read} == crude
    assert len(read) == COUNTS[model]
    assert all(each.magnitude is not None for each in read)


@pytest.mark.parametrize("model", MODELS)
def test_every_frame_is_that_of_the_text(model: str) -> None:
    read = {each.id: frame(each) for each in step_text(model).tolerances}
    assert read == {each: crude_frame(model, each) for each in read}


@pytest.mark.parametrize("model", MODELS)
def test_every_magnitude_is_converted_by_its_own_unit(model: str) -> None:
    for each in step_text(model).tolerances:
        general = re.search(r"TOLERANCE\('[^']*','[^']*',#(\d+)", bodies(model)[each.id])
        assert general is not None
        assert each.magnitude is not None
        measure = int(general.group(1))
        expected = float(crude_number(model, measure)) * crude_factor(model, measure)
        assert each.magnitude.value == pytest.approx(expected, rel=1e-8)  # the oracle prints 9 digits
        assert each.magnitude.unit.name == {25.4: "in", 1.0: "mm"}[crude_factor(model, measure)]


@pytest.mark.parametrize("model", MODELS)
def test_every_tolerance_names_the_faces_of_the_text(model: str) -> None:
    faces = set(starting(model, r"ADVANCED_FACE\("))
    assert set(step_text(model).faces) == faces
    for each in step_text(model).tolerances:
        assert set(each.feature.faces) == crude_faces(model, crude_feature(model, each.id)), each.name
        assert set(each.feature.faces) <= faces
        assert all(face in step_text(model).structure.product_of_face for face in each.feature.faces)


@pytest.mark.parametrize("model", MODELS)
def test_what_names_no_faces_is_remarked_upon_or_the_whole_part(model: str) -> None:
    remarked = {each.id for each in step_text(model).remarks}
    for each in step_text(model).tolerances:
        assert bool(each.feature.faces) != (each.feature.whole or each.id in remarked)


NIST_FRAMES = {
    "CTC-01": [
        "▱ | 0.2", "⊥ | 1.5 | A", "⌓ | 0.5 | A", "⌓ | 1.25 | A | B | C", "⌖ | 0.75 | A | B | C", "⌖ | 0.75 | A | B | C",
    ],
    "FTC-10": ["⌖ | ⌀0.8 | D | E Ⓜ-F Ⓜ-G Ⓜ", "⌖ | ⌀0.8 Ⓟ 3.2 | D | E | B", "⌖ | ⌀0 Ⓛ | H | K | L", "⏤ | 0.2 / 15"],
    "FTC-07": ["⌖ | ⌀0.023 Ⓟ 0.15 | D | B | C", "▱ | 0.01 / ⌀1", "⌖ | ⌀0.05 ⟨ST⟩ | A | B | C"],
    "STC-06": ["⌖ | S⌀0.025 | D | B | C", "⌖ | ⌀0.02 Ⓜ | F"],
    "CTC-05": ["↗ | 0.035 | A-B", "◎ | ⌀0.03 | A", "⏤ | 0.005"],
}  # fmt: skip


@pytest.mark.parametrize("model", NIST_FRAMES)
def test_frames_that_nist_publishes_are_printed_as_it_does(model: str) -> None:
    read = [frame(each) for each in step_text(model).tolerances]
    for each in NIST_FRAMES[model]:
        assert read.count(each) >= NIST_FRAMES[model].count(each)


def named(model: str, name: str) -> list[Tolerance]:
    return [each for each in step_text(model).tolerances if each.name == name]


def test_the_lower_segment_of_a_composite_frame_names_the_upper_one() -> None:
    upper, lower = named("FTC-10", "Position surfacic profile.4")
    assert (lower.above, lower.relation) == (upper.id, "composite")
    assert upper.above is None
    composite = [sum(each.above is not None for each in step_text(model).tolerances) for model in MODELS]
    crude = [len(starting(model, r"GEOMETRIC_TOLERANCE_RELATIONSHIP\(")) for model in MODELS]
    assert composite == crude == [0, 6, 3, 4, 6, 0]


def test_halves_of_a_hole_are_one_group_of_a_pattern() -> None:
    (bores,) = named("FTC-10", "Position.5")
    assert bores.feature.groups == ((9315, 9274), (9215, 9174), (9415, 9374), (9474, 9515))
    assert bores.feature.pattern


def test_a_centre_that_is_derived_has_the_faces_that_it_is_of() -> None:
    (hole,) = named("STC-07", "Perpendicularity.1")
    assert hole.feature.derived
    assert hole.feature.faces == (6761, 6737)


def test_all_around_is_read() -> None:
    around = {model: [each.name for each in step_text(model).tolerances if each.feature.around] for model in MODELS}
    assert around["CTC-01"] == ["Position surfacic profile.2"]
    assert around["FTC-10"] == ["Position surfacic profile.2", "Perpendicularity.3"]
    assert {each.feature.around for model in MODELS for each in step_text(model).tolerances} == {"", "all around"}


@pytest.mark.parametrize("model", MODELS)
def test_every_datum_has_its_letter_once_and_its_faces(model: str) -> None:
    datums = step_text(model).datums
    letters = [each.letter for each in datums]
    assert len(set(letters)) == len(letters) == DATUMS[model]
    for each in datums:
        features = [
            references(body)[0]
            for body in starting(model, r"SHAPE_ASPECT_RELATIONSHIP\(").values()
            if references(body)[1:] == [each.id]
        ]
        by_target = all("TARGET" in bodies(model)[feature] for feature in features)
        expected = set(chain.from_iterable(
            crude_faces(model, feature) for feature in features if by_target or "TARGET" not in bodies(model)[feature]
        ))  # fmt: skip
        assert set(each.faces) == expected


def test_datum_targets_have_their_place_and_size_in_mm() -> None:
    (target,) = targets_of("CTC-05", "C")
    assert (target.number, target.kind) == ("1", "rectangle")
    assert {each.name: str(each) for each in target.sizes} == {"target width": "1.25 in", "target length": "2 in"}
    origin = references(bodies("CTC-05")[3551])[0]  # the placement that is represented for the target
    at = re.findall(r"[-+]?\d+\.\d*(?:E[-+]\d+)?", bodies("CTC-05")[origin])
    assert [row[3] for row in target.placement[:3]] == pytest.approx([25.4 * float(each) for each in at])


def test_areas_of_datum_targets_name_their_faces() -> None:
    targets = targets_of("FTC-10", "K")
    assert [(each.number, each.kind, each.feature.faces) for each in targets] == [
        ("1", "area", (17450,)),
        ("2", "area", (17481,)),
    ]
