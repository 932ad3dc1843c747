"""A value of a scene's text with the places of all that is in it, before anything is known of its meaning."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from tol3d.scene.place import KeyPath, Place

Key = str | int
Children = Mapping[Key, tuple[Place, "Node"]]
"""Contents of a mapping or a list, in order, by keys or by positions, each with the place of its key."""


class Node(NamedTuple):
    """A value, the same node for every alias of it.

    Args:
        value: text, number, truth or None; an empty dict or list if it has children.
        place: of its start.
        children: its contents; empty for a scalar.
        size, height: values and levels in it, aliases written out.
    """

    value: Any
    place: Place
    children: Children = {}  # noqa: RUF012  # never changed
    size: int = 1
    height: int = 1

    def held(self, key: str) -> Children:
        """Contents of the value of a key; nothing where there is no such key."""
        return self.children[key][1].children if key in self.children else {}

    def held_value(self, key: str) -> Any:
        """The value of a key without its contents; None if there is no such key."""
        return self.children[key][1].value if key in self.children else None


def branch(value: dict[Any, Any] | list[Any], place: Place, children: Children) -> Node:
    """A mapping or a list.

    Args:
        value: an empty one of its type.
        place: of its start.
        children: its contents.
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
    """Place of the key of each key path (of the value, for an item of a list)."""

    top: Node

    def __getitem__(self, path: KeyPath) -> Place:
        """The place of a key path; KeyError if there is none."""
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
        """Number of key paths."""
        return self.top.size - 1


def _paths(node: Node, above: KeyPath) -> Iterator[KeyPath]:
    for key, (_, child) in node.children.items():
        yield (*above, key)
        yield from _paths(child, (*above, key))
