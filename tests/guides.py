"""Pages of docs/ that explain scenes: their words, tables and quotations, beside the grammar."""

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

from places import ROOT

from tol3d.kinds import all_kinds


@cache
def text_of(page: str) -> str:
    """The text of a page, by its name."""
    return (ROOT / "docs" / f"{page}.md").read_text("utf-8")


def quoted(page: str) -> list[str]:
    """YAML that a page shows."""
    return re.findall(r"```yaml\n(.*?)```", text_of(page), re.DOTALL)


def prose(page: str) -> str:
    """A page without its fences."""
    return re.sub(r"^```.*?^```", "", text_of(page), flags=re.MULTILINE | re.DOTALL)


def words(text: str) -> set[str]:
    """Texts between backticks that are one word, such as a field or one of its values."""
    return {word for word in re.findall(r"`([^`]+)`", text) if re.fullmatch(r"[a-z_0-9]+", word)}


def first_column(page: str, head: str) -> set[str]:
    """Words between backticks in the first column of the table with that head."""
    _, _, rows = text_of(page).partition(f"\n| {head} |")
    cells = [row.split("|")[1] for row in rows.partition("\n\n")[0].splitlines()[2:]]
    return {word for cell in cells for word in re.findall(r"`([^`]+)`", cell)}


@cache
def known_words() -> frozenset[str]:
    """Every section, kind, field and value from a list that the grammar of all kinds knows."""

    def within(node: Any) -> Iterator[str]:
        if isinstance(node, dict):
            yield from node.get("properties", ())
            yield from (str(value) for value in (*node.get("enum", ()), *([node["const"]] if "const" in node else [])))
        for value in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
            yield from within(value)

    return frozenset(within(all_kinds().scene.model_json_schema()))
