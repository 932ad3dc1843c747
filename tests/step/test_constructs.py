"""Single constructs of AP242 that NIST's six models lack, each written as the recommended practices have it."""

import math

import pytest

from tol3d.cad.step import StepText, frame, read_step_text
from tol3d.cad.step.feature import NamedFeature
from tol3d.cad.step.meaning import meanings

BASE = """ISO-10303-21;HEADER;FILE_SCHEMA(('AP242'));ENDSEC;DATA;
#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#2=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#3=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#2))REPRESENTATION_CONTEXT('',''));
#4=PRODUCT('part','part','',());
#5=PRODUCT_DEFINITION_FORMATION('','',#4);
#6=PRODUCT_DEFINITION('','',#5,$);
#7=PRODUCT_DEFINITION_SHAPE('','',#6);
#8=CARTESIAN_POINT('',(1.,2.,3.));
#9=AXIS2_PLACEMENT_3D('',#8,$,$);
#10=PLANE('',#9);
#11=ADVANCED_FACE('top',(),#10,.T.);
#12=CYLINDRICAL_SURFACE('',#9,4.);
#13=ADVANCED_FACE('bore',(),#12,.F.);
#14=ADVANCED_FACE('bore',(),#12,.F.);
#15=CLOSED_SHELL('',(#11,#13,#14));
#16=MANIFOLD_SOLID_BREP('',#15);
#17=SHAPE_REPRESENTATION('',(#16,#9),#3);
#18=SHAPE_DEFINITION_REPRESENTATION(#7,#17);
#21=SHAPE_ASPECT('top face','',#7,.T.);
#22=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#21,#17,#11);
#23=SHAPE_ASPECT('bore','',#7,.T.);
#24=ITEM_IDENTIFIED_REPRESENTATION_USAGE('','',#23,#17,SET_REPRESENTATION_ITEM((#13,#14)));
#31=DATUM_FEATURE('A','',#7,.T.);
#32=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#31,#17,#11);
#33=DATUM('','',#7,.F.,'A');
#34=SHAPE_ASPECT_RELATIONSHIP('','',#31,#33);
#41=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.1),#1);
#42=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.02),#1);
#43=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.),#1);
#44=DATUM_REFERENCE_COMPARTMENT('','',#7,.F.,#33,$);
#45=DATUM_SYSTEM('','',#7,.F.,(#44));
#46=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MICRO.,.METRE.));
#47=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(30.),#46);
"""
WITH_A = "GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#45))"
PROFILE = f"(GEOMETRIC_TOLERANCE('t','',#41,#21){WITH_A}{{}}SURFACE_PROFILE_TOLERANCE(){{}})"
POSITION = f"#100=(GEOMETRIC_TOLERANCE('t','',#41,#23){WITH_A}POSITION_TOLERANCE());"
ZONE = POSITION + "#101=TOLERANCE_ZONE('','',#7,.F.,(#100),#102);#102=TOLERANCE_ZONE_FORM('{}');"


