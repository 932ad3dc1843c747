"""Phrases that have to be read twice stand in no page, message, table or help text."""

import ast
import re
from collections.abc import Iterator

import pytest
from places import ROOT

PHRASES = (
    "by two independent roads",
    "their difference is taken trial by trial",
    "whatever is neither of second order",
    "has a part in it beyond chance",
    "part in it is above",
    "terms of second order have rms",
    "the most by",
    "more or less",
    "if not given",
    "come along",
    "comes along",
    "brings along",
    "its share out of limits",
    "where all of it is accepted",
    "it takes the place in the room",
    "hang on it",
    "rules that bite",
    "lose touch",
    "loses touch",
    "tip digs",
    "circle digs",
    "do not seat",
    "does not seat",
    "did not seat",
    "that seated",
    "not seated",
    "not built",
    "takes of the power",
    "cut across its gap",
    "at the end that lowers",
    "somebody else found",
    "may run what he likes",
    "one a slot",
    "told in one row",
    "way_out",
)
"""Whole words: both forms of a verb stand here where they occur."""

RENEWED = {"docs/changelog.md": "its lines tell what was there once"}
PATTERN = re.compile("|".join(rf"\b{re.escape(phrase)}\b" for phrase in PHRASES), re.IGNORECASE)


def found_in(text: str) -> list[str]:
    """Phrases in a text, whatever its lines."""
    return [found[0] for found in PATTERN.finditer(" ".join(text.split()))]


def joined(source: str) -> str:
    """A program in small letters, its texts put together: what is not in here is in none of them."""
    return " ".join(re.sub(r'"\s*\n\s*f?"', "", source).lower().split())


def texts_of(source: str) -> Iterator[str]:
    """String literals of a program; what is put into one is left out."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.JoinedStr):
            yield "".join(own.value if isinstance(own, ast.Constant) else "{}" for own in node.values)  # type: ignore[misc]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def test_phrases_are_found_across_lines_and_pieces_of_a_text() -> None:
    assert found_in("at most 2 µm More\n   or less") == ["More or less"]
    assert found_in("a seated part, more or lesser") == []
    (text, *_) = texts_of('said = f"at {x} more " "or less"')
    assert found_in(text) == ["more or less"]


@pytest.mark.parametrize("place", ["docs", "README.md"])
def test_no_page_has_one(place: str) -> None:
    pages = [ROOT / place] if place.endswith(".md") else sorted((ROOT / place).glob("*.md"))
    told = {page.relative_to(ROOT).as_posix(): found_in(page.read_text("utf-8")) for page in pages}
    assert {page: phrases for page, phrases in told.items() if phrases and page not in RENEWED} == {}


def test_no_text_of_the_package_has_one() -> None:
    """Messages, tables, help texts and docstrings."""
    found = []
    for path in sorted((ROOT / "tol3d").rglob("*.py")):
        source = path.read_text("utf-8")
        if any(map(joined(source).__contains__, PHRASES)):
            told = [phrase for text in texts_of(source) for phrase in found_in(text)]
            found += [(path.relative_to(ROOT).as_posix(), phrase) for phrase in told]
    assert found == []
