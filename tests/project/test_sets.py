"""Tests that tests/sets.toml takes out of the default are there; for nightly ones a quicker test finds a mutant."""

import re
import tomllib
from typing import Any

import pytest
from places import ROOT
from thinned import NIGHTLY, SETS, SLOW

MUTANTS = {
    entry["fault"]: entry["tests"]
    for entry in tomllib.loads((ROOT / "tests" / "mutants.toml").read_text("utf-8"))["mutant"]
    if "nightly" not in entry
}


def defined(test: str) -> bool:
    file, _, name = test.partition("::")
    return bool(re.search(rf"^def {name}\(", (ROOT / file).read_text("utf-8"), re.MULTILINE))


def test_tests_that_are_listed_are_there() -> None:
    assert [test for test in (*SLOW, *NIGHTLY) if not defined(test)] == []
    assert len(NIGHTLY) == len(SETS["nightly"])


@pytest.mark.parametrize("entry", NIGHTLY.values(), ids=lambda entry: entry["test"].rpartition("::")[2])
def test_a_quicker_test_of_ci_stands_for_a_nightly_one_and_finds_a_mutant(entry: dict[str, Any]) -> None:
    assert {"test", "quicker", "mutant"} <= set(entry) <= {"test", "every", "cases", "quicker", "mutant"}
    assert defined(entry["quicker"])
    if entry["quicker"] == entry["test"]:  # other cases of it, which CI has
        assert entry["every"] > 1
    elif entry["quicker"] in NIGHTLY:
        assert "every" in NIGHTLY[entry["quicker"]]
    assert entry["quicker"] in {test.partition("[")[0] for test in MUTANTS[entry["mutant"]]}


def test_no_test_that_finds_a_mutant_is_left_out_whole() -> None:
    whole = {test for test, entry in NIGHTLY.items() if "every" not in entry}
    assert whole & {test.partition("[")[0] for tests in MUTANTS.values() for test in tests} == set()
