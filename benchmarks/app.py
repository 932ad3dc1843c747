"""Latencies of the local app, `tol3d app`: its page's questions, each with the scene open and kernels compiled.

    python benchmarks/app.py [SCENE …] [--times 30]
    python benchmarks/app.py --every [SCENE …]
    PYTHONPATH=docs:tests python benchmarks/app.py --browser [SCENE …] [--times 30]

Prints medians, in ms of time and of a processor, for the measure on which the most tolerances act; one of these moves
to another width each time. A card is timed until all its builds are evaluated, an estimate until it is there; the page
asks for them in pieces of 0.3 s.

With --every it prints one row for each scene, all bundled ones by default, as a table of Markdown, in s, in brackets s
of a processor: opening; from the release of a slider to the first simulated builds, with their number; until the first
estimate, "none" where slopes would take too long; and the longest answer but opening.

With --browser it prints the time from a slider's event to the frame that shows the dashed curve, in headless Chromium.
"""

import argparse
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future
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
from tol3d.study.runs.run import Run

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

    def estimate(self, words: Mapping[str, Any]) -> None:
        """Ask until the estimate is there, as the page does."""
        while self.questions.estimate(words).get("waits"):
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
            "estimate, first": self.estimate,
            "estimate while moving": self.estimate,
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


@dataclass(eq=False)
class Alone(Questions):
    """Questions without the run of shares, so that nothing works beside."""

    def _run(self, name: str, session: Session) -> "Future[Run]":
        return Future()


@contextmanager
def folder_of(scene: str, kind: type[Questions] = Questions) -> Iterator[Questions]:
    """Within it a bundled scene in a folder of its own, with the files that scenes name; not read yet."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        for file in (SCENES / f"{scene}.yaml", *SCENES.glob("*.stp"), *SCENES.glob("*.csv")):
            shutil.copy(file, folder)
        workspace = Workspace.of(folder / f"{scene}.yaml")
        questions = kind(workspace, stack.enter_context(FolderLock(workspace.folder)))
        stack.callback(questions.close)
        yield questions


@contextmanager
def opened(scene: str) -> Iterator[Asked]:
    """Within it a bundled scene that is open."""
    with folder_of(scene) as questions:
        yield Asked.of(questions, questions.workspace.first)


@dataclass
class Told:
    """Answers on a scene, one after the other.

    Args:
        questions: of its folder.
        taken: their times, by what was asked.
    """

    questions: Questions
    taken: list[tuple[str, Taken]] = field(default_factory=list)

    def ask(self, name: str, words: Mapping[str, Any]) -> Any:
        """An answer."""
        own = Taken()
        with own.once():
            found = getattr(self.questions, name)(words)
        self.taken.append((name, own))
        return found

    def ask_until(self, name: str, words: Mapping[str, Any], ready: Callable[[Any], bool]) -> Any:
        """Ask until the answer says what is wanted."""
        while not ready(found := self.ask(name, words)):
            pass
        return found

    def since(self, first: int) -> str:
        """Time of all answers from one on."""
        return seconds(
            *(sum(getattr(own, key)[0] for _, own in self.taken[first:]) for key in ("elapsed", "processor"))
        )

    @property
    def longest(self) -> str:
        """Time of the longest answer but for the first, which opens the scene."""
        name, own = max(self.taken[1:], key=lambda each: each[1].processor)
        return f"{seconds(own.elapsed[0], own.processor[0])} {name}"


def seconds(elapsed: float, processor: float) -> str:
    """Both times."""
    return f"{elapsed:.2f} ({processor:.2f})"


def row_of(scene: str) -> Sequence[str]:
    """A scene's times, from opening to the release of a slider."""
    with folder_of(scene, Alone) as questions:
        told, name = Told(questions), questions.workspace.first
        told.ask("scene", {"scene": name})
        opening = told.since(0)
        told.ask_until("sliders", {"scene": name}, lambda found: not found.get("looks"))
        asked = Asked.of(questions, name)
        told.ask_until("card", asked.words(), lambda found: found["done"] == found["of"])
        told.ask("sliders", asked.words())
        moved, first = asked.words(moved=True), len(told.taken)
        none = told.ask_until("estimate", moved, lambda found: not found.get("waits")).get("none")
        estimate = "none" if none else told.since(first)
        first = len(told.taken)
        told.ask_until("card", moved, lambda found: "answer" in found)
        solid, builds = told.since(first), asked.session.evaluated(asked.measure, moved["now"]).done
        told.ask_until("card", moved, lambda found: found["done"] == found["of"])
        return scene, asked.measure, str(asked.session.builds), opening, solid, str(builds), estimate, told.longest


def print_every(scenes: Sequence[str]) -> None:
    """Print a row for each scene, as it is opened a second time."""
    heads = ("scene", "measure", "trials", "opening", "first builds", "of them", "estimate", "longest answer")
    for row in (heads, ("---",) * len(heads)):
        print(f"| {' | '.join(row)} |")
    for scene in scenes:
        row_of(scene)  # compiles or reads kernels
        print(f"| {' | '.join(row_of(scene))} |", flush=True)


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
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--times", type=int, default=30)
    parser.add_argument("--browser", action="store_true")
    parser.add_argument("--every", action="store_true")
    given = parser.parse_args(arguments)
    if given.every:
        print_every(given.scenes or sorted(path.stem for path in SCENES.glob("*.yaml")))
    else:
        (print_shown if given.browser else print_questions)(given.scenes or NAMED, given.times)


if __name__ == "__main__":
    main()
