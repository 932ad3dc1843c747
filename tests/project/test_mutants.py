"""The tests keep their teeth: each mutant of tests/mutants.toml, a fault put into the program, is found by its tests.

A mutant is a text in a file, another in its place, and the tests that must fail then. They run on a copy of the tree,
never on the tree itself. Where a mutant's text is gone because the program has changed, put the fault into the new
lines by hand, see its tests fail, and write the new text down; drop the entry only where the fault cannot be made any
more.
"""

import compileall
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from py_compile import PycInvalidationMode

import pytest
from places import ROOT

LIST = ROOT / "tests" / "mutants.toml"
FAILED, PASSED = 1, 0  # pytest's exit codes; others mean that it could not run
HANGS = 900  # s; a guard against waiting for ever, no claim
HEAVY = """
import cadquery, fcl, hypothesis, matplotlib.pyplot, numba, numpy, pandas, pyarrow.parquet, pydantic.json_schema, pytest
import pytest_cov.plugin, pyvista, rich.console, rich.live, rich.progress, rich.table, ruamel.yaml, scipy.optimize
import scipy.stats, trimesh, typer, xdist.scheduler
"""
FORKS = f"""
{HEAVY}
import json, os, signal, sys
for line in sys.stdin:  # what a process is to be told, and where it writes
    child = os.fork()
    if not child:
        arguments, output = json.loads(line)
        signal.alarm({HANGS})
        written = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(written, 1), os.dup2(written, 2)
        code = pytest.main(arguments)
        sys.stdout.flush()
        os._exit(code)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""  # libraries are loaded once, of the tree nothing is: each process imports what stands there then
COPIED = ("tol3d", "parts", "scenes", "tests", "benchmarks", "docs", "README.md", "pyproject.toml")


@dataclass(frozen=True)
class Mutant:
    """A fault: what it is, where, which text stands for which, the tests that must fail of it, and by whom it is tried.

    CI tries every third one and those with `ci`; those with `nightly` are slow, which it never tries.
    """

    fault: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    nightly: bool = False
    ci: bool = False


MUTANTS = [
    Mutant(**{**entry, "tests": tuple(entry["tests"])}) for entry in tomllib.loads(LIST.read_text("utf-8"))["mutant"]
]
QUICK = [own for own in MUTANTS if not own.nightly]
OF_CI = {own.fault for own in (*QUICK[::3], *(own for own in QUICK if own.ci))}


class Tree:
    """A copy of the tree, in which Python finds tol3d, its parts and its scenes."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in COPIED:
            ignored = shutil.ignore_patterns("__pycache__")
            source, target = ROOT / name, folder / name
            shutil.copytree(source, target, ignore=ignored) if source.is_dir() else shutil.copy(source, target)
        for name in ("parts", "scenes"):  # they are installed inside the package
            (folder / "tol3d" / name).symlink_to(Path("..") / name)
        (folder / "cache").mkdir(mode=0o700)
        for name in ("tol3d", "parts", "tests"):
            # by their content: a mutant is written within the second that times of files are compared by
            compileall.compile_dir(folder / name, quiet=2, invalidation_mode=PycInvalidationMode.CHECKED_HASH)

        more = {"PYTHONPATH": str(self.folder), "PYTHONDONTWRITEBYTECODE": "1", "HYPOTHESIS_PROFILE": "found"}
        if "TOL3D_CACHE" not in os.environ:
            more["TOL3D_CACHE"] = str(self.folder / "cache")
        self.forks = subprocess.Popen(
            [sys.executable, "-c", FORKS],
            cwd=self.folder, env=os.environ | more, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def pytest(self, *tests: str) -> tuple[int, str]:
        """Run tests there, slow ones too, until one fails: the exit code, and what is printed."""
        options = ("-n", "0", "-q", "-x", "-p", "no:cacheprovider", "--tb=line", "-m", "not nightly")
        output = self.folder / "output.txt"
        assert self.forks.stdin
        assert self.forks.stdout
        self.forks.stdin.write(json.dumps([[*options, *tests], str(output)]) + "\n")
        self.forks.stdin.flush()
        return int(self.forks.stdout.readline()), output.read_text("utf-8")

    def passes(self, mutants: Iterable[Mutant]) -> None:
        """Run the tests that find some mutants: without a fault they pass."""
        code, said = self.pytest(*sorted({test for mutant in mutants for test in mutant.tests}))
        assert code == PASSED, said[-3000:]


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tree]:
    """The copy, one in each process of pytest's."""
    made = Tree(tmp_path_factory.mktemp("mutants"))
    with made.forks:
        made.passes(MUTANTS[3:5])  # what passes there passes here, and CI runs them all
        yield made


@pytest.fixture
def mutated(tree: Tree, request: pytest.FixtureRequest) -> Iterator[tuple[Tree, Mutant]]:
    """The copy with one fault in it."""
    mutant: Mutant = request.param
    path = tree.folder / mutant.file
    text = path.read_text("utf-8")
    path.write_text(text.replace(mutant.old, mutant.new), "utf-8")
    yield tree, mutant
    path.write_text(text, "utf-8")


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.fault)
def test_a_mutant_s_text_is_there_once_and_its_tests_too(mutant: Mutant) -> None:
    count = (ROOT / mutant.file).read_text("utf-8").count(mutant.old)
    told = f"{LIST.name}, {mutant.fault!r}; what to do then says {Path(__file__).name}"
    assert count == 1, f"expected its text once in {mutant.file}, found it {count} times: {told}"
    assert mutant.old != mutant.new
    for test in mutant.tests:
        file, _, name = test.partition("::")
        defined = re.search(rf"^def {name.partition('[')[0]}\(", (ROOT / file).read_text("utf-8"), re.MULTILINE)
        assert defined, f"there is no test {test}: {told}"


@pytest.mark.parametrize(
    "mutated",
    [
        pytest.param(own, marks=pytest.mark.slow if own.fault in OF_CI else pytest.mark.nightly, id=own.fault)
        for own in MUTANTS
    ],
    indirect=True,
)
def test_a_mutant_is_killed(mutated: tuple[Tree, Mutant]) -> None:
    tree, mutant = mutated
    code, said = tree.pytest(*mutant.tests)
    assert code == FAILED, f"{mutant.fault}: survives\n{said[-3000:]}"


@pytest.mark.nightly
def test_all_tests_that_find_mutants_pass_in_the_copy(tree: Tree) -> None:
    tree.passes(MUTANTS)