def read(more: str) -> StepText:
    return read_step_text(f"{BASE}{more}\nENDSEC;END-ISO-10303-21;".encode(), "part.stp")


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("#100=" + PROFILE.format("", "UNEQUALLY_DISPOSED_GEOMETRIC_TOLERANCE(#42)") + ";", "⌓ | 0.1 Ⓤ 0.02 | A"),
        ("#100=" + PROFILE.format("GEOMETRIC_TOLERANCE_WITH_MODIFIERS((.FREE_STATE.))", "") + ";", "⌓ | 0.1 Ⓕ | A"),
        ("#100=FLATNESS_TOLERANCE('','',#41,#21);", "▱ | 0.1"),
        ("#100=FLATNESS_TOLERANCE('','',#47,#21);", "▱ | 30"),
        (
            "#100=(FLATNESS_TOLERANCE()GEOMETRIC_TOLERANCE('','',#41,#21)GEOMETRIC_TOLERANCE_WITH_DEFINED_UNIT(#43)"
            "GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT(.SQUARE.,$));",
            "▱ | 0.1 / □25",
        ),
        (
            "#100=(FLATNESS_TOLERANCE()GEOMETRIC_TOLERANCE('','',#41,#21)GEOMETRIC_TOLERANCE_WITH_DEFINED_UNIT(#43)"
            "GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT(.RECTANGULAR.,#42));",
            "▱ | 0.1 / 25×0.02",
        ),
        ("#100=PARALLELISM_TOLERANCE('','',#41,#21,(#45));", "∥ | 0.1 | A"),
        (
            "#100=(GEOMETRIC_TOLERANCE('','',#41,#21)GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#45))"
            "GEOMETRIC_TOLERANCE_WITH_MODIFIERS((.TANGENT_PLANE.))PARALLELISM_TOLERANCE());",
            "∥ | 0.1 Ⓣ | A",
        ),
        (ZONE.format("within a cylinder"), "⌖ | ⌀0.1 | A"),
        (ZONE.format("parallel planes"), "⌖ | 0.1 | A"),
        (
            ZONE.format("spherical") + "#103=NON_UNIFORM_ZONE_DEFINITION(#101,());",
            "⌖ | S⌀0.1 NON-UNIFORM | A",
        ),
        (
            "#100=(GEOMETRIC_TOLERANCE('','',#41,#23)GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#45))"
            "GEOMETRIC_TOLERANCE_WITH_MAXIMUM_TOLERANCE(#42)GEOMETRIC_TOLERANCE_WITH_MODIFIERS((.MAXIMUM_MATERIAL_REQUIREMENT.))"
            "POSITION_TOLERANCE());",
            "⌖ | 0.1 Ⓜ 0.02 MAX | A",
        ),
        (
            "#100=(GEOMETRIC_TOLERANCE('','',#41,#23)GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#102,#101))POSITION_TOLERANCE());"
            "#101=DATUM_REFERENCE(1,#33);#102=REFERENCED_MODIFIED_DATUM(2,#103,.MAXIMUM_MATERIAL_CONDITION.);"
            "#103=DATUM('','',#7,.F.,'B');",
            "⌖ | 0.1 | A | B Ⓜ",
        ),
        (
            "#100=(GEOMETRIC_TOLERANCE('','',#41,#23)GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#101))POSITION_TOLERANCE());"
            "#101=DATUM_SYSTEM('','',#7,.F.,(#102));"
            "#102=DATUM_REFERENCE_COMPARTMENT('','',#7,.F.,#33,(SIMPLE_DATUM_REFERENCE_MODIFIER(.TRANSLATION.),#103));"
            "#103=DATUM_REFERENCE_MODIFIER_WITH_VALUE(.SPHERICAL.,#43);",
            "⌖ | 0.1 | A ▷ spherical 25 mm",
        ),
        ("#100=GEOMETRIC_TOLERANCE('','',#41,#21);", "geometric tolerance without a kind | 0.1"),
    ],
)  # fmt: skip
def test_frames_are_printed(more: str, expected: str) -> None:
    (tolerance,) = read(more).tolerances
    assert frame(tolerance) == expected


def test_micrometres_are_converted() -> None:
    (tolerance,) = read("#100=FLATNESS_TOLERANCE('','',#47,#21);").tolerances
    assert tolerance.magnitude is not None
    assert tolerance.magnitude.value == pytest.approx(0.03)
    assert str(tolerance.magnitude) == "30 um"


def feature(more: str, aspect: int = 100) -> NamedFeature:
    (tolerance,) = read(f"#200=FLATNESS_TOLERANCE('','',#41,#{aspect});{more}").tolerances
    return tolerance.feature


