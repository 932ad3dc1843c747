"""The reader of ISO 10303-21 text: what it reads, and what it refuses with its place."""

import gzip
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tol3d.cad.step import StepError
from tol3d.cad.step.part21 import Part21, read_part21
from tol3d.cad.step.values import Binary, Enumeration, Missing, Reference, Typed, Value, decoded, read_records

HEADER = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('a','b'),'2;1');\nFILE_NAME('x.stp','',(''),(''),'','','');\n"
SCHEMA = "FILE_SCHEMA(('AP242'));\nENDSEC;\n"


def step(data: str, before: str = "") -> bytes:
    """A file of these instances."""
    return f"{HEADER}{SCHEMA}{before}DATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n".encode("latin-1")


def read(data: str) -> Part21:
    return read_part21(step(data), "x.stp")


def refusal(data: bytes) -> str:
    with pytest.raises(StepError) as caught:
        read_part21(data, "x.stp")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400
    return str(caught.value)


NAMES = st.from_regex(r"[A-Z_][A-Z0-9_]{0,8}", fullmatch=True)
SIMPLE = st.one_of(
    st.integers(1, 10**9).map(Reference),
    st.integers(-(10**11), 10**11),
    st.floats(-1e11, 1e11).map(lambda each: each + 0.0),
    st.text("aZ0 '\\;#)/*ä⌖😀\n\0", max_size=6),
    st.sampled_from(Missing),
    NAMES.map(Enumeration),
    st.text("0123456789ABCDEF", max_size=6).map(Binary),
)
VALUES = st.recursive(
    SIMPLE,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4).map(tuple), st.builds(Typed, NAMES, st.lists(inner, max_size=4).map(tuple))
    ),
    max_leaves=6,
)


def printed(value: Value) -> str:
    """A value as a file has it, strings by control directives."""
    if isinstance(value, Reference):
        return f"#{int(value)}"
    if isinstance(value, float):
        text = repr(value)
        return text if "." in text else text.replace("e", ".e")
    if isinstance(value, int):
        return str(value)
    if isinstance(value, str):
        return (
            "'"
            + "".join(each if each.isalnum() and each.isascii() else f"\\X4\\{ord(each):08X}\\X0\\" for each in value)
            + "'"
        )
    if isinstance(value, Missing):
        return value.value
    if isinstance(value, Enumeration):
        return f".{value.word}."
    if isinstance(value, Binary):
        return f'"{value.digits}"'
    if isinstance(value, Typed):
        return f"{value.keyword}({','.join(printed(each) for each in value.arguments)})"
    return f"({' , '.join(printed(each) for each in value)})"


@given(st.lists(VALUES, max_size=5).map(tuple), NAMES)
def test_what_is_printed_is_read_again(arguments: tuple[Value, ...], keyword: str) -> None:
    simple = Typed(keyword, arguments)
    assert read_records(printed(simple)) == (simple,)
    assert read_records(f"({printed(simple)} /* and */ B(1))") == (simple, Typed("B", (1,)))


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        (r"Position.10", "Position.10"),
        (r"it''s", "it's"),
        (r"\X2\2316\X0\ \X2\00D8\X0\5", "⌖ Ø5"),
        (r"\X4\0001F600\X0\!", "😀!"),
        (r"\X\E4\S\d", "ää"),
        (r"\PA\x", "x"),
        (r"C:\\temp", "C:\\temp"),
        (r"C:\temp", "C:\temp".replace("\t", "\\t")),
        ("over\r\n the end", "over the end"),
        (r"\X2\D83D\X0\ ", "� "),
        (r"\X4\00FFFFFF\X0\ ", "� "),
    ],
)
def test_strings_are_decoded(written: str, expected: str) -> None:
    assert decoded(written) == expected


def test_an_instance_is_found_among_comments_and_line_ends() -> None:
    file = read("/* #9=B(); */ #1 = A ( 'a;b /* no */' , /* ; */ (#2,#2) ) ;\r\n#2=\n(B(1.)C('''',$,*));")
    assert file[1].records == (Typed("A", ("a;b /* no */", (Reference(2), Reference(2)))),)
    assert file[2].needed("C").text(0) == "'"
    assert file[2].keyword == "B+C"
    assert file[2].place == "x.stp:10: #2"
    assert [each.id for each in file.of("C", "A")] == [1, 2]
    assert file.header.schemas == ("AP242",)


