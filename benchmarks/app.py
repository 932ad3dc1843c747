"""Latencies of the local app, `tol3d app`: its page's questions, each with the scene open and kernels compiled.

    python benchmarks/app.py [SCENE …] [--times 30]
    PYTHONPATH=docs:tests python benchmarks/app.py --browser [SCENE …] [--times 30]

Prints medians, in ms of time and of a processor, for the measure on which the most tolerances act; one of these moves
to another width each time. A card is timed until all its builds are evaluated; the page asks for them in pieces of
0.35 s. With --browser it prints the time from a slider's event to the frame that shows the dashed curve, in headless
Chromium.
"""

import argparse
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from statistics import median
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.questions import Questions
from tol3d.apps.workbench.session import Session
from tol3d.apps.workbench.workspace import Workspace

SCENES: Final = Path(__file__).resolve().parent.parent / "scenes"
NAMED: Final = ("spur_pair", "door", "bracket_in_box")
SMALLEST_STEP: Final = 1e-4
"""Between two factors of a tolerance, so that no answer is there already."""
MS: Final = 1000.0
DRAWN: Final = """
(step => new Promise(done => {
  const own = document.querySelector("#sliders input[type=range]"), chart = document.getElementById("chart");
  new MutationObserver((_, observer) => {
    observer.disconnect();
    requestAnimationFrame(() => setTimeout(() => done(performance.now() - begun)));
  }).observe(chart, { childList: true });
  own.value = step;
  const begun = performance.now();
  own.dispatchEvent(new Event("input", { bubbles: true }));
}))"""
"""Time in which the page shows the estimate for a step of its first slider [ms]."""


@dataclass
class Taken:
    """Times of a question.

    Args:
        elapsed: of each answer [s].
        processor: of each answer, all threads [s].
    """

    elapsed: list[float] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)

    @contextmanager
    def once(self) -> Iterator[None]:
        """Time what is done within."""
        begun, used = time.perf_counter(), time.process_time()
        yield
        self.elapsed.append(time.perf_counter() - begun)
        self.processor.append(time.process_time() - used)


@dataclass
class Asked:
    """The app with one scene open.

    Args:
        questions: of its folder.
        name: of the scene's file.
        measure: the chosen one.
        line: tolerance that moves.
        factors: of its width, each another one.
    """

    questions: Questions
    name: str
    measure: str
    line: str
    factors: Iterator[float]

    @classmethod
    def of(cls, questions: Questions, name: str) -> "Asked":
        """With the measure on which the most tolerances act, and the first of these that can be scaled."""
        session = questions.session(name)
        measure = max(session.response.measures, key=lambda own: len(session.acting(own.name))).name
        scopes = ((line, session.response.scope(line).factors) for line in session.acting(measure))
        line, (_, high) = next((line, ends) for line, ends in scopes if ends is not None)
        step = SMALLEST_STEP if high > 1.0 else -SMALLEST_STEP
        return cls(questions, name, measure, line, (1.0 + step * k for k in count(1)))

    @property
    def session(self) -> Session:
        """The open scene."""
        return self.questions.session(self.name)

    def words(self, *, moved: bool = False, **more: Any) -> Mapping[str, Any]:
        """A question's words; with the tolerance moved to another width than ever."""
        now = {self.line: f"x{next(self.factors):.6g}"} if moved else {}
        return {"scene": self.name, "measure": self.measure, "now": now, **more}

    def whole_card(self, words: Mapping[str, Any]) -> None:
        """Ask until all builds are evaluated, as the page does."""
        while (found := self.questions.card(words))["done"] < found["of"]:
            pass

    def forget(self) -> None:
        """Evaluated builds and slopes, so that a card is the first."""
        self.session._evaluated.clear()
        self.session._moved.clear()

    def by_question(self, times: int) -> Mapping[str, Taken]:
        """Times of each question."""
        questions, text = self.questions, self.session.content.decode("utf-8")
        questions.sliders(self.words())
        for run in questions.runs.values():
            run.result()  # shares are there, and nothing else works
        asked: Mapping[str, Callable[[Mapping[str, Any]], object]] = {
            "scene": questions.scene,
            "card, first": self.whole_card,
            "estimate, first": questions.estimate,
            "estimate while moving": questions.estimate,
            "card after release": self.whole_card,
            "sliders": questions.sliders,
            "check": questions.check,
            "keep": questions.keep,
        }
        found = {name: Taken() for name in asked}
        for name, question in asked.items():
            for _ in range(times + 1):
                if name == "card, first":
                    self.forget()
                if name == "estimate, first":
                    self.session._moved.clear()
                words = self.words(moved=name not in ("scene", "card, first", "sliders", "check"), text=text)
                with found[name].once():
                    question(words)
            found[name].elapsed.pop(0), found[name].processor.pop(0)  # warm from the second on
        return found


@contextmanager
def opened(scene: str) -> Iterator[Asked]:
    """Within it a bundled scene in a folder of its own, with the files that scenes name."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        for file in (SCENES / f"{scene}.yaml", *SCENES.glob("*.stp"), *SCENES.glob("*.csv")):
            shutil.copy(file, folder)
        workspace = Workspace.of(folder / f"{scene}.yaml")
        questions = Questions(workspace, stack.enter_context(FolderLock(workspace.folder)))
        stack.callback(questions.close)
        yield Asked.of(questions, workspace.first)


def print_questions(scenes: Sequence[str], times: int) -> None:
    """Print the times of each question."""
    table = Table("scene", "measure", "trials", "question", "ms", "ms of a processor")
    for scene in scenes:
        with opened(scene) as asked:
            trials = asked.session.builds
            for question, taken in asked.by_question(times).items():
                numbers = (f"{MS * median(own):.2f}" for own in (taken.elapsed, taken.processor))
                table.add_row(scene, asked.measure, str(trials), question, *numbers)
    Console(width=120).print(table)


def print_shown(scenes: Sequence[str], times: int) -> None:
    """Print the time until a dashed curve is on the screen."""
    from app_picture import SHOWN
    from app_picture import opened as opened_page

    for scene in scenes:
        with opened_page(scene) as (page, _):
            page.wait(SHOWN)
            found = [page.ask(f"{DRAWN}({1 + k % 2})") for k in range(times + 2)][2:]
            print(f"{scene}: dashed curve on the screen after {median(found):.0f} ms, at most {max(found):.0f} ms")


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=NAMED, metavar="SCENE")
    parser.add_argument("--times", type=int, default=30)
    parser.add_argument("--browser", action="store_true")
    given = parser.parse_args(arguments)
    (print_shown if given.browser else print_questions)(given.scenes, given.times)


if __name__ == "__main__":
    main()
