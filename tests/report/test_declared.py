"""A column is declared at its field alone: the screen, the page and the file have it, with its unit and form."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from printing import printed

import tol3d
from tol3d.report.declared import declared_table, side_by_side
from tol3d.report.html.blocks import table
from tol3d.report.page import Row
from tol3d.report.table_files import Grid
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows, shown
from tol3d.study.runs.summary.values import Known, Label, Ppm, Section, made


class Slot(Section):
    """A slot of an invented analysis."""

    play: Annotated[Known, Shows("play [{unit}]")]
    out_ppm: Annotated[Ppm | None, Shows("out", "share")]
    seen: Annotated[Known, Shows("seen", ".4g", seldom=True)]
    place: Label

    @shown(Shows("where", "words", behind="play"))
    def where(self) -> str:
        """Its place, as it is said."""
        return f"at {self.place}"


def slots(*seen: float | None) -> list[tuple[str, Slot]]:
    return [
        (f"slot {k}", made(Slot, play=12.34567, out_ppm=2700.0, seen=each, place="left")) for k, each in enumerate(seen)
    ]


def test_a_field_with_a_column_is_on_the_screen_in_pages_and_in_files() -> None:
    own = declared_table("", slots(None, 3.0), "um")
    head, _, first, second = printed(own).splitlines()[:4]
    assert head.split() == ["play", "[µm]", "where", "out", "seen"]
    assert first.split() == ["slot", "0", "12.346", "at", "left", "0.27", "%", "–"]
    assert second.split()[-1] == "3"
    assert own.csv().splitlines() == [
        ",play [µm],where,out,seen",
        "slot 0,12.34567,at left,2700.0,",
        "slot 1,12.34567,at left,2700.0,3.0",
    ]
    assert '<td class="number" data-value="12.34567">12.346</td>' in table(own)


def test_what_no_row_knows_has_no_column_where_it_is_seldom() -> None:
    assert [heading.text for heading in declared_table("", slots(None), "um").headings] == ["play [µm]", "where", "out"]
    assert declared_table("", []).headings == []


@dataclass(frozen=True)
class Pin:
    """A pin of an invented mechanism, in mm and rad."""

    diameter: Annotated[float, Shows("⌀", ".3f", "mm", decides=True)]
    play: Annotated[float | None, Shows("play", ".1f", "µm", "least over its length")]
    said: Annotated[Mapping[str, float], Shows("by {key}", "g", given=True)]
    lean: float
    tilt = Computed(Shows("tilt", ".2f", "°", behind="diameter"), lambda own: own.lean)
    remark = Computed(Shows("", "words", seldom=True), lambda own: "askew" if own.lean > 0.1 else None)


PINS = {"left": Pin(12.34567, 0.00123456, {"maker": 12.25}, 0.5), "right": Pin(8.0, None, {}, -1e-9)}


def test_a_field_of_a_dataclass_is_on_the_screen_in_pages_and_in_files() -> None:
    own = declared_table("pin", PINS.items())
    head, _, left, right = printed(own).splitlines()[:4]
    assert re.split(r"\s{2,}", head.strip()) == ["pin", "⌀ [mm]", "tilt [°]", "play [µm]", "by maker"]
    assert left.split() == ["left", "12.346", "28.65", "1.2", "12.25", "askew"]
    assert right.split() == ["right", "8.000", "0.00", "–", "–", "–"]
    assert own.csv().splitlines()[:2] == [
        "pin,⌀ [mm],tilt [°],play [µm],by maker,",
        "left,12.34567,28.64788975654116,1.23456,12.25,askew",
    ]
    assert Grid.of("pins", own).rows[1] == ("right", 8.0, PINS["right"].tilt * (180 / math.pi), None, None, "–")
    assert [heading.style for heading in own.headings] == ["bold", "", "", "green", ""]
    assert '<th scope="col" class="number" title="least over its length">play [µm]</th>' in table(own)
    assert '<td class="number" data-value="1.23456">1.2</td>' in table(own)


def test_rows_keep_the_style_and_the_unit_that_they_come_with() -> None:
    own = declared_table("", [(Row("left", (), "red", "mm"), PINS["left"])])
    assert (own.rows[0].style, own.rows[0].unit) == ("red", "mm")
    assert own.csv().splitlines()[0].startswith(",unit,⌀ [mm]")


@dataclass(frozen=True)
class Bore:
    """A bore, which has what a pin has not."""

    diameter: Annotated[float, Shows("⌀", ".3f", "mm", decides=True)]
    depth: Annotated[float, Shows("deep", ".3g", "mm")]


def test_fields_are_rows_where_objects_stand_side_by_side() -> None:
    own = side_by_side("[mm]", [*PINS.items(), ("bore", Bore(12.5, 30.0))])
    assert [heading.text for heading in own.headings] == ["left", "right", "bore"]
    told = {row.label: [*map(str, row.cells)] for row in own.rows}
    assert told["⌀ [mm]"] == ["12.346", "8.000", "12.500"]
    assert told["deep [mm]"] == ["–", "–", "30"]
    assert own.rows[0].style == "bold"


class Thing(RowOf[str]):
    """A thing by its name."""

    letters = Computed(Shows("letters", "d"), lambda own: len(own.of))
    initial = Computed(Shows("initial"), lambda own: own.of[0])


class Longer(Thing):
    """A thing whose letters count twice."""

    letters = Computed(Shows("twice the letters", "d"), lambda own: 2 * len(own.of))


def test_a_column_that_a_class_declares_anew_stands_where_it_stood() -> None:
    assert declared_table("", [("one", Longer("bolt"))]).csv().splitlines() == [",twice the letters,initial", "one,8,b"]


class Described(Section):
    """A slot whose column says what it means."""

    play: Annotated[Known, Shows("play", meaning="least over its length")]


def test_a_column_of_a_section_is_in_its_json_and_its_meaning_in_the_schema() -> None:
    assert Described(play=1.5).model_dump() == {"play": 1.5}
    assert Described.model_json_schema()["properties"]["play"]["description"] == "least over its length"


MADE_BY_HAND = 7
"""Calls of `Heading(` outside the engine; the number may only fall."""


def test_no_new_table_is_made_by_hand() -> None:
    engine = {"report/page.py", "report/declared.py"}
    root = Path(tol3d.__file__).parent
    texts = (own.read_text("utf-8") for own in root.rglob("*.py") if own.relative_to(root).as_posix() not in engine)
    assert sum(text.count("Heading(") for text in texts) <= MADE_BY_HAND, "declare the columns of a new table"
