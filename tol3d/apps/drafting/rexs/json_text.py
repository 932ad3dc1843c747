"""The JSON form of REXS."""

import json
from typing import Any, Final, NoReturn

from tol3d.apps.drafting.rexs.document import Attribute, Document, RexsError
from tol3d.apps.drafting.rexs.xml_text import Gathered, whole_number
from tol3d.cad.step import shown

NOT_VALUES: Final = frozenset(("id", "unit"))


def read_json(content: bytes) -> Document:
    """A document of a JSON text.

    Raises:
        RexsError: it is no such text.
    """
    try:
        read = json.loads(content.decode("utf-8-sig"), object_pairs_hook=_once, parse_constant=_refuse_constant)
    except UnicodeDecodeError as error:
        raise RexsError(f"byte {error.start}: expected JSON in UTF-8") from None
    except json.JSONDecodeError as error:
        raise RexsError(f"line {error.lineno}: expected JSON, got: {error.msg}") from None
    except (RecursionError, ValueError) as error:  # brackets in brackets; numbers of thousands of digits
        raise RexsError(f"expected JSON of a gearbox, got: {shown(error)}") from None
    model = _dictionary(_dictionary(read, "the file").get("model"), "model")
    gathered = Gathered()
    for each in _list(model.get("relations"), "relations"):
        relation = _dictionary(each, "a relation")
        refs = [_dictionary(own, "a ref") for own in _list(relation.get("refs"), "refs of a relation")]
        roles = [(_text(own.get("role")), whole_number(_text(own.get("id")), "id of a ref")) for own in refs]
        gathered.relation(_words(relation), roles)
    for each in _list(model.get("components"), "components"):
        component = _dictionary(each, "a component")
        words = _words(component)
        attributes: dict[str, Attribute] = {}
        for own in _list(component.get("attributes"), "attributes of a component"):
            attribute = _dictionary(own, "an attribute")
            name = _text(attribute.get("id"))
            if name in attributes:
                raise RexsError(
                    f"component {shown(words['id'])}: expected each attribute once, got {shown(name)} twice"
                )
            attributes[name] = _attribute(attribute)
        gathered.component(words, attributes)
    return Document(_text(model.get("version")), gathered.components, gathered.relations)


def _attribute(words: dict[str, Any]) -> Attribute:
    """An attribute, whose value stands under the name of its type; None stands for no value."""
    value = next((own for key, own in words.items() if key not in NOT_VALUES), None)
    is_array = isinstance(value, list)
    values = value if isinstance(value, list) else [] if value is None else [value]
    return Attribute(_text(words.get("unit")), tuple(_text(each) for each in values), is_array)


def _words(read: dict[str, Any]) -> dict[str, str]:
    return {key: _text(read.get(key)) for key in ("id", "type", "name")}


def _text(value: object) -> str:
    """A value as XML writes it."""
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case dict() | list():
            return json.dumps(value)
        case _:
            return str(value)


def _dictionary(read: object, what: str) -> dict[str, Any]:
    if not isinstance(read, dict):
        raise RexsError(f"expected {what} with keys, got {shown(_text(read)) or 'nothing'}")
    return read


def _list(read: object, what: str) -> list[Any]:
    if read is None:
        return []
    if not isinstance(read, list):
        raise RexsError(f"expected a list of {what}, got {shown(_text(read))}")
    return read


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    read = dict(pairs)
    if len(read) < len(pairs):
        twice = next(key for key in read if [own for own, _ in pairs].count(key) > 1)
        raise RexsError(f"expected each key once, got {shown(twice)!r} twice")
    return read


def _refuse_constant(word: str) -> NoReturn:
    raise RexsError(f"expected numbers, got {word}")
