"""One instance of a STEP file, `#id = ENTITY(…);`, and its arguments asked for by their required types."""

from dataclasses import dataclass

from tol3d.cad.step.refused import StepError, shown
from tol3d.cad.step.values import Enumeration, Missing, Reference, Typed, Value


@dataclass(frozen=True, slots=True)
class Instance:
    """One instance, simple (one record) or complex (several).

    Args:
        id: its number in the file.
        place: file and line, for errors.
        records: entities with their own arguments; a simple instance has those of its supertypes before its own.
    """

    id: int
    place: str
    records: tuple[Typed, ...]

    @property
    def keyword(self) -> str:
        """The entity of a simple instance; those of a complex one joined by +."""
        return "+".join(record.keyword for record in self.records)

    def record(self, *keywords: str) -> "Record | None":
        """The first record that is one of these entities, or None."""
        for record in self.records:
            if record.keyword in keywords:
                return Record(self, record.keyword, record.arguments)
        return None

    def needed(self, *keywords: str) -> "Record":
        """The record of one of these entities.

        Raises:
            StepError: the instance has none of them.
        """
        found = self.record(*keywords)
        if found is None:
            raise StepError(f"{self.place}: expected {' or '.join(keywords)}, got {shown(self.keyword)}")
        return found

    def inherited(self, *keywords: str) -> "Record":
        """The record of a supertype, or that of a simple instance of a subtype, which begins with the same."""
        found = self.record(*keywords)
        if found is None and len(self.records) == 1:
            return Record(self, self.records[0].keyword, self.records[0].arguments)
        return found if found is not None else self.needed(*keywords)


@dataclass(frozen=True, slots=True)
class Record:
    """One entity of an instance with its arguments, counted from 0."""

    instance: Instance
    keyword: str
    arguments: tuple[Value, ...]

    def __len__(self) -> int:
        return len(self.arguments)

    def argument(self, index: int) -> Value:
        """The argument as written.

        Raises:
            StepError: the record has fewer.
        """
        if not -len(self.arguments) <= index < len(self.arguments):
            raise StepError(
                f"{self.instance.place}: {self.keyword}: expected at least {index + 1} arguments, "
                f"got {len(self.arguments)}"
            )
        return self.arguments[index]

    def wrong(self, index: int, expected: str) -> StepError:
        """The error to raise for an argument of another kind."""
        got = shown(written(self.argument(index)))
        return StepError(f"{self.instance.place}: {self.keyword}, argument {index + 1}: expected {expected}, got {got}")

    def reference(self, index: int) -> Reference:
        """A reference.

        Raises:
            StepError: it is none.
        """
        found = self.argument(index)
        if not isinstance(found, Reference):
            raise self.wrong(index, "a reference such as #12")
        return found

    def references(self, index: int) -> tuple[Reference, ...]:
        """The references in a list, of a stated type or not.

        Raises:
            StepError: it is no list of references.
        """
        found = self._untyped(index)
        if not isinstance(found, tuple) or any(not isinstance(each, Reference) for each in found):
            raise self.wrong(index, "a list of references such as (#12,#13)")
        return tuple(each for each in found if isinstance(each, Reference))

    def text(self, index: int) -> str:
        """A string; empty if it is not given.

        Raises:
            StepError: it is none.
        """
        if isinstance(self.argument(index), Missing):
            return ""
        found = self._untyped(index)
        if not isinstance(found, str):
            raise self.wrong(index, "a string")
        return found

    def number(self, index: int) -> float:
        """A number, of a stated type or not.

        Raises:
            StepError: it is none.
        """
        found = self._untyped(index)
        if isinstance(found, Reference) or not isinstance(found, int | float):
            raise self.wrong(index, "a number")
        return float(found)

    def numbers(self, index: int) -> tuple[float, ...]:
        """The numbers in a list.

        Raises:
            StepError: it is no list of numbers.
        """
        found = self.argument(index)
        if not isinstance(found, tuple) or any(isinstance(each, Reference) for each in found):
            raise self.wrong(index, "a list of numbers")
        numbers = tuple(float(each) for each in found if isinstance(each, int | float))
        if len(numbers) != len(found):
            raise self.wrong(index, "a list of numbers")
        return numbers

    def words(self, index: int) -> tuple[str, ...]:
        """The enumeration values in a list, in lower case with blanks: `.FREE_STATE.` is `free state`.

        Raises:
            StepError: it is no list of them.
        """
        found = self._untyped(index)
        if not isinstance(found, tuple) or any(not isinstance(each, Enumeration) for each in found):
            raise self.wrong(index, "a list of words such as (.FREE_STATE.)")
        return tuple(spoken(each.word) for each in found if isinstance(each, Enumeration))

    def _untyped(self, index: int) -> Value:
        """An argument, of a stated type the value in it."""
        found = self.argument(index)
        return found.arguments[0] if isinstance(found, Typed) and len(found.arguments) == 1 else found


def spoken(word: str) -> str:
    """A word of EXPRESS as a person writes it: `MAXIMUM_MATERIAL_REQUIREMENT` is `maximum material requirement`."""
    return word.replace("_", " ").lower()


def written(value: Value) -> str:
    """A value much as the file has it."""
    if isinstance(value, Missing):
        return value.value
    if isinstance(value, Enumeration):
        return f".{value.word}."
    if isinstance(value, Typed):
        return f"{value.keyword}(…)"
    if isinstance(value, tuple):
        return "(" + ",".join(written(each) for each in value[:5]) + (",…" if len(value) > 5 else "") + ")"
    return repr(value)