def test_members_that_hold_each_other_end() -> None:
    ring = feature(
        "#100=SHAPE_ASPECT('','',#7,.T.);#101=SHAPE_ASPECT_RELATIONSHIP('','',#100,#102);"
        "#102=SHAPE_ASPECT('','',#7,.T.);#103=SHAPE_ASPECT_RELATIONSHIP('','',#102,#100);"
        "#104=SHAPE_ASPECT_RELATIONSHIP('','',#102,#21);"
    )
    assert ring.faces == (11,)


def test_all_over_and_all_around_are_told_apart() -> None:
    assert feature("#100=ALL_OVER_SHAPE_ASPECT('','',#7,.T.);").around == "all over"
    around = feature("#100=ALL_AROUND_SHAPE_ASPECT('','',#7,.T.);#101=SHAPE_ASPECT_RELATIONSHIP('','',#100,#23);")
    assert (around.around, around.groups) == ("all around", ((13, 14),))
    assert feature("", aspect=7).whole


def test_a_tolerance_of_a_size_is_of_its_feature() -> None:
    assert feature("#100=DIMENSIONAL_SIZE(#23,'diameter');").faces == (13, 14)


@pytest.mark.parametrize("wrong", ["#11", "#41", "#17", "#1"])
def test_a_tolerance_of_no_shape_aspect_is_a_remark(wrong: str) -> None:
    found = read(f"#100=FLATNESS_TOLERANCE('','',#41,{wrong});")
    assert found.tolerances == ()
    assert "expected" in found.remarks[0].why
    assert found.remarks[0].id == 100


def test_a_tolerance_without_a_value_is_read_and_remarked_upon() -> None:
    found = read("#100=FLATNESS_TOLERANCE('','',$,#21);")
    assert [each.why for each in found.remarks if each.id == 100] == ["states no value"]
    assert meanings(found)[0].how == "left out"


def test_an_angle_is_no_magnitude() -> None:
    angle = "#101=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.1),#2);"
    found = read("#100=FLATNESS_TOLERANCE('','',#101,#21);" + angle)
    assert "expected a length, got an angle, 0.1 rad" in found.remarks[0].why
    mixed = read("#100=FLATNESS_TOLERANCE('','',#101,#21);" + angle.replace("#2)", "#1)"))
    assert "expected a measure of the dimension of its unit, mm" in mixed.remarks[0].why


def test_a_unit_that_is_said_by_itself_ends() -> None:
    links = "".join(
        f"#{300 + each}=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),#{401 + each});"
        f"#{400 + each}=(CONVERSION_BASED_UNIT('X',#{300 + each})LENGTH_UNIT()NAMED_UNIT(*));"
        for each in range(9)
    )
    found = read(f"#100=FLATNESS_TOLERANCE('','',#300,#21);{links}#409=SI_UNIT(*,.MILLI.,.METRE.);")
    assert "expected a unit defined by at most 4 others" in found.remarks[0].why


def test_a_datum_may_have_its_faces_itself() -> None:
    found = read("#100=DATUM('','',#7,.F.,'B');#101=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#100,#17,#13);").datum("B")
    assert found is not None
    assert found.faces == (13,)


def test_a_target_takes_the_faces_of_the_feature_that_it_is_on() -> None:
    found = read(
        "#100=DATUM('','',#7,.F.,'B');#101=PLACED_DATUM_TARGET_FEATURE('','circle',#7,.T.,'2');"
        "#102=SHAPE_ASPECT_RELATIONSHIP('','',#101,#100);#103=FEATURE_FOR_DATUM_TARGET_RELATIONSHIP('','',#21,#101);"
        "#104=PROPERTY_DEFINITION('','',#101);#105=SHAPE_DEFINITION_REPRESENTATION(#104,#106);"
        "#106=SHAPE_REPRESENTATION_WITH_PARAMETERS('',(#9,#107),#3);"
        "#107=(LENGTH_MEASURE_WITH_UNIT()MEASURE_REPRESENTATION_ITEM()MEASURE_WITH_UNIT(LENGTH_MEASURE(6.),#1)"
        "REPRESENTATION_ITEM('target diameter'));"
    ).datum("B")
    assert found is not None
    (target,) = found.targets
    assert (target.number, target.kind, target.feature.faces) == ("2", "circle", (11,))
    assert [(each.name, each.value) for each in target.sizes] == [("target diameter", 6.0)]
    assert target.placement is not None
    assert [row[3] for row in target.placement[:3]] == [1.0, 2.0, 3.0]


