"""Names of kernels in the cache: by every source that they are made of, and nothing else."""

import ast
import importlib
import os
import shutil
import subprocess
import sys
import types
from pathlib import Path

import pytest
from places import ROOT, SCENES

from tol3d.gearing.engines.exact import kernels
from tol3d.gearing.engines.exact.sums import write_builds
from tol3d.numerics import compiled, sources
from tol3d.numerics.compiled import Kernel
from tol3d.numerics.sources import sources_of
from tol3d.statistics.estimates import quick_products
from tol3d.statistics.samplers import quick_uniforms

KERNELS = {
    "spur read": kernels.spur_read,
    "spur gaps": kernels.spur_gaps,
    "bevel read": kernels.bevel_read,
    "bevel gaps": kernels.bevel_gaps,
    "write builds": write_builds,
    "draw": quick_uniforms._draw,
    "products": quick_products._add_products,
}
each_kernel = pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS.keys())


def name_of(kernel: Kernel) -> str | None:
    made = Kernel(kernel._function, kernel._tuples, kernel._arrays)
    made._settings = kernel._settings
    return made.name


def sources_in_name(kernel: Kernel) -> set[str]:
    """Modules whose sources are in a kernel's name."""
    return set(compiled._made_of(kernel._function, kernel._tuples)["sources"])


def modules_reached(kernel: Kernel) -> set[str]:
    """Modules of all functions and kinds that a kernel's code names, directly or not: found from what runs."""
    kinds = set(kernel._tuples)
    variants = {module for kind in kinds for module in compiled._VARIANTS_IN.get(kind, ())}
    found: set[str] = {kind.__module__ for kind in kinds}
    waiting = [kernel._function]
    waiting += [
        value
        for module in variants
        for value in vars(sys.modules[module]).values()
        if isinstance(value, types.FunctionType) and value.__module__ == module
    ]
    seen = set()
    while waiting:
        function = waiting.pop()
        function = getattr(function, "py_func", function)
        if function in seen:
            continue
        seen.add(function)
        found.add(function.__module__)
        for name in function.__code__.co_names:
            value = function.__globals__.get(name)
            value = getattr(value, "py_func", value)
            if isinstance(value, types.FunctionType):
                waiting.append(value)
            elif isinstance(value, type):
                found.add(value.__module__)
    return {name for name in found if name.startswith("tol3d.")}


@each_kernel
def test_all_that_a_kernel_s_code_calls_is_among_its_sources(kernel: Kernel) -> None:
    known = sources_in_name(kernel)
    reached = modules_reached(kernel)
    assert len(reached) >= (6 if kernel._tuples else 1)
    assert reached <= known


def kernels_of_all_rooms() -> dict[str, Kernel]:
    """Every kernel of tol3d by its place: found in what the files hold, not in a list."""
    found: dict[str, Kernel] = {}
    for path in sorted((ROOT / "tol3d").rglob("*.py")):
        if "numerics.compiled import" in path.read_text("utf-8"):
            module = importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
            for name, own in vars(module).items():
                held = own.values() if isinstance(own, dict) else [own]
                found |= {f"{module.__name__}.{name} {k}": it for k, it in enumerate(held) if isinstance(it, Kernel)}
    return found


def test_all_that_any_kernel_of_the_package_calls_is_among_its_sources() -> None:
    every = kernels_of_all_rooms()
    assert len(every) > 25
    lacking = {
        name: sorted(lost)
        for name, kernel in every.items()
        if (lost := modules_reached(kernel) - sources_in_name(kernel))
    }
    assert lacking == {}


@each_kernel
def test_a_change_of_any_source_of_a_kernel_is_another_kernel(kernel: Kernel, monkeypatch: pytest.MonkeyPatch) -> None:
    before = name_of(kernel)
    assert before == name_of(kernel)
    names = {before}
    real = sources.source
    mine = sources_of(kernel._function.__module__, *(kind.__module__ for kind in kernel._tuples))
    for changed in mine:
        monkeypatch.setattr(
            sources, "source", lambda name, changed=changed: real(name) + ("# changed\n" if name == changed else "")
        )
        names.add(name_of(kernel))
    assert len(names) == len(mine) + 1
    if kernel._tuples:
        assert "tol3d.gearing.engines.status" in mine  # whose codes are frozen into it


@each_kernel
def test_what_no_kernel_is_made_of_leaves_it_as_it_is(kernel: Kernel, monkeypatch: pytest.MonkeyPatch) -> None:
    before = name_of(kernel)
    real = sources.source
    others = ("tol3d.report", "tol3d.cli", "tol3d.scene", "tol3d.gearing.model", "tol3d.cad.solids", "tol3d.simulate")
    monkeypatch.setattr(sources, "source", lambda name: real(name) + ("# changed\n" if name.startswith(others) else ""))
    assert name_of(kernel) == before


