"""Installation by a user: a wheel, in an empty environment's place, runs a scene by its name."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from places import ROOT


@pytest.mark.slow
def test_a_scene_runs_by_name_from_a_built_wheel_in_an_empty_folder(tmp_path: Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--outdir", str(tmp_path / "dist"), str(ROOT)],
        check=True,
        capture_output=True,
    )
    (wheel,) = (tmp_path / "dist").glob("*.whl")
    site, empty = tmp_path / "site", tmp_path / "empty"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    empty.mkdir()
    # -S -E would hide the dependencies; putting the unpacked wheel first hides the checkout instead
    code = (
        f"import sys; sys.path.insert(0, {str(site)!r}); sys.meta_path[:] = "
        "[f for f in sys.meta_path if 'editable' not in type(f).__module__ + getattr(f, '__module__', '')]\n"
        "import tol3d; assert tol3d.__file__.startswith(sys.path[0]), tol3d.__file__\n"
        "from tol3d import cli; sys.argv = ['tol3d', 'run', 'spur_pair', '--trials', '50']; cli.main()"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=empty, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "normal backlash" in done.stdout
    assert (empty / "runs" / "spur_pair" / "summary.json").is_file()
    with zipfile.ZipFile(wheel) as archive:
        starters = {name for name in archive.namelist() if "/starters/" in name}
    here = {str(path.relative_to(ROOT)) for path in (ROOT / "tol3d").rglob("starters/*.yaml")}
    assert starters == here, "what `tol3d new` writes"
