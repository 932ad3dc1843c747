"""Things as keys of caches: themselves, not their likes."""

from typing import Any


class Itself:
    """A thing as a key; hashing its content may take longer than computing the value kept under it."""

    def __init__(self, thing: Any) -> None:
        self.thing = thing

    def __hash__(self) -> int:
        return id(self.thing)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Itself) and other.thing is self.thing
