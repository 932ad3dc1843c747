"""An editable install holds beside the clone's folder too, which Python would take for a package without code."""

import shutil
import subprocess
import sys
import tarfile
import tomllib
import venv
from pathlib import Path

import pytest
from places import ROOT

FINDER = ROOT / ".build" / "past_namespace.py"
SCRIPT = "import tol3d; print(tol3d.__file__); import tol3d.errors; import tol3d.scenes; tol3d.Tol3dError"


def shown(code: str, beside: Path) -> str:
    """Output of Python for a script in a folder, with the finder of an editable install."""
    script = beside / "script.py"
    script.write_text(f"import runpy; runpy.run_path({str(FINDER)!r})\n{code}\n", "utf-8")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_a_script_beside_a_folder_named_tol3d_finds_the_package(tmp_path: Path) -> None:
    (tmp_path / "tol3d" / "docs").mkdir(parents=True)
    assert Path(shown(SCRIPT, tmp_path)) == ROOT / "tol3d" / "__init__.py"


def test_a_package_with_code_that_lies_first_is_left_there(tmp_path: Path) -> None:
    (tmp_path / "tol3d").mkdir()
    (tmp_path / "tol3d" / "__init__.py").write_text("", "utf-8")
    assert Path(shown("import tol3d; print(tol3d.__file__)", tmp_path)) == tmp_path / "tol3d" / "__init__.py"


def test_other_packages_without_code_stay_as_they_are(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    assert shown("import other; print(list(other.__path__))", tmp_path) == str([str(tmp_path / "other")])


def tree_at(folder: Path) -> Path:
    """Files of this tree that a build needs; the tree need be no clone."""
    for name in ("tol3d", "parts", "scenes", ".build"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder)
    return folder


@pytest.mark.slow  # pip and its build environment: half a minute
def test_the_readmes_install_holds_beside_the_clone(tmp_path: Path) -> None:
    clone = tree_at(tmp_path / "tol3d")
    venv.create(tmp_path / "venv", with_pip=True)
    python = tmp_path / "venv" / "bin" / "python"
    install = [str(python), "-m", "pip", "install", "-q", "--no-deps"]
    subprocess.run([*install, "-e", str(clone)], check=True)
    script = tmp_path / "script.py"
    script.write_text("import tol3d; print(tol3d.__file__); import tol3d.errors; tol3d.Tol3dError", "utf-8")
    done = subprocess.run([str(python), str(script)], capture_output=True, text=True, check=True)
    assert Path(done.stdout.strip()) == clone / "tol3d" / "__init__.py"
    listed = subprocess.run(
        [str(python), "-m", "pip", "show", "-f", "tol3d"], capture_output=True, text=True, check=True
    )
    assert "_tol3d_past_namespace.pth" in listed.stdout
    subprocess.run([str(python), "-m", "pip", "uninstall", "-qy", "tol3d"], check=True)
    assert not list((tmp_path / "venv").rglob("*past_namespace*.p*"))


@pytest.mark.slow  # the same
def test_a_source_archive_builds_its_wheel(tmp_path: Path) -> None:
    clone = tree_at(tmp_path / "tol3d")
    subprocess.run([sys.executable, "-m", "build", "--outdir", str(tmp_path / "dist"), str(clone)], check=True)
    (archive,) = (tmp_path / "dist").glob("*.tar.gz")
    version = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    with tarfile.open(archive) as files:
        assert f"tol3d-{version}/.build/past_namespace.py" in files.getnames()
    assert len(list((tmp_path / "dist").glob("*.whl"))) == 1
