"""Scene reference: pages of every kind that scenes may have, from the JSON Schema that `tol3d schema` prints.

A kind that a mechanism registers has its fields, units, defaults, values and an example here without further work.
`python docs/scene_reference.py` writes the pages, docs/reference/*.md, after a change of the grammar or of an example.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from tol3d.kinds import all_kinds
from tol3d.scene import Grammar
from tol3d.scene.bundled import bundled_scenes
from tol3d.scene.schema import SECTIONS
from tol3d.units import EXAMPLES, FACTORS

Node = Mapping[str, Any]

DEFINITIONS = "#/$defs/"
COMMON, FIGURES = "scene_file", "published_figures"
ROOT = "Scene"
TITLES = {COMMON: "The scene file", FIGURES: "Published figures"}
SHARED = "Fields that most of these kinds have:"
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
LINE = 110  # characters of an example
FEW, TALL = 5, 6  # examples that are compared, and the lines that one should have
SHARING = 3  # kinds of a section, at least, whose common field is explained once for all of them
HEAD = "| field | values | default | meaning |\n|---|---|---|---|"


class UndescribedError(ValueError):
    """Fields of specs lack a description."""


class Reference:
    """The reference of a grammar.

    Args:
        grammar: every kind that scenes may have.
        scenes: texts of scenes or of sections, from which examples are taken; the first ones are preferred.
    """

    def __init__(self, grammar: Grammar, scenes: Sequence[str]) -> None:
        self._grammar, self._scenes = grammar, scenes
        self._schema = grammar.scene.model_json_schema()
        self._definitions: dict[str, Node] = {ROOT: self._schema, **self._schema["$defs"]}

    def pages(self) -> dict[str, str]:
        """Text of each page, by its name.

        Raises:
            UndescribedError: naming every field without a description.
        """
        if lacking := sorted(self.undescribed()):
            raise UndescribedError(f"{len(lacking)} fields of scenes lack a description: {', '.join(lacking)}")
        return {page: "\n".join(self._page(page, names)) for page, names in self._contents.items()}

    def undescribed(self) -> Iterator[str]:
        """Fields without a description: `SpurGearSpec.bore`."""
        for name, definition in self._definitions.items():
            for field, node in definition.get("properties", {}).items():
                if not _is_word(field, node) and not node.get("description"):
                    yield f"{name}.{field}"

    # what is on which page -------------------------------------------------------------------------

    @cached_property
    def _sections(self) -> Mapping[str, str]:
        """The section of each kind of entry, by its definition."""
        return {
            name: section
            for section in SECTIONS
            for name in _targets(self._schema["properties"][section]["additionalProperties"])
        }

    @cached_property
    def _contents(self) -> Mapping[str, list[str]]:
        """Definitions on each page, in order: what every scene may have first, then the kinds of each mechanism."""
        placed = set(self._sections)
        found: dict[str, list[str]] = {COMMON: [], FIGURES: []}
        options = {key: node for key, node in self._schema["properties"].items() if key not in SECTIONS}
        figures = options.pop("published")
        laws = [{"$ref": f"{DEFINITIONS}{name}"} for name, group in self._laws.items() if group == "distributions"]
        found[COMMON] += [ROOT, *self._within(options, placed), *self._within(laws, placed)]
        found[FIGURES] += self._within(figures, placed)
        for each in self._grammar.vocabularies:
            own = [self._name(section, word) for section in SECTIONS for word in self._words(each.name, section)]
            found[each.name] = [*own, *self._within([self._definitions[name] for name in own], placed)]
        return {page: names for page, names in found.items() if names}

    @cached_property
    def _laws(self) -> Mapping[str, str]:
        """The group of each law: distributions with numbers of their own, or default laws of limits."""
        drawn = next(node for node in self._nodes(self._schema) if {"NormalSpec", "UniformSpec"} <= set(_targets(node)))
        groups = {"default laws": self._schema["properties"]["default_law"], "distributions": drawn}
        return {name: group for group, node in groups.items() for each in self._nodes(node) for name in _targets(each)}

    def _words(self, vocabulary: str, section: str) -> Iterator[str]:
        """The kinds of a section that a vocabulary is the first to have."""
        for word, spec in self._grammar.kinds(section).items():
            owner = next(each for each in self._grammar.vocabularies if spec in each.specs(section))
            if owner.name == vocabulary:
                yield word

    def _name(self, section: str, word: str) -> str:
        """The definition of a kind of entry."""
        return next(n for n, s in self._sections.items() if s == section and self._word(n) == word)

    def _word(self, name: str) -> str | None:
        """The word by which a definition is chosen."""
        word: str | None = self._definitions[name].get("properties", {}).get("kind", {}).get("const")
        return word

    def _within(self, node: Any, placed: set[str]) -> Iterator[str]:
        """Definitions to which a node leads and that are on no page yet."""
        for name in [n for each in self._nodes(node) for n in [each.get("$ref", "").removeprefix(DEFINITIONS)] if n]:
            if name not in placed:
                placed.add(name)
                yield name
                yield from self._within(self._definitions[name], placed)

    def _nodes(self, node: Any) -> Iterator[Node]:
        """Every mapping in a node, without following references."""
        if isinstance(node, Mapping):
            yield node
        if isinstance(node, Mapping | list):
            for value in node.values() if isinstance(node, Mapping) else node:
                yield from self._nodes(value)

    # text ------------------------------------------------------------------------------------------

    def _page(self, page: str, names: list[str]) -> Iterator[str]:
        yield f"# {TITLES.get(page, f'Kinds of {page}')}\n"
        if page == COMMON:
            yield "Every field of a scene and what a number may have as its unit.\n"
            yield "| dimension | units | example |\n|---|---|---|"
            yield from (f"| {each} | {', '.join(FACTORS[each])} | `{EXAMPLES[each]}` |" for each in FACTORS)
            yield "\n## Kinds of entry\n\n| section | of | kinds |\n|---|---|---|"
            yield from (f"| {' | '.join(cells)} |" for cells in self._kinds())
            yield ""
        shared: Mapping[str, str] = {}
        for name, heading in self._headings(page, names):
            yield f"{heading}\n"
            if name:
                yield from self._entry(name, shared if name in self._sections else {})
            elif shared := self._shared([each for each in names if self._group(page, each) == _words_of(heading)]):
                yield f"{SHARED}\n\n{HEAD}"
                yield from (*shared.values(), "")

    def _headings(self, page: str, names: list[str]) -> Iterator[tuple[str, str]]:
        """Headings below a page's title, each with the definition that it is of, or with none where it is a group's."""
        section = None
        for name in names:
            own = self._group(page, name)
            if own != section and own:
                yield "", f"## {own.capitalize()}"
            section = own
            yield name, f"{'###' if section else '##'} {self._title(name)}"

    def _group(self, page: str, name: str) -> str | None:
        """The group of a definition on its page: a section, the laws, or what those refer to."""
        return self._sections.get(name, self._laws.get(name, "fields of these" if page not in TITLES else None))

    def _shared(self, names: list[str]) -> Mapping[str, str]:
        """Rows that at least half of a section's kinds have alike, by their fields."""
        if not {*names} <= self._sections.keys():
            return {}
        rows = Counter(row for name in names for row in self._rows(name).items())
        return {field: row for (field, row), count in rows.items() if count >= max(SHARING, len(names) / 2)}

    def _rows(self, name: str) -> Mapping[str, str]:
        """The row of each field of a definition, but of the word by which it is chosen."""
        definition = self._definitions[name]
        fields = {key: node for key, node in definition.get("properties", {}).items() if not _is_word(key, node)}
        rows: dict[str, str] = {}
        for key, node in fields.items():
            default = "required" if key in definition.get("required", ()) else _default(node.get("default"))
            cells = (f"`{key}`", self._values(node), default, node["description"])
            rows[key] = f"| {' | '.join(' '.join(cell.split()).replace('|', '&#124;') for cell in cells)} |"
        return rows

    def _kinds(self) -> Iterator[tuple[str, str, str]]:
        """Every kind: section, mechanism, links."""
        for section in SECTIONS:
            for each in self._grammar.vocabularies:
                if links := [self._link(self._name(section, word)) for word in self._words(each.name, section)]:
                    yield section, f"[{each.name}]({each.name}.md)", ", ".join(links)

    def _entry(self, name: str, shared: Mapping[str, str]) -> Iterator[str]:
        definition = self._definitions[name]
        yield re.sub(r"(?<!`)\b[A-Z]\w+Spec\b", lambda own: _said(own[0]), definition.get("description", "")) + "\n"
        rows = self._rows(name)
        if own := [row for field, row in rows.items() if shared.get(field) != row]:
            yield from (HEAD, *own)
        if also := [f"`{field}`" for field, row in rows.items() if shared.get(field) == row]:
            yield f"\nAlso, as above: {', '.join(also)}."
        if "enum" in definition:
            yield f"One of {self._values(definition)}."
        if example := self._examples.get(name):
            yield f"\n```yaml\n{example}```"
        yield ""

    def _title(self, name: str) -> str:
        word = self._word(name)
        return f"`{word}`" if word else _said(self._definitions[name].get("title", name)).capitalize()

    def _link(self, name: str) -> str:
        return f"[{self._title(name)}]({self._anchors[name]})"

    @cached_property
    def _anchors(self) -> Mapping[str, str]:
        """Page and anchor of each definition, as file views and the site make them of headings."""
        found: dict[str, str] = {}
        for page, names in self._contents.items():
            met = Counter[str]()
            for name, heading in self._headings(page, names):
                anchor = _words_of(heading).replace(" ", "-")
                found[name] = f"{page}.md#{anchor}" + (f"-{met[anchor]}" if met[anchor] else "")
                met[anchor] += 1
        return found

    def _values(self, node: Node) -> str:
        """The values that a node allows, in words."""
        if "$ref" in node:
            return self._link(node["$ref"].removeprefix(DEFINITIONS))
        for key in ("oneOf", "anyOf"):
            if key in node:
                if len(kinds := [name for name in _targets(node) if name in self._sections]) > 1:
                    return f"one of {len(kinds)} [kinds]({COMMON}.md#kinds-of-entry)"
                if {"NormalSpec", "UniformSpec"} <= set(_targets(node)):
                    return f"a [distribution]({COMMON}.md#distributions)"
                words = [self._values(each) for each in node[key] if each.get("type") != "null"]
                return " or ".join(dict.fromkeys(words))
        if "const" in node or "enum" in node:
            return ", ".join(f"`{value}`" for value in node.get("enum", [node.get("const")]))
        if node.get("type") == "array":
            return self._listed(node)
        if node.get("type") == "object":
            return f"name: {self._values(node.get('additionalProperties', {}))}"
        if "pattern" in node and "examples" in node:
            known = [dimension for dimension, example in EXAMPLES.items() if example in node["examples"]]
            return " or ".join(known) if len(known) < len(EXAMPLES) else "number with its unit"
        plain = {"integer": "whole number", "number": "number", "boolean": "true or false", "string": "text"}
        return plain.get(node.get("type", ""), "any") + _bounds(node)

    def _listed(self, node: Node) -> str:
        if parts := node.get("prefixItems"):
            same = len({self._values(each) for each in parts}) == 1
            return f"{len(parts)} × {self._values(parts[0])}" if same else f"[{', '.join(map(self._values, parts))}]"
        least, most = node.get("minItems", 0), node.get("maxItems")
        count = f" ({least} to {most})" if most else f" (at least {least})" if least > 1 else ""
        return f"list of {self._values(node.get('items', {}))}{count}"

    # examples --------------------------------------------------------------------------------------

    @cached_property
    def _examples(self) -> Mapping[str, str]:
        """An example of each definition that the scenes have: of the first few, the one of about six lines."""
        found: dict[str, list[str]] = defaultdict(list)
        for text in self._scenes:
            for name, key, data in self._met(_loaded(text), {"$ref": f"{DEFINITIONS}{ROOT}"}, ""):
                if name != ROOT:
                    section = self._sections.get(name)
                    shown = {section: {key: data}} if section else {key: data} if key else data
                    found[name].append(
                        yaml.safe_dump(shown, sort_keys=False, default_flow_style=None, width=LINE, allow_unicode=True)
                    )
        return {name: min(texts[:FEW], key=lambda text: abs(text.count("\n") - TALL)) for name, texts in found.items()}

    def _met(self, data: Any, node: Node, key: str) -> Iterator[tuple[str, str, Any]]:
        """Definitions that a value is of, those within it too, with the key under which each stands."""
        if "$ref" in node:
            name = node["$ref"].removeprefix(DEFINITIONS)
            yield name, key, data
            node = self._definitions[name]
        for each in (*node.get("oneOf", ()), *node.get("anyOf", ())):
            if "$ref" not in each or self._fits(data, each["$ref"].removeprefix(DEFINITIONS)):
                yield from self._met(data, each, key)
        if isinstance(data, dict):
            for own, value in data.items():
                inner = node.get("properties", {}).get(own, node.get("additionalProperties"))
                if isinstance(inner, Mapping):
                    yield from self._met(value, inner, str(own))
        elif isinstance(data, list):
            inner = [*node.get("prefixItems", ()), *[node.get("items")] * len(data)]
            for value, own in zip(data, inner, strict=False):
                if isinstance(own, Mapping):
                    yield from self._met(value, own, "")

    def _fits(self, data: Any, name: str) -> bool:
        fields = self._definitions[name].get("properties", {})
        return isinstance(data, dict) and data.keys() <= fields.keys() and data.get("kind") == self._word(name)


