"""51 damaged variants of a NIST model: an error of ours in one line, or a reading that tells what is lost."""

import random
import re
from collections.abc import Callable, Iterator

import pytest
from nist import FILES, bodies, starting, step_bytes, step_text

from tol3d.cad.step import StepError, StepText, read_step_text

MODEL = "CTC-01"
SEED = 242


def faces(read: StepText) -> dict[int, tuple[int, ...]]:
    """The faces of everything that names some."""
    tolerances = {each.id: each.feature.faces for each in read.tolerances}
    dimensions = {each.id: tuple(face for side in each.features for face in side.faces) for each in read.dimensions}
    return tolerances | dimensions | {each.id: each.faces for each in read.datums}


def text() -> str:
    return step_bytes(MODEL).decode("latin-1")


def data_span() -> tuple[int, int]:
    return text().index("DATA;") + 5, text().rindex("ENDSEC;")


def with_noise(draw: random.Random) -> bytes:
    """Ten bytes of the data replaced by any others."""
    found = bytearray(step_bytes(MODEL))
    first, last = data_span()
    for _ in range(10):
        found[draw.randrange(first, last)] = draw.randrange(256)
    return bytes(found)


def with_wrong_references(draw: random.Random) -> bytes:
    """Three references led to other instances that are there."""
    places = [each.span() for each in re.finditer(r"(?<=[(,])#\d+", text())]
    found = text()
    for start, end in sorted(draw.sample(places, 3), reverse=True):
        found = f"{found[:start]}#{draw.choice(list(bodies(MODEL)))}{found[end:]}"
    return found.encode("latin-1")


def without_instances(draw: random.Random) -> bytes:
    """One instance fewer among those that hang faces on tolerances."""
    kinds = r"(GEOMETRIC_ITEM_SPECIFIC_USAGE|ITEM_IDENTIFIED_REPRESENTATION_USAGE|SHAPE_ASPECT_RELATIONSHIP)\("
    return without(draw.choice(list(starting(MODEL, kinds))))


def without(identifier: int) -> bytes:
    return re.sub(rf"(?s)(?<=\n)#{identifier}=.*?\);", "", text(), count=1).encode("latin-1")


def cut(draw: random.Random) -> bytes:
    """The file up to anywhere."""
    return step_bytes(MODEL)[: draw.randrange(len(text()))]


def replaced(old: str, new: str) -> Callable[[], bytes]:
    """The file with one text in the place of another that it has."""

    def changed() -> bytes:
        assert old in text()
        return text().replace(old, new, 1).encode("latin-1")

    return changed


BY_HAND: dict[str, Callable[[], bytes]] = {
    "a coordinate 1E300": lambda: re.sub(
        r"(CARTESIAN_POINT\('[^']*',\()[^,]+", r"\g<1>1.E300", text(), count=1
    ).encode(),
    "a coordinate 1E400": lambda: re.sub(
        r"(CARTESIAN_POINT\('[^']*',\()[^,]+", r"\g<1>1.E400", text(), count=1
    ).encode(),
    "200 000 brackets": replaced("#57=FLATNESS_TOLERANCE(", "#57=FLATNESS_TOLERANCE(" + "(" * 200_000),
    "closed brackets": replaced("#57=", "#99999=A(" + "(" * 200_000 + ")" * 200_000 + ");\n#57="),
    "a shell that holds itself": lambda: re.sub(r"#3566=CLOSED_SHELL\('[^']*',\(", r"\g<0>#3566,", text()).encode(),
    "aspects in a ring": replaced("#57=", "#99998=SHAPE_ASPECT_RELATIONSHIP('',$,#235,#235);\n#57="),
    "a unit said by itself": lambda: re.sub(r"(CONVERSION_BASED_UNIT\('[^']*',)#\d+", r"\1#83", text()).encode(
        "latin-1"
    ),
    "a name of 10 kB": replaced("'Position.1'", "'" + "Position # : 1 " * 700 + "'"),
    "control characters in a name": replaced("'Position.1'", r"'\X2\000D000A0000001B\X0\Position.1"[:-11] + "'"),
}

DRAWN = ((with_noise, 12), (with_wrong_references, 12), (without_instances, 12), (cut, 6))


def variants() -> Iterator[tuple[str, Callable[[], bytes]]]:
    draw = random.Random(SEED)
    for damage, count in DRAWN:
        for index in range(count):
            seed = draw.randrange(10**9)
            yield f"{damage.__name__}-{index}", lambda damage=damage, seed=seed: damage(random.Random(seed))  # type: ignore[misc]
    yield from BY_HAND.items()


VARIANTS = dict(variants())


def read_or_refused(data: bytes) -> StepText | str:
    try:
        read = read_step_text(data, "damaged.stp")
        assert read.structure.leaves
        return read
    except StepError as error:
        return str(error)


@pytest.mark.parametrize("name", VARIANTS)
def test_a_damaged_file_is_refused_in_one_line_or_read_with_remarks(name: str) -> None:
    found = read_or_refused(VARIANTS[name]())
    if isinstance(found, str):
        assert found.startswith("damaged.stp")
        assert found.isprintable()
        assert len(found) < 400
        return
    remarked = {each.id for each in found.remarks}
    for tolerance in found.tolerances:
        assert tolerance.feature.faces or tolerance.feature.whole or tolerance.id in remarked
        assert all(face in found.faces for face in tolerance.feature.faces)
    if name.startswith("without_instances") and faces(found) != faces(step_text(MODEL)):
        assert len(found.remarks) > len(step_text(MODEL).remarks)


def test_there_are_51() -> None:
    assert len(VARIANTS) == 51


@pytest.mark.parametrize("identifier", starting(MODEL, "GEOMETRIC_ITEM_SPECIFIC_USAGE|ITEM_IDENTIFIED"))
def test_whatever_loses_a_face_is_remarked_upon_itself(identifier: int) -> None:
    found = read_step_text(without(identifier), "damaged.stp")
    whole, left = faces(step_text(MODEL)), faces(found)
    lost = {each for each in whole if whole[each] != left[each]}
    assert {each.id for each in found.remarks} >= lost


def test_a_long_or_unprintable_name_is_data() -> None:
    for name in ("a name of 10 kB", "control characters in a name"):
        found = read_or_refused(VARIANTS[name]())
        assert isinstance(found, StepText)
        assert len(found.tolerances) == len(step_text(MODEL).tolerances)
        assert next(each.name for each in found.tolerances if each.id == 21) != "Position.1"


@pytest.mark.parametrize("model", FILES)
def test_an_undamaged_file_is_read(model: str) -> None:
    assert step_text(model).structure.leaves
