"""A value of a scene's text with the places of all that is in it, before anything is known of its meaning."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from tol3d.scene.place import KeyPath, Place

Key = str | int
Children = Mapping[Key, tuple[Place, "Node"]]
"""What a mapping or a list holds, in order, by keys or by positions, each with the place of its key."""


class Node(NamedTuple):
    """A value, the same node for every alias of it.

    Args:
        value: text, number, truth or None; an empty dict or list where it has children.
        place: where it begins.
        children: what it holds; empty of a scalar.
        size, height: values and levels in it, aliases written out.
    """

    value: Any
    place: Place
    children: Children = {}  # noqa: RUF012  # never changed
    size: int = 1
    height: int = 1

    def held(self, key: str) -> Children:
        """What the value of a key holds; nothing where there is no such key."""
        return self.children[key][1].children if key in self.children else {}

    def held_value(self, key: str) -> Any:
        """The value of a key without what it holds; None where there is no such key."""
        return self.children[key][1].value if key in self.children else None


def branch(value: dict[Any, Any] | list[Any], place: Place, children: Children) -> Node:
    """A mapping or a list.

    Args:
        value: an empty one of its type.
        place: where it begins.
        children: what it holds.
    """
    size, height = 1, 0
    for _, child in children.values():
        size += child.size
        height = max(height, child.height)
    return Node(value, place, children, size, height + 1)


def plain(node: Node) -> Any:
    """The values alone, each dict and list a new one."""
    if isinstance(node.value, dict):
        return {key: plain(child) for key, (_, child) in node.children.items()}
    if isinstance(node.value, list):
        return [plain(child) for _, child in node.children.values()]
    return node.value


@dataclass(frozen=True)
class Places(Mapping[KeyPath, Place]):
    """Where the key of each key path stands (the value, for an item of a list)."""

    top: Node

    def __getitem__(self, path: KeyPath) -> Place:
        """The place of a key path; KeyError where there is none."""
        place, node = self.top.place, self.top
        if not path:
            raise KeyError(path)
        for key in path:
            place, node = node.children[key]
        return place

    def __iter__(self) -> Iterator[KeyPath]:
        """All key paths, in the order of the file."""
        return _paths(self.top, ())

    def __len__(self) -> int:
        """How many key paths there are."""
        return self.top.size - 1


def _paths(node: Node, above: KeyPath) -> Iterator[KeyPath]:
    for key, (_, child) in node.children.items():
        yield (*above, key)
        yield from _paths(child, (*above, key))
