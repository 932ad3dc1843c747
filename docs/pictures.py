"""Pictures of the pages: drawn as their readers would, by commands of tol3d, examples of a page and benchmarks.

    python docs/pictures.py [NAME.png ...]     # all of them without a name

writes docs/NAME.png and, in docs/pictures.json, the date and checksums of what it shows: its scenes, the sources that
draw it and the picture itself. tests/project/test_docs_pictures.py compares these, so that no picture is older than
what it shows.
"""

import hashlib
import json
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from PIL import Image

HERE: Final = Path(__file__).resolve().parent
TREE: Final = HERE.parent
KEPT: Final = HERE / "pictures.json"
COLOURS: Final = 256
VIEW: Final = ("report/view.py", "report/whole.py", "report/drawn_solids.py")
CLOSE_UP: Final = (*VIEW, "gearing/presenting/panels.py", "gearing/presenting/gear_display.py")
CHART: Final = ("report/chart.py", "report/chart_figure.py", "report/drawn_chart.py", "report/measure_charts.py")
HISTOGRAM: Final = ("report/histogram.py", "report/picture.py", "report/share_charts.py", "report/bars.py", *CHART)
APP: Final = (
    *("docs/app_picture.py", "apps/workbench/card.py", "apps/workbench/tree.py"),
    *("apps/workbench/page/index.html", "apps/workbench/page/app.css"),
)
CURVE_ALONE: Final = """
from pathlib import Path
from tol3d import load_scene
scene = load_scene("two_sided_te")
curve = {"drive TE curve": scene.measures["drive TE curve"]}
Path("curve.yaml").write_text(scene.model_copy(update={"measures": curve}).dump(), "utf-8")
"""


@dataclass(frozen=True)
class Picture:
    """A picture of the pages, by the commands that draw it.

    Args:
        commands: in an empty folder; `python:PAGE:WORD` runs the first example of a page that holds a
            word, `yaml:PAGE:FILE` writes the first scene of a page to a file.
        drawn: the file that they write.
        sources: files of the tree, or of tol3d/, that draw it.
        scenes: bundled scenes that it shows.
        width: of the kept picture [pixels]; 0 keeps it as it is.
    """

    commands: tuple[str, ...]
    drawn: str
    sources: tuple[str, ...]
    scenes: tuple[str, ...] = ()
    width: int = 0


def viewed(scene: str, options: str, sources: tuple[str, ...] = VIEW, width: int = 1200) -> Picture:
    """A build of a bundled scene in 3D."""
    run = f"tol3d run {scene} --out run --no-picture"
    return Picture((run, f"tol3d view run {options} --screenshot view.png"), "view.png", sources, (scene,), width)


def animated(scene: str, options: str) -> Picture:
    """A build of a bundled scene that moves."""
    run, view = f"tol3d run {scene} --out run --no-picture", f"tol3d view run {options} --animate view.webp"
    return Picture((run, view), "view.webp", ("report/animation.py", *VIEW), (scene,))


def charted(scene: str, name: str, *sources: str) -> Picture:
    """A picture that a run of a bundled scene leaves in its folder."""
    return Picture((f"tol3d run {scene} --out run",), f"run/{name}", sources, (scene,))


def app(scene: str, options: str) -> Picture:
    """The local app with a bundled scene."""
    program = f"env PYTHONPATH={TREE}/tests {sys.executable} {TREE}/docs/app_picture.py"
    return Picture((f"{program} {scene} {options}",), "app.png", APP, (scene,))


