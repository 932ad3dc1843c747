"""The XML form of REXS, read by expat without any entity, declaration of types or other file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final
from xml.parsers import expat

from tol3d.apps.drafting.rexs.document import OTHER_TYPES, Attribute, Component, Document, Relation, RexsError
from tol3d.cad.step import shown

DEEPEST: Final = 12  # model/components/component/attribute/array_of_arrays/array/c are 7
MOST_ELEMENTS: Final = 2_000_000  # a file of 20 MB has fewer


def whole_number(written: str, what: str) -> int:
    """An id; some programs write `5.0`.

    Raises:
        RexsError: it is no whole number.
    """
    try:
        value = float(written)
        if value == int(value):
            return int(value)
    except (ValueError, OverflowError):
        pass
    raise RexsError(f"{what}: expected a whole number, got {shown(written)!r}")


@dataclass
class Gathered:
    """Parts of a document while its text is read, in either form."""

    components: dict[int, Component] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)

    def component(self, words: Mapping[str, str], attributes: Mapping[str, Attribute]) -> None:
        """Take a component.

        Raises:
            RexsError: its id is no number, or another component's.
        """
        number = whole_number(words.get("id", ""), "id of a component")
        if number in self.components:
            raise RexsError(f"component {number}: expected an id of its own, got that of {self.components[number]}")
        kind = words.get("type", "")
        self.components[number] = Component(number, OTHER_TYPES.get(kind, kind), words.get("name", ""), attributes)

    def relation(self, words: Mapping[str, str], refs: list[tuple[str, int]]) -> None:
        """Take a relation.

        Raises:
            RexsError: its id is no number.
        """
        number = whole_number(words.get("id", ""), "id of a relation")
        self.relations.append(Relation(number, words.get("type", ""), tuple(refs)))


class Handlers:
    """Handlers of expat: elements that are read, by their place in the tree; all others are passed over."""

    def __init__(self, parser: "expat.XMLParserType") -> None:
        self.parser = parser
        self.path: list[str] = []
        self.version: str | None = None
        self.gathered = Gathered()
        self.count = 0
        self.words: dict[str, str] = {}
        self.refs: list[tuple[str, int]] = []
        self.attributes: dict[str, Attribute] = {}
        self.attribute: dict[str, str] = {}
        self.values: list[str] = []
        self.text: list[str] = []

    def declared(self, *_: object) -> None:
        """Refuse a declaration of types, with which entities and other files come."""
        raise RexsError(
            f"line {self.parser.CurrentLineNumber}: expected no DOCTYPE and no entities; nothing is fetched"
        )

    def start(self, tag: str, words: dict[str, str]) -> None:
        """Go into an element."""
        self.count += 1
        self.path.append(tag.rpartition(":")[2])
        if len(self.path) > DEEPEST or self.count > MOST_ELEMENTS:
            raise RexsError(
                f"line {self.parser.CurrentLineNumber}: expected at most {DEEPEST} elements in each other and "
                f"{MOST_ELEMENTS} of them"
            )
        self.text = []
        match self.path:
            case ["model"]:
                self.version = words.get("version", "")
            case ["model", "relations", "relation"]:
                self.words, self.refs = words, []
            case ["model", "relations", "relation", "ref"]:
                number = whole_number(words.get("id", ""), f"relation {shown(self.words.get('id', ''))}: id of a ref")
                self.refs.append((words.get("role", ""), number))
            case ["model", "components", "component"]:
                self.words, self.attributes = words, {}
            case ["model", "components", "component", "attribute"]:
                self.attribute, self.values = words, []

    def data(self, text: str) -> None:
        """Text within an element."""
        self.text.append(text)

    def end(self, _: str) -> None:
        """Go out of an element."""
        match self.path:
            case ["model", "relations", "relation"]:
                self.gathered.relation(self.words, self.refs)
            case ["model", "components", "component"]:
                self.gathered.component(self.words, self.attributes)
            case ["model", "components", "component", "attribute"]:
                self._take_attribute()
            case ["model", "components", "component", "attribute", *_, "c"]:
                self.values.append("".join(self.text).strip())
        self.path.pop()
        self.text = []

    def _take_attribute(self) -> None:
        name = self.attribute.get("id", "")
        if name in self.attributes:
            number = shown(self.words.get("id", ""))
            raise RexsError(f"component {number}: expected each attribute once, got {shown(name)} twice")
        unit, written = self.attribute.get("unit", ""), "".join(self.text).strip()
        values = tuple(self.values) if self.values else (written,)
        self.attributes[name] = Attribute(unit, values, bool(self.values))


def read_xml(content: bytes) -> Document:
    """A document of an XML text.

    Raises:
        RexsError: it is no such text, or has a declaration of types.
    """
    parser = expat.ParserCreate()
    handlers = Handlers(parser)
    parser.buffer_text = True
    parser.StartDoctypeDeclHandler = handlers.declared
    parser.EntityDeclHandler = handlers.declared
    parser.StartElementHandler = handlers.start
    parser.EndElementHandler = handlers.end
    parser.CharacterDataHandler = handlers.data
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        why = expat.errors.messages.get(error.code, "no XML")
        raise RexsError(f"line {error.lineno}: expected XML, got: {why}") from None
    except (LookupError, ValueError) as error:  # an encoding that Python does not have, or has otherwise
        raise RexsError(f"expected XML in UTF-8, got: {shown(error)}") from None
    if handlers.version is None:
        raise RexsError("expected a REXS file with a `model` at its top, got other XML")
    return Document(handlers.version, handlers.gathered.components, handlers.gathered.relations)
