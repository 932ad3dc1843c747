"""Pages as HTML: the same lines and tables as on a terminal, and no second list of numbers.

A run as a notebook shows it: which one it is, its verdict, and how its trials ended.

Elements of HTML and SVG as text, with names of a scene escaped.
"""

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Final

from tol3d.report.page import TITLE, Branch, Heading, Line, Page, PageItem, Row, Shown, Table
from tol3d.report.table import Detail, run_report, status_line
from tol3d.study.runs.run import Run


def run_html(run: Run) -> str:
    """A finished run."""
    found = run.found
    words = f"{run.trials} trials · seed {found.seed} · engine {found.engine} · {run.path}"
    blocks = [*run_report(found, Detail.VERDICT).blocks, status_line(found)]
    return str(together(tag("p", tag("b", found.scene), f" · {words}"), page_blocks(blocks)))


UNSAFE: Final = frozenset(("Cc", "Cf", "Cs", "Zl", "Zp"))
"""Unicode categories that hide or turn text: shown by their code points."""
VOID: Final = frozenset(("br", "meta", "img", "input"))
ENTITIES: Final[Mapping[str, str]] = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;"}
PLAIN: Final = re.compile(r"[\n !#-%(-;=?-~]*")
"""Text of ASCII that stays as it is: most of it, the paths of charts above all."""


class Markup(str):
    """Text that is HTML already."""


Inside = str | Markup | float | None


def escaped(text: object) -> Markup:
    """Text escaped for HTML; markup stays unchanged.

    >>> escaped("</script>"), escaped(Markup("<b>"))
    ('&lt;/script&gt;', '<b>')
    """
    if isinstance(text, Markup):
        return text
    own = str(text)
    return Markup(own if PLAIN.fullmatch(own) else "".join(ENTITIES.get(sign) or _told(sign) for sign in own))


def _told(sign: str) -> str:
    if sign == "\n" or unicodedata.category(sign) not in UNSAFE:
        return sign
    return f"\\u{ord(sign):04x}"


def tag(name: str, *inside: Inside, **attributes: object) -> Markup:
    """An element; attributes that are None are left out, `class_` is class, `text_anchor` is text-anchor.

    >>> tag("td", "1 < 2", class_="number", title=None)
    '<td class="number">1 &lt; 2</td>'
    """
    named = "".join(f' {_attribute(key)}="{_value(own)}"' for key, own in attributes.items() if own is not None)
    if name in VOID:
        return Markup(f"<{name}{named}>")
    return Markup(f"<{name}{named}>{together(*inside)}</{name}>")


def together(*inside: Inside) -> Markup:
    """Pieces behind each other; None is none."""
    return Markup("".join(escaped(own) for own in inside if own is not None))


def lines(text: str) -> Iterator[Markup]:
    """Lines of a text with breaks between them."""
    for number, own in enumerate(text.split("\n")):
        if number:
            yield tag("br")
        yield escaped(own)


def _attribute(key: str) -> str:
    kept = {"class_": "class", "name_": "name", "viewBox": "viewBox", "preserveAspectRatio": "preserveAspectRatio"}
    return kept.get(key) or key.replace("_", "-")


def _value(own: object) -> str:
    """A number is a length in a drawing, to a hundredth of a pixel, or a share below 1."""
    return f"{round(own, 2) if abs(own) > 1.0 else own:.6g}" if isinstance(own, float) else escaped(own)


SCROLLS: Final = "wide"
CARDS: Final = "wide cards"
"""CSS classes of tables on narrow pages: one that scrolls, and one that is a card for each row."""
SHORT, LONG = 16, 40
"""Signs of a cell that is not broken, and of a word that is broken."""


def page_html(page: Page) -> str:
    """A page by itself, as notebooks show it."""
    return str(page_blocks(page.blocks))


def page_blocks(blocks: Iterable[PageItem], level: int = 3, narrow: str = SCROLLS) -> Markup:
    """Blocks below each other; titles are headings of a level, tables SCROLLS or CARDS on narrow pages."""
    return together(*(_block(block, level, narrow) for block in blocks if not _is_blank(block)))


def _is_blank(block: PageItem) -> bool:
    return isinstance(block, Line) and not str(block).strip()


def _block(block: PageItem, level: int, narrow: str) -> Markup:
    if isinstance(block, Table):
        return table(block, narrow)
    if isinstance(block, Branch):
        return tag("ul", _branch(block), class_="tree")
    return _line(block, level)


def _branch(branch: Branch) -> Markup:
    below = [tag("ul", *map(_branch, branch.branches))] if branch.branches else []
    return tag("li", branch.text, *below)


def _line(block: Line, level: int) -> Markup:
    pieces = [(text, style) for text, style in block.pieces if text.strip("\n") or text.strip()]
    if any(style == TITLE for _, style in pieces):
        return tag(f"h{level}", *_pieces([(text, "" if style == TITLE else style) for text, style in pieces]))
    kind = "note" if block.note else "warning" if any("yellow" in style for _, style in pieces) else None
    return tag("p", *_pieces(pieces), class_=kind)


def _pieces(pieces: Sequence[tuple[str, str]]) -> Iterator[Inside]:
    for text, style in pieces:
        own = together(*lines(text.strip("\n")))
        yield tag("span", own, class_=style) if style else own


def table(own: Table, narrow: str = SCROLLS) -> Markup:
    """A table; numbers are right-aligned, each with its value to copy, and omissions are stated."""
    shown, roles = own.shown, narrow == CARDS  # rows that are blocks are no rows to a screen reader unless it is said
    head = tag("tr", tag("th", shown.corner, scope="col"), *(_head(heading) for heading in shown.headings))
    body = together(*(_row(row, shown.headings, roles=roles) for row in shown.rows))
    return tag(
        "div", tag("table", tag("thead", head), tag("tbody", body), role="table" if roles else None), class_=narrow
    )


def _head(heading: Heading) -> Markup:
    kind, meaning = "words" if heading.words else "number", heading.meaning or None
    return tag("th", heading.text, scope="col", class_=kind, title=meaning)


def _row(row: Row, headings: Sequence[Heading], *, roles: bool) -> Markup:
    cells = (_cell(cell, heading, row, roles=roles) for cell, heading in zip(row.cells, headings, strict=True))
    head = tag("th", row.label, scope="row", role="rowheader" if roles else None)
    return tag("tr", head, *cells, class_=row.style or None, role="row" if roles else None)


def _class_of(text: str) -> str:
    """CSS class for line breaks: short words stay whole, one without a blank breaks anywhere."""
    if len(text) <= SHORT:
        return "words short"
    return "words long" if max(map(len, text.split()), default=0) > LONG else "words"


def _cell(cell: str, heading: Heading, row: Row, *, roles: bool) -> Markup:
    value = cell.value if isinstance(cell, Shown) else None
    return tag(
        "td",
        cell,
        class_=_class_of(cell) if heading.words else "number",
        data_value=None if value is None else repr(float(value)),
        data_label=heading.text if roles else None,
        role="cell" if roles else None,
    )
