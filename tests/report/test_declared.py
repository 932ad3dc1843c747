"""A column is declared at its field alone: the screen, the page and the file have it, with its unit and form."""

from typing import Annotated

from printing import printed

from tol3d.report.declared import declared_table
from tol3d.report.html.blocks import table
from tol3d.runs.summary.shows import Shows, shown
from tol3d.runs.summary.values import Known, Label, Ppm, Section, made


class Slot(Section):
    """A slot of an invented analysis."""

    play: Annotated[Known, Shows("play [{unit}]")]
    out_ppm: Annotated[Ppm | None, Shows("out", "share")]
    seen: Annotated[Known, Shows("seen", "short", seldom=True)]
    place: Label

    @shown(Shows("where", "words", words=True, behind="play"))
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
