"""A picture of the local app, as its user sees it, by headless Chromium.

    PYTHONPATH=tests python docs/app_picture.py SCENE [--measure NAME] [--tried LINE=FACTOR] [--moving LINE=FACTOR]
        [--lit] [--no-names] [--out app.png] [--size 1400 900]

`--tried` releases the slider of a tolerance, `--moving` holds it, so that the estimate is still there; `--lit` lights
the parts that act on the measure, `--no-names` leaves out names in 3D. tests/browser.py drives Chromium.
"""

import argparse
import base64
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from browser import Page, browser

SCENES: Final = Path(__file__).resolve().parent.parent / "scenes"
STEPS_OF_FACTOR: Final = 1 / math.log(1.01)
"""Steps of a slider of the app by the logarithm of the factor."""
SHOWN: Final = (
    "!!document.querySelector('#answer .verdict') && document.querySelector('#progress').hidden"
    " && !!document.querySelector('#sliders .share') && !!document.querySelector('#stage canvas')"
    " && !/building|drawing/.test(document.querySelector('#stage-words').textContent)"
)
"""The card has all its trials, the sliders have their shares, and the assembly is drawn."""

HELD: Final = "!!document.querySelector('#chart .dashed')"
RELEASED: Final = f"!{HELD} && !!document.querySelector('#answer td.dim')"
"""The estimate is there; or numbers of the scene beside those of what is tried."""


@contextmanager
def opened(scene: str) -> Iterator[tuple[Page, Path]]:
    """Within it the app's page of a bundled scene, and the folder that it has open, a copy with files beside it."""
    with tempfile.TemporaryDirectory() as place, browser() as page:
        folder = Path(place) / "scenes"
        folder.mkdir()
        shutil.copy(SCENES / f"{scene}.yaml", folder)
        for file in (*SCENES.glob("*.stp"), *SCENES.glob("*.csv")):
            shutil.copy(file, folder)
        command = [str(Path(sys.executable).with_name("tol3d")), "app", str(folder / f"{scene}.yaml"), "--no-browser"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as app:
            try:
                assert app.stdout is not None
                address = re.search(r"http://\S+", app.stdout.readline())
                assert address, "the app has not started"
                page.open(address[0])
                yield page, folder
            finally:
                app.terminate()


def slid(page: Page, line: str, factor: float, event: str) -> None:
    """Move the slider of a tolerance; "change" releases it, "input" holds it."""
    step = round(STEPS_OF_FACTOR * math.log(factor))
    page.ask(
        "((line, step, event) => {"
        " const every = [...document.querySelectorAll('#sliders input[type=range]')];"
        " const own = every.find(one => one.dataset.line === line);"
        " own.value = step; own.dispatchEvent(new Event(event, {bubbles: true})); })"
        f"(...{json.dumps([line, step, event])})"
    )


def draw(given: argparse.Namespace) -> None:
    """Draw it."""
    with opened(given.scene) as (page, _):
        page.call(
            "Emulation.setDeviceMetricsOverride",
            width=given.size[0], height=given.size[1], deviceScaleFactor=1, mobile=False,
        )  # fmt: skip
        page.wait(SHOWN)
        if given.measure:
            page.ask(f"tol3dApp.choose({json.dumps(given.measure)})")
            page.wait(SHOWN)
        for box, wanted in (("#lit", given.lit), ("[name=names]", given.no_names)):
            if wanted:
                page.ask(f"document.querySelector('{box}').click()")
        for moved, event in ((given.tried, "change"), (given.moving, "input")):
            for own in moved:
                line, _, factor = own.rpartition("=")
                slid(page, line, float(factor), event)
                page.wait(HELD if event == "input" else f"{RELEASED} && {SHOWN}")
        page.ask("new Promise(done => setTimeout(done, 1000))")  # the camera comes to rest
        found = page.call("Page.captureScreenshot", format="png")
        given.out.write_bytes(base64.b64decode(found["data"]))


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw a picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--measure", default="")
    parser.add_argument("--tried", action="append", default=[])
    parser.add_argument("--moving", action="append", default=[])
    parser.add_argument("--lit", action="store_true")
    parser.add_argument("--no-names", action="store_true")
    parser.add_argument("--out", type=Path, default=Path("app.png"))
    parser.add_argument("--size", type=int, nargs=2, default=[1400, 900])
    draw(parser.parse_args(arguments))


if __name__ == "__main__":
    main()