def dimension(more: str) -> str:
    (found,) = read(f"#200=DIMENSIONAL_CHARACTERISTIC_REPRESENTATION(#100,#201);{more}").dimensions
    return str(found)


def value(identifier: int, number: float, name: str = "nominal value", qualifiers: str = "") -> str:
    return (
        f"#{identifier}=(LENGTH_MEASURE_WITH_UNIT()MEASURE_REPRESENTATION_ITEM()MEASURE_WITH_UNIT(LENGTH_MEASURE({number}),#1)"
        f"{qualifiers}REPRESENTATION_ITEM('{name}'));"
    )


SIZE = "#100=DIMENSIONAL_SIZE(#23,'diameter');#201=SHAPE_DIMENSION_REPRESENTATION('',(#202),#3);"


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (SIZE + value(202, 8.0), "⌀8"),
        (SIZE + "#202=MEASURE_REPRESENTATION_ITEM('nominal value',POSITIVE_LENGTH_MEASURE(8.),#1);", "⌀8"),
        (
            f"{SIZE}{value(202, 8.0)}#203=PLUS_MINUS_TOLERANCE(#204,#100);#204=LIMITS_AND_FITS('H','hole','7','');",
            "⌀8 H7",
        ),
        (
            SIZE
            + value(202, 8.0, qualifiers="QUALIFIED_REPRESENTATION_ITEM((#203))")
            + "#203=TYPE_QUALIFIER('maximum');",
            "⌀8 MAX",
        ),
        (
            "#100=(DIMENSIONAL_SIZE(#23,'')DIMENSIONAL_SIZE_WITH_PATH(#21));"
            "#201=(REPRESENTATION('',(#202),#3)SHAPE_DIMENSION_REPRESENTATION());" + value(202, 8.0),
            "8",
        ),
        (
            "#100=(DIMENSIONAL_LOCATION()DIRECTED_DIMENSIONAL_LOCATION()SHAPE_ASPECT_RELATIONSHIP('','',#21,#23));"
            "#201=SHAPE_DIMENSION_REPRESENTATION('',(#202,#203),#3);"
            f"{value(202, 2.0, 'lower limit')}{value(203, 3.0, 'upper limit')}",
            "2–3",
        ),
    ],
)  # fmt: skip
def test_dimensions_are_printed(more: str, expected: str) -> None:
    assert dimension(more) == expected


def test_an_angle_in_rad_stays() -> None:
    found = read(
        "#100=ANGULAR_LOCATION('','',#21,#23,.SMALL.);#200=DIMENSIONAL_CHARACTERISTIC_REPRESENTATION(#100,#201);"
        "#201=SHAPE_DIMENSION_REPRESENTATION('',(#202),#3);"
        "#202=(MEASURE_REPRESENTATION_ITEM()MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(1.5),#2)PLANE_ANGLE_MEASURE_WITH_UNIT()"
        "REPRESENTATION_ITEM('nominal value'));"
    ).dimensions[0]
    assert (found.kind, str(found)) == ("angle", "1.5 rad")
    assert found.nominal is not None
    assert math.isclose(found.nominal.value, 1.5)


def test_times_in_milliseconds_are_no_coordinates() -> None:
    assert read("#100=VALUE_REPRESENTATION_ITEM('MTIME',NUMERIC_MEASURE(1640078043000.));").tolerances == ()
