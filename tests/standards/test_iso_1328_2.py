"""Run-out and radial composite tolerances by grade, against rows of published tables and each other."""

import itertools
import math

import pytest

from tol3d.errors import InputError
from tol3d.statistics.standards.iso_1328_2 import DIAMETERS, FINE_MODULES, KINDS, tolerance

RUN_OUT = (1.5, 2.5, 3.0, 4.5, 6.5, 9.0, 13, 18, 25, 36, 51, 72, 102)
"""Run-out of d 5 to 20 mm and m 0.5 to 2 mm, grades 0 to 12, as tables of the standard print it."""


def test_a_row_of_the_table_of_run_out() -> None:
    assert tuple(tolerance("F_r", grade, 1.5, 12.0) for grade in range(13)) == RUN_OUT


@pytest.mark.parametrize(("deviation", "row"), [("F_i''", (11, 15, 21, 30)), ("f_i''", (2.0, 2.5, 3.5, 5.0))])
def test_rows_of_the_tables_of_composite_deviations(deviation: str, row: tuple[float, ...]) -> None:
    """Rows for d 5 to 20 mm and m 0.2 to 0.5 mm, grades 5 to 8."""
    assert tuple(tolerance(deviation, grade, 0.4, 20.0) for grade in (5, 6, 7, 8)) == row


def test_the_total_is_run_out_and_tooth_to_tooth_together() -> None:
    """Term by term, so in every range."""
    for m in FINE_MODULES:
        for d in DIAMETERS:
            total, run_out, single = (KINDS[name].of_grade_5(m, d) for name in ("F_i''", "F_r", "f_i''"))
            assert total == pytest.approx(run_out + single, abs=1e-12)


def test_no_tolerance_lies_at_a_half() -> None:
    """Geometric means of the ranges have irrational roots, so rounding of the formulae decides nothing: 1e-6 is far."""
    for kind in KINDS.values():
        for (m, n), (d, e) in itertools.product(itertools.pairwise(kind.modules), itertools.pairwise(kind.diameters)):
            at_5 = kind.of_grade_5(math.sqrt(m * n), math.sqrt(d * e))
            for grade in kind.grades:
                value = at_5 * 2.0 ** ((grade - 5) / 2)
                assert abs(value / (1.0 if value > 10.0 else 0.5) % 1 - 0.5) > 1e-6


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (("F_p", 5, 2.0, 48.0), "expected F_r, F_i'', f_i'' of ISO 1328-2, got 'F_p'"),
        (("F_i''", 3, 2.0, 48.0), "from 4 to 12 of ISO 1328-2:1997, got 3 .R classes"),
        (("f_i''", 7, 0.1, 48.0), "module from 0.2 to 10 mm, got 0.1 mm; .* write the limit"),
        (("F_r", 7, 2.0, 4.0), "diameter from 5 to 10000 mm, got 4 mm"),
    ],
)
def test_what_it_does_not_have_is_refused(asked: tuple[str, int, float, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        tolerance(*asked)
