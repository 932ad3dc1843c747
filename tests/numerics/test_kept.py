"""Results kept by frozen objects and by rows."""

import pickle
from dataclasses import dataclass, replace

import numpy as np

from tol3d.numerics.kept import KnownRows, kept, row_keys


@dataclass(frozen=True)
class Power:
    base: float

    @kept
    def of(self, exponent: int, *, calls: list[int]) -> float:
        calls.append(exponent)
        return float(self.base**exponent)


class Calls(list[int]):
    def __hash__(self) -> int:  # type: ignore[override]
        return 0

    def __lt__(self, other: object) -> bool:
        return False


def test_a_method_is_asked_once_for_each_object_and_each_arguments() -> None:
    calls, two = Calls(), Power(2.0)
    assert [two.of(3, calls=calls), two.of(3, calls=calls), two.of(4, calls=calls)] == [8.0, 8.0, 16.0]
    assert [Power(3.0).of(3, calls=calls), replace(two, base=5.0).of(3, calls=calls)] == [27.0, 125.0]
    assert calls == [3, 4, 3, 3]
    assert two == Power(2.0)


def test_rows_are_found_once_each_and_forgotten_beyond_the_most() -> None:
    rows, asked = np.array([[1.0], [2.0], [1.0], [3.0]]), list[list[int]]()

    def squares(new: np.ndarray) -> list[float]:
        asked.append(new.tolist())
        return [float(own) for own in rows[new, 0] ** 2]

    known = KnownRows[float](6)
    assert known.of(row_keys(rows), squares) == [1.0, 4.0, 1.0, 9.0]
    assert known.of(row_keys(rows[:2]), squares) == [1.0, 4.0]
    assert [sorted(own) for own in asked] == [[0, 1, 3]]
    again: KnownRows[float] = pickle.loads(pickle.dumps(known))
    assert again.of(row_keys(rows[1:2]), lambda new: [7.0]) == [7.0], "a pickled one is empty"
    assert known.of(row_keys(rows), squares) == [1.0, 4.0, 1.0, 9.0]
    assert len(asked) == 2, "of seven keys, more than six, the first are forgotten"
