"""Protocols that remember which types they have looked at."""

from typing import Protocol

_FOUND: dict[tuple[type, type], bool] = {}


class Remembered(type(Protocol)):  # type: ignore[misc]  # what Protocol is made by
    """Makes protocols that look at each type once: Python's own `isinstance` takes 30 us, and draws are asked often."""

    def __instancecheck__(cls, instance: object) -> bool:
        key = (cls, type(instance))
        if key not in _FOUND:
            _FOUND[key] = bool(super().__instancecheck__(instance))
        return _FOUND[key]