def _is_word(field: str, node: Node) -> bool:
    """True if a field is the word by which its definition is chosen."""
    return field == "kind" and "const" in node


def _loaded(text: str) -> Any:
    """Data of a YAML text; None for other text, such as output printed on a page."""
    try:
        return yaml.load(text, LOADER)
    except yaml.YAMLError:
        return None


def _targets(node: Any) -> list[str]:
    """Definitions between which a union chooses, or the one that a node refers to."""
    union = [node, *(node.get("oneOf") or node.get("anyOf") or [])] if isinstance(node, Mapping) else []
    return [each["$ref"].removeprefix(DEFINITIONS) for each in union if "$ref" in each]


def _said(name: str) -> str:
    """A class's name in words: `PlanetCarrierSpec` is a planet carrier."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.rpartition("__")[2].removesuffix("Spec")).lower()


def _words_of(heading: str) -> str:
    """A heading in small letters, without its marks."""
    return re.sub(r"[#`]", "", heading).strip().lower()


def _default(value: Any) -> str:
    return "–" if value in (None, "", [], {}) else f"`{str(value).lower() if isinstance(value, bool) else value}`"


def _bounds(node: Node) -> str:
    signs = (("minimum", "≥"), ("exclusiveMinimum", ">"), ("maximum", "≤"), ("exclusiveMaximum", "<"))
    limits = [f"{sign} {node[key]:g}" for key, sign in signs if key in node and abs(node[key]) < 1e15]
    return f" {', '.join(limits)}" if limits else ""


def reference_pages(grammar: Grammar, pages: Path) -> dict[str, str]:
    """See Reference: with examples from the bundled scenes, those that show every field last, and from pages.

    Raises:
        UndescribedError: see Reference.
    """
    bundled = sorted(bundled_scenes().items(), key=lambda own: own[0].startswith("every_"))
    texts = [path.read_text("utf-8") for _, path in bundled]
    for page in sorted(pages.glob("*.md")):
        texts += re.findall(
            r"^```(?:yaml|text)\n((?:\w+:|#).*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL
        )
    return Reference(grammar, texts).pages()


if __name__ == "__main__":
    for name, text in reference_pages(all_kinds(), Path(__file__).parent).items():
        (Path(__file__).parent / "reference" / f"{name}.md").write_text(text, "utf-8")
