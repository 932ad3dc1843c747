"""Requests that no drawing can state are refused in words."""

from collections.abc import Callable

import pytest

from tol3d.assembly.zones import Bonus, Process, catalogue
from tol3d.errors import InputError
from tol3d.statistics.distributions.normal import Normal


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: catalogue.axis(-0.1), "a width of 0 mm or more, got -0.1 mm"),
        (lambda: catalogue.axis(float("nan")), "a width of 0 mm or more, got nan mm"),
        (lambda: catalogue.axis(0.1, 0.2), r"within the width of the zone \(0.1 mm\), got 0.2 mm; state the wider"),
        (lambda: catalogue.axis(0.1, 0.0), "an orientation above 0 mm"),
        (lambda: catalogue.rectangle(0.1, form=0.1), "a form of 0 mm or more, within the width"),
        (lambda: catalogue.rectangle(0.1, form=-0.1), "a form of 0 mm or more, within the width"),
        (lambda: catalogue.rectangle(0.1, outward=float("inf")), "a finite length outward, got inf mm"),
        (lambda: catalogue.flat_axis(0.1, (0.0, 0.0)), "a direction other than 0"),
        (lambda: Process(catalogue.axis(0.1), (Normal(0.0, 1.0),)), "one distribution for each of start x, .*, got 1"),
        (lambda: Bonus(0.1, 0.0, grows=True), "limits of size in order, got 0.1 mm to 0 mm"),
    ],
)
def test_what_makes_no_sense_is_refused(make: Callable[[], object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()
