"""Elements of HTML and SVG as text, with names of a scene escaped."""

import re
import unicodedata
from collections.abc import Iterator, Mapping
from typing import Final

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
    return f"{own:.6g}" if isinstance(own, float) else escaped(own)