def test_kernels_have_names_of_their_own() -> None:
    assert len({name_of(kernel) for kernel in KERNELS.values()}) == len(KERNELS)


@pytest.mark.slow
@pytest.mark.parametrize("setting", ["NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NUMBA_OPT"])
def test_another_target_is_another_kernel(setting: str) -> None:
    code = "from tol3d.statistics.samplers.quick_uniforms import _draw; print(_draw.name)"
    value = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "+bmi2", "NUMBA_OPT": "2"}[setting]
    names = [
        subprocess.run([sys.executable, "-c", code], env=os.environ | own, capture_output=True, text=True, check=True)
        for own in ({"PYTHONHASHSEED": "1"}, {"PYTHONHASHSEED": "2"}, {setting: value})
    ]
    first, second, other = (done.stdout.strip() for done in names)
    assert first == second == quick_uniforms._draw.name
    assert other != first


def test_imports_are_followed_however_they_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    texts = {
        "__init__": "from tol3d_tried import d\n",
        "a": "import tol3d_tried.b\nfrom tol3d_tried.sub import (\n    c,\n    VALUE,\n)\nimport numpy\n",
        "b": "def f():\n    from . import e\n    from .sub.g import h\n",
        "d": "",
        "e": "",
        "sub/__init__": "from tol3d_tried.sub.f import VALUE\n",
        "sub/c": "",
        "sub/f": "VALUE = 1\n",
        "sub/g": "from .. import d\nh = 1\n",
        "unused": "",
    }
    for name, text in texts.items():
        (tmp_path / "tol3d_tried" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "tol3d_tried" / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sources, "PACKAGE", "tol3d_tried")
    found = {name.removeprefix("tol3d_tried").removeprefix(".") for name in sources_of("tol3d_tried.a")}
    # a package counts where something is imported from it: `from . import e` and `from .. import d` do
    assert found == {"", "a", "b", "d", "e", "sub", "sub.c", "sub.f", "sub.g"}
    assert sources_of("tol3d_tried.d") == {"tol3d_tried.d": ""}


STATUSES = """
import sys
from tol3d.simulate import Overrides, run_scene
run = run_scene(sys.argv[1], overrides=Overrides(trials=200, witness=0))
print(sorted(set(run.columns("status")["status"].tolist())))
"""


@pytest.mark.slow
def test_kernels_have_the_codes_of_today(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "tol3d", tmp_path / "tol3d", ignore=shutil.ignore_patterns("__pycache__"))
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "TOL3D_CACHE": str(tmp_path / "cache")}
    text = (SCENES / "spur_pair.yaml").read_text("utf-8")
    far = text.replace("lower: -20 um, upper: 20 um", "lower: -2 mm, upper: 2 mm")
    (tmp_path / "far.yaml").write_text(far, "utf-8")
    command = [sys.executable, "-c", STATUSES, str(tmp_path / "far.yaml")]

    def statuses() -> str:
        done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    before = statuses()
    assert "out of range" in before
    assert "no contact" not in before
    codes = tmp_path / "tol3d" / "gearing" / "engines" / "status.py"
    text = codes.read_text()
    codes.write_text(
        text.replace("NO_CONTACT: Final = 2", "NO_CONTACT: Final = 3").replace("RANGE: Final = 3", "RANGE: Final = 2")
    )
    assert codes.read_text() != text
    # a kernel with the codes of before would say that trials out of range have no contact
    assert statuses() == before


@pytest.mark.parametrize(
    "text",
    [
        "import a.b\nfrom c import d, e as f  # why\n",
        "from . import x\nfrom ..y import (\n    z,  # one (of two)\n    w,\n)\n",
        "if a: import b\n",
        "import a; import b\n",
        "from a import b, \\\n    c\n",
        "def f():\n    from a import b\n    return b\n",
        "from a import *\n",
        "try:\n    import a\nexcept ImportError: import b\n",
    ],
)
def test_import_statements_alone_name_the_modules_that_the_whole_text_names(text: str) -> None:
    assert imports_in(sources._import_statements(text)) == imports_in(text)


def test_words_between_quotes_that_begin_like_an_import_are_none() -> None:
    text = '"""A list of what is brought in:\nimport duties and fees\n"""\nfrom tol3d.numerics import frames\n'
    assert set(sources._imports("tol3d.numerics.loops", text)) == {"tol3d.numerics", "tol3d.numerics.frames"}


@pytest.mark.slow
def test_import_statements_of_this_package_are_all_found() -> None:
    for path in (ROOT / "tol3d").rglob("*.py"):
        text = path.read_text("utf-8")
        assert imports_in(sources._import_statements(text)) == imports_in(text), path


def imports_in(text: str) -> list[str]:
    """Import statements of a text, by Python's own reader."""
    tree = ast.walk(ast.parse(text))
    return sorted(ast.unparse(node) for node in tree if isinstance(node, ast.Import | ast.ImportFrom))