def test_sections_of_edition_3_are_gone_over() -> None:
    anchors = "ANCHOR;\n<top>=#1;\n<a;b>=#1;\nENDSEC;\n".replace("a;b", "ab")
    assert 1 in read_part21(step("#1=A();", anchors), "x.stp")
    two = step("#1=A();\nENDSEC;\nDATA('second',('AP242'));\n#2=B(#1);")
    assert [each.id for each in read_part21(two, "x.stp").of("A", "B")] == [1, 2]


def test_text_may_be_utf8_with_a_mark_or_latin1() -> None:
    assert read_part21(b"\xef\xbb\xbf" + step("#1=A('x');"))[1].needed("A").text(0) == "x"
    assert read_part21(step("#1=A('ä');"))[1].needed("A").text(0) == "ä"
    assert read_part21(step("#1=A('x');").replace(b"'x'", "'ä'".encode()))[1].needed("A").text(0) == "ä"


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("0." + "0" * 60 + "25", 0.25e-60),
        ("-" + "1" * 60 + ".E-50", -1.111111111111111e9),
        ("0" * 6000 + "7", 7.0),
        ("2." + "5" * 100_000, 23 / 9),
    ],
)
def test_numbers_have_any_length(written: str, expected: float) -> None:
    """ISO 10303-21, 6.4.2: no limit is stated."""
    assert read(f"#1=A_REPRESENTATION_ITEM({written});")[1].needed("A_REPRESENTATION_ITEM").number(0) == pytest.approx(
        expected, rel=1e-15
    )


def test_an_error_names_its_instance_once() -> None:
    """A reference prints as its number."""
    file = read("#1=A(#2);\n#2=B(x(1));")
    with pytest.raises(StepError, match=r"^x\.stp:9: #2: "):
        file[file[1].needed("A").reference(0)].needed("C")


def test_a_damaged_name_in_the_header_ends_no_file_and_a_damaged_schema_does() -> None:
    """A bracket that closes too early, as a public file of SolidWorks has it after its name was changed by hand."""
    header = (
        "HEADER;FILE_DESCRIPTION(('x'),'1');FILE_NAME('x.step'),'2021',(''),(''),'','','');FILE_SCHEMA(('A'));ENDSEC;"
    )
    text = f"ISO-10303-21;{header}DATA;#1=B();ENDSEC;END-ISO-10303-21;"
    assert read_part21(text.encode(), "x.stp").header.schemas == ("A",)
    with pytest.raises(StepError, match=r"^x.stp:1: in the header: "):
        read_part21(text.replace("(('A'))", "('A'),").encode(), "x.stp")


@pytest.mark.parametrize("entity", ["REPRESENTATION", "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE"])
def test_a_density_and_a_size_may_name_themselves_where_no_shape_does(entity: str) -> None:
    """Open CASCADE 6 lists a density's representation among its own items."""
    assert read(f"#1={entity} ('density',(#1),#2);\n#2=B();")[1].needed(entity).text(0) == "density"
    with pytest.raises(StepError, match="holds itself"):
        read(f"#1=SHAPE_{entity}('density',(#1),#2);\n#2=B();")