PICTURES: Final[Mapping[str, Picture]] = {
    "app.png": app("spur_pair", '--tried "centre distance=1.65"'),
    "app_assembly.png": app(
        "bracket_in_box", '--measure "right 1 across" --lit --no-names --moving "right bore position=2"'
    ),
    "bevel_contact.png": viewed("bevel_pair", "--trial 5 --magnify 8", CLOSE_UP),
    "builders.png": viewed("machined_parts", "--nominal"),
    "carrier_opening.webp": animated("reducer_3k_flexible", "--mean --magnify 8 --frames 12"),
    "compensation.png": Picture(
        ("tol3d compensate robot_shoulder robot_shoulder_shimmed --out compensation.png",),
        "compensation.png",
        ("apps/adjustment/compensation_picture.py", *CHART),
        ("robot_shoulder", "robot_shoulder_shimmed"),
    ),
    "contact.png": viewed("spur_pair", "--trial 175 --magnify 10", CLOSE_UP),
    "convergence.png": Picture(
        (f"{sys.executable} {TREE}/benchmarks/convergence.py --out convergence.png",),
        "convergence.png",
        ("benchmarks/convergence.py",),
    ),
    "cover_on_base.png": viewed("cover_on_base", "--worst --magnify 20"),
    "cycloid_profile.png": Picture(
        (f"{sys.executable} {TREE}/benchmarks/disc_profile.py --out cycloid_profile.png",),
        "cycloid_profile.png",
        ("benchmarks/disc_profile.py",),
    ),
    "gear_engineers.png": Picture(
        ("yaml:gear_engineers.md:edited.yaml", "tol3d run edited.yaml --out run"), "run/histogram.png", HISTOGRAM
    ),
    "gearbox.png": viewed("gearbox_in_housing", "--worst"),
    "helical_gearbox.png": viewed("helical_gearbox", "--worst"),
    "records.png": Picture(
        (
            "yaml:records.md:pair.yaml",
            'tol3d rig pair.yaml --e1 "18 um" --theta1 "40 deg" --e2 "27 um" --theta2 "-65 deg" --backlash "60 um" '
            '--turns 4 --encoder1 "6 arcsec" --encoder2 "4 arcsec" --tooth-mesh "3 arcsec" --out measured',
            "tol3d identify --drive measured/drive.csv --back measured/back.csv --scene pair.yaml --out identified",
        ),
        "identified/backlash.png",
        ("apps/records/identified_picture.py",),
    ),
    "reducer_3k.png": viewed("reducer_3k", "--trial 3"),
    "robot.png": viewed("robot_shoulder", "--mean", CLOSE_UP),
    "robot_arm.png": Picture(
        (
            "tol3d run robot_arm --trials 20 --out run --no-picture",
            "tol3d view run --nominal --screenshot view.png",
        ),
        "view.png",
        (*VIEW, "gearing/machine/presenting/trains_in_joints.py"),
        ("robot_arm",),
        1200,
    ),
    "robot_chain.png": charted(
        "robot_shoulder", "chain.png", "gearing/presenting/chain.py", "gearing/presenting/chain_bars.py"
    ),
    "rv_rolling.webp": animated("rv_250aii", "--trial 3 --magnify 10 --frames 16"),
    "spur_pair.png": charted("spur_pair", "histogram.png", *HISTOGRAM),
    "torque_curve.png": Picture(
        (f"ln -s {TREE}/scenes scenes", "python:planetary.md:torque_curve.png"),
        "torque_curve.png",
        ("gearing/planetary/hysteresis_picture.py",),
        ("reducer_3k_flexible",),
    ),
    "two_sided_te.png": Picture(
        (f"{sys.executable} -c '{CURVE_ALONE}'", "tol3d run curve.yaml --out run"),
        "run/histogram.png",
        CHART,
        ("two_sided_te",),
    ),
}


def checksum(path: Path) -> str:
    """The first digits of the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def shown_by(picture: Picture) -> dict[str, str]:
    """Checksums of what a picture shows, by the file's place in the tree."""
    scenes = [TREE / "scenes" / f"{name}.yaml" for name in picture.scenes]
    sources = [own if (own := TREE / name).is_file() else TREE / "tol3d" / name for name in picture.sources]
    return {path.relative_to(TREE).as_posix(): checksum(path) for path in (*scenes, *sources)}


def kept() -> dict[str, dict[str, object]]:
    """The entry of each picture: when it was drawn, its own checksum and those of what it shows."""
    return dict(json.loads(KEPT.read_text("utf-8"))) if KEPT.exists() else {}


def draw(name: str) -> None:
    """Draw a picture anew and write down what it shows."""
    picture = PICTURES[name]
    with tempfile.TemporaryDirectory() as folder:
        for command in picture.commands:
            _run(command, folder)
        drawn = Path(folder) / picture.drawn
        if drawn.suffix == ".png":
            _save(Image.open(drawn), HERE / name, picture.width)
        else:
            (HERE / name).write_bytes(drawn.read_bytes())
    today = datetime.now(UTC).date().isoformat()
    entries = kept() | {name: {"drawn": today, "picture": checksum(HERE / name), "shows": shown_by(picture)}}
    KEPT.write_text(json.dumps(dict(sorted(entries.items())), indent=1) + "\n", "utf-8")


def _run(command: str, folder: str) -> None:
    if command.startswith("yaml:"):
        _, page, file = command.split(":")
        Path(folder, file).write_text(_examples(page, "yaml")[0], "utf-8")
        return
    if command.startswith("python:"):
        _, page, word = command.split(":")
        arguments = [sys.executable, "-c", next(text for text in _examples(page, "python") if word in text)]
    else:
        program, *rest = shlex.split(command)
        arguments = [str(Path(sys.executable).with_name(program)) if program == "tol3d" else program, *rest]
    subprocess.run(arguments, cwd=folder, check=True, stdout=subprocess.DEVNULL)


def _examples(page: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", (HERE / page).read_text("utf-8"), re.MULTILINE | re.DOTALL)


def _save(image: Image.Image, path: Path, width: int) -> None:
    """Save it in that width; a chart, which has few colours, with a palette, which takes a third of the bytes."""
    image = image.convert("RGB")
    if width:
        image = image.resize((width, round(image.height * width / image.width)), Image.Resampling.LANCZOS)
    else:
        image = image.quantize(COLOURS, dither=Image.Dither.NONE)
    image.save(path, optimize=True)


def main(arguments: list[str]) -> None:
    """Draw the named pictures, or all."""
    for name in arguments or [*PICTURES]:
        draw(name)
        print(name, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