PARSED = ("#1=A(1,", "#1=A(1 ", "#1=A(x)", "#1=(1")
"""Damage that is found where an instance is parsed."""


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ("#1=A(#2);", "x.stp:8: #1 refers to #2, which the file does not have"),
        ("#1=A(#2);\n#2=B(#1);", "holds itself (#1 → #2 → #1)"),
        ("#1=A(#1);", "holds itself"),
        ("#1=A();\n#1=B();", "x.stp:9: #1 stands twice, first in line 8"),
        ("#1=A(1.E300);", "expected a number up to 1e+12, got 1.E300"),
        ("#1=A(-1.E400);", "expected a number up to 1e+12"),
        ("#1=A(99999999999999);", "expected a number up to 1e+12"),
        ("#1=A(" + "1" * 5000 + ");", "expected a number up to 1e+12"),
        ("#1=A(" + "1" * 60 + ".E-40);", "expected a number up to 1e+12"),
        ("#1=A(" + "(" * 64 + ")" * 64 + ");", "expected at most 64 brackets in each other"),
        ("#1=A(" + "(" * 200_000 + ")" * 200_000 + ");", "expected at most 64 brackets in each other"),
        ("#1=A(" + "(" * 200_000 + ");", "expected brackets that close"),
        ("#1=A((1);", "x.stp:8: #1: expected brackets that close"),
        ("#1=A(1,,2);", "expected a value, got a comma"),
        ("#1=A(1,);", "expected a value, got )"),
        ("#1=A(1 2);", "expected a comma or ), got 2"),
        ("#1=A)();", "x.stp:8: #1: expected brackets that close"),
        ("#1=A(x);", "expected ( after X, got )"),
        ("#1=A", "expected an instance such as #12=…; or ENDSEC; got END-ISO-10303-21"),
        ("#1=;", "x.stp:8: #1: expected ); at its end"),
        ("#1=A(#2)\n#2=B();", "x.stp:8: #1: expected ); at its end"),
        ("#1=(1,2);", "expected only entities"),
        ("#=A();", "expected an instance such as #12"),
        ("#1=A(&);", "expected no '&' here"),
        ("#1=A(#);", "expected no '#' here"),
        ("#1=A('x);", "cut, or a quote is missing"),
        ("#1=A(\x00);", "expected no '·' here"),
        ("", "expected instances in a DATA section"),
    ],
)
def test_damage_is_refused_with_its_place(data: str, expected: str) -> None:
    if data.startswith(PARSED):
        with pytest.raises(StepError) as caught:
            read_part21(step(data), "x.stp")[1]
        assert expected in str(caught.value)
    else:
        assert expected in refusal(step(data))


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"", "expected a STEP file that begins with ISO-10303-21"),
        (b"\x1f\x8b" + bytes(20), "expected a STEP file"),
        (b"PK\x03\x04", "expected a STEP file"),
        (step("#1=A();").replace(b"END-ISO-10303-21;", b""), "expected the file to end with END-ISO-10303-21"),
        (step("#1=A();")[:-40], "expected the file to end with END-ISO-10303-21"),
        (step("#1=A();").replace(b"FILE_SCHEMA(('AP242'));", b""), "expected FILE_SCHEMA"),
        (step("#1=A();").replace(b"DATA;", b"DATEN;"), "expected a section such as DATA, got DATEN"),
        (step("#1=A();", "REFERENCE;\n#7=<bolt.stp#top>;\nENDSEC;\n"), "refers to another file, #7=<bolt.stp#top>"),
        ("ISO-10303-21;".encode("utf-16"), "expected a STEP file"),
    ],
)
def test_what_is_no_whole_step_file_is_refused(data: bytes, expected: str) -> None:
    assert expected in refusal(data)


def test_a_file_that_cannot_be_opened_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.stp", tmp_path, tmp_path / "x\0.stp"):
        with pytest.raises(StepError, match="cannot be read"):
            read_part21(path)


def test_arguments_are_asked_for_by_their_kind() -> None:
    record = read("#1=A(#1a,'x',2.5,(.FREE_STATE.),LENGTH_MEASURE(3));".replace("#1a", "#2") + "#2=B();")[1].needed("A")
    assert (record.reference(0), record.text(1), record.number(2)) == (2, "x", 2.5)
    assert (record.words(3), record.number(4)) == (("free state",), 3.0)
    for ask, index, expected in (
        (record.reference, 1, "x.stp:8: #1: A, argument 2: expected a reference such as #12, got 'x'"),
        (record.text, 0, "A, argument 1: expected a string, got #2"),
        (record.number, 0, "A, argument 1: expected a number, got #2"),
        (record.references, 1, "expected a list of references"),
        (record.argument, 5, "A: expected at least 6 arguments, got 5"),
    ):
        with pytest.raises(StepError) as caught:
            ask(index)
        assert expected in str(caught.value)


@given(st.binary(max_size=200), st.integers(0, 400))
def test_noise_is_refused_or_read(noise: bytes, at: int) -> None:
    base = step("#1=A('x',(#2,1.5,.T.));\n#2=(B()C($,*));")
    with suppress(StepError):
        file = read_part21(base[:at] + noise + base[at:], "x.stp")
        assert all(file[each].records for each in file.spans)


def test_a_compressed_file_is_to_be_unpacked() -> None:
    with pytest.raises(StepError, match="it is compressed: unpack it first"):
        read_part21(gzip.compress(b"ISO-10303-21;"), "part.stp.gz")
