"""Not a speed benchmark: damaged STEP files, drawn by a seed, each of which must be read or refused in one line.

    python benchmarks/step_mutations.py [--seed 1] [--number 200]

Small valid files (a block, an assembly, an assembly whose part stands in another file) are damaged in one of nine ways,
then read and drafted as `tol3d new --from` does. Counted is what is read, drafted, refused in one line, and what is a
fault: a traceback, a message of several lines, no end within SECONDS, a connection, or a file that is opened outside
of the folder although the damaged text names it. With a fault the program ends with 1 and its seed. What is read is
kept in the cache as always.
"""

import argparse
import contextlib
import os
import random
import re
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import cadquery as cq
from cadquery.occ_impl.assembly import toCAF
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs

from tol3d.apps.drafting import scene_from
from tol3d.cad.step.reading import MEGABYTES_VARIABLE, SECONDS_VARIABLE, read_step
from tol3d.errors import InputError
from tol3d.files import FileContent

SECONDS: Final = 60
"""Longest time by the clock for each file; Open CASCADE may have WORKER_SECONDS of computing."""
WORKER_SECONDS: Final = 10
LONGEST: Final = 600  # characters of a message
OUTSIDE: Final = ("/etc/hostname", "../secret.stp", "https://example.invalid/part.stp", "file:///etc/hostname")

Outcome = Literal["read", "drafted", "refused", "fault"]


@dataclass(frozen=True)
class Tried:
    """A damaged file that was tried.

    Args:
        outcome: of it.
        words: the message, or the reason of a fault.
        seconds: by the clock.
    """

    outcome: Outcome
    words: str
    seconds: float


def bases(folder: Path) -> dict[str, str]:
    """Texts of valid files, by the name of each; "plate.stp" is the other file of the last."""
    plate = cq.Workplane().box(60, 40, 10).faces(">Z").workplane().pushPoints([(-10, 0), (15, 5)]).cboreHole(6, 11, 4)
    block = plate.edges("|Z").fillet(3).cut(cq.Workplane().sphere(6).translate((0, -20, 5)))
    pin = cq.Workplane().circle(3).extrude(20)
    made = cq.Assembly(name="all")
    made.add(block, name="block", loc=cq.Location(cq.Vector(1, 2, 3)))
    for k, x in enumerate((-10, 15)):
        made.add(pin, name=f"pin {k}", loc=cq.Location(cq.Vector(1 + x, 2 + k * 5, -5)))
    with contextlib.chdir(folder):
        cq.exporters.export(block, "block.stp", "STEP")
        made.export("assembly.stp", exportType="STEP")
        writer = STEPCAFControl_Writer()
        writer.Transfer(toCAF(made)[1], STEPControl_AsIs, "part_")
        writer.Write("parted.stp")
    return {path.name: path.read_text("latin-1") for path in sorted(folder.glob("*.stp"))}


def _at(pattern: str, text: str, draw: random.Random) -> re.Match[str] | None:
    """One place of a pattern in the data."""
    found = list(re.finditer(pattern, text[text.index("DATA;") :]))
    return draw.choice(found) if found else None


def _put(pattern: str, new: Callable[[re.Match[str]], str], text: str, draw: random.Random) -> str:
    """The text with one place of a pattern replaced."""
    first, found = text.index("DATA;"), _at(pattern, text, draw)
    return text if found is None else text[: first + found.start()] + new(found) + text[first + found.end() :]


def _noise(text: str, draw: random.Random) -> str:
    signs = list(text)
    for _ in range(draw.choice((1, 3, 30))):
        signs[draw.randrange(text.index("DATA;"), len(signs))] = chr(draw.randrange(256))
    return "".join(signs)


def _references(text: str, draw: random.Random) -> str:
    numbers = re.findall(r"\n#(\d+)\s*=", text)
    for _ in range(draw.choice((1, 4))):
        text = _put(r"(?<=[(,])#\d+", lambda _: f"#{draw.choice(numbers)}", text, draw)
    return text


def _loop(text: str, draw: random.Random) -> str:
    """An instance that refers to itself, or to one that refers to it."""
    return _put(r"(?s)#(\d+)(\s*=[^;]*?)#\d+", lambda own: f"#{own[1]}{own[2]}#{own[1]}", text, draw)


def _huge(text: str, draw: random.Random) -> str:
    """A huge whole number, a list of 50 000 members, or 3 000 uses of one part."""
    which = draw.randrange(3)
    if which == 0:
        return _put(
            r"(?<=[(,])\d+(?=[,)])", lambda _: draw.choice(("2147483648", "1000000000", "99999999999")), text, draw
        )
    if which == 1:
        return _put(r"\((#\d+)(?=[,)])", lambda own: "(" + ",".join([own[1]] * 50_000), text, draw)
    use = re.search(r"\n#\d+ = (NEXT_ASSEMBLY_USAGE_OCCURRENCE[^;]*;)", text)
    more = "".join(f"\n#{900_000 + k} = {use[1]}" for k in range(3_000)) if use else ""
    return text.replace("\nENDSEC;\nEND-ISO", f"{more}\nENDSEC;\nEND-ISO")


def _elsewhere(text: str, draw: random.Random) -> str:
    """External references that leave the folder: of the file's own parts, or an anchor of edition 3."""
    outside = draw.choice(OUTSIDE)
    if "part_" in text and draw.random() < 0.7:
        return re.sub(r"part_\w+\.stp", lambda _: outside, text)
    return text.replace("DATA;", f"REFERENCE;\n#900001=<{outside}#top>;\nENDSEC;\nDATA;", 1)


def _bare(text: str, draw: random.Random) -> str:
    """A face without its surface, without bounds, or with the surface of none."""
    new = draw.choice((r"\1(),\3", r"\1\2,$", r"\1\2,*"))
    return _put(r"(?s)(ADVANCED_FACE\('[^']*',)(\([^)]*\)),(#\d+)", lambda own: own.expand(new), text, draw)


def _cut(text: str, draw: random.Random) -> str:
    return text[: draw.randrange(200, len(text))]


def _numbers(text: str, draw: random.Random) -> str:
    """A number that is none, or no length of a part."""
    wrong = (
        "1.E300",
        "1.E400",
        "-1.E400",
        "NAN",
        "1.#INF",
        "-0.",
        "0.",
        "-7.5",
        "1.E-300",
        "1.E11",
        "''",
        "$",
        ".T.",
        "1.2.3",
    )
    for _ in range(draw.choice((1, 5))):
        text = _put(r"-?\d+\.\d*(?:E[-+]?\d+)?", lambda _: draw.choice(wrong), text, draw)
    return text


def _deep(text: str, draw: random.Random) -> str:
    """Brackets in each other, or a text of a megabyte."""
    if draw.random() < 0.5:
        return _put(r"\(", lambda _: "(" * draw.choice((70, 100_000)), text, draw)
    return _put(r"'[^'\n]*'", lambda _: "'" + draw.choice(("A", "\\X2\\00E9\\X0\\", "''")) * 100_000 + "'", text, draw)


DAMAGES: Final[Mapping[str, Callable[[str, random.Random], str]]] = {
    "noise": _noise, "wrong references": _references, "loops": _loop, "huge counts": _huge,
    "files elsewhere": _elsewhere, "faces without surface": _bare, "cut": _cut, "wrong numbers": _numbers,
    "depth and length": _deep,
}  # fmt: skip


class _Late(BaseException):
    """A file has taken too long; not an Exception, so that nothing catches it on the way."""


@contextlib.contextmanager
def within(seconds: float) -> Iterator[None]:
    """End what takes longer."""

    def late(*_: Any) -> None:
        raise _Late

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


WATCHED: list[str] = []
"""Requests to a network, and files opened by names in damaged files; audit hooks stay as long as the process."""


def watch() -> None:
    """Note connections and files outside, from now on."""

    def note(event: str, arguments: tuple[Any, ...]) -> None:
        if event in ("socket.connect", "socket.getaddrinfo", "urllib.Request"):
            WATCHED.append(f"{event}")
        if event == "open" and str(arguments[0]).endswith(("/etc/hostname", "secret.stp")):
            WATCHED.append(f"opened {arguments[0]}")

    sys.addaudithook(note)


def tried(text: str, folder: Path, *, drafts: bool = True) -> Tried:
    """A damaged file, read as a user's.

    Args:
        text: of it.
        folder: in which the files are that it may refer to.
        drafts: whether a scene is drafted of what is read.
    """
    start, content = time.perf_counter(), FileContent(folder / "damaged.stp", text.encode("latin-1"))
    WATCHED.clear()
    outcome: Outcome = "read"
    words = ""
    try:
        with within(SECONDS):
            read_step(content)
            if drafts:
                scene_from([content])
                outcome = "drafted"
    except InputError as error:
        outcome, words = "refused", str(error)
        if "\n" in words or not words.isprintable() or len(words) > LONGEST:
            outcome = "fault"
    except _Late:
        outcome, words = "fault", f"no end within {SECONDS} s"
    except Exception as error:
        outcome, words = "fault", f"{type(error).__name__}: {error}"[:LONGEST]
    if WATCHED:
        outcome, words = "fault", WATCHED[0]
    return Tried(outcome, words, time.perf_counter() - start)


def variants(texts: Mapping[str, str], seed: int, number: int) -> Iterator[tuple[int, str, str, str]]:
    """Damaged files: the number, the base, the kind of damage, the text; each by its own number and the seed alone."""
    names, kinds = [name for name in texts if not name.startswith("part_")], sorted(DAMAGES)
    for k in range(number):
        draw, kind = random.Random(f"{seed} {k}"), kinds[k % len(kinds)]
        text, base = "", names[0]
        while text in ("", texts[base]):  # some have nothing of the kind to damage
            base = draw.choice(names)
            text = DAMAGES[kind](texts[base], draw)
        yield k, base, kind, text


def main(arguments: Sequence[str] | None = None) -> int:
    """Damage, read and count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--number", type=int, default=200)
    given = parser.parse_args(arguments)
    os.environ |= {SECONDS_VARIABLE: str(WORKER_SECONDS), MEGABYTES_VARIABLE: "4000"}
    counts: dict[str, Counter[str]] = {kind: Counter() for kind in DAMAGES}
    longest, faults = 0.0, list[str]()
    watch()
    with tempfile.TemporaryDirectory() as name:
        inner = Path(name) / "inner"
        inner.mkdir()
        texts = bases(inner)
        (Path(name) / "secret.stp").write_text(texts["block.stp"], "latin-1")
        for k, base, kind, text in variants(texts, given.seed, given.number):
            found = tried(text, inner)
            counts[kind][found.outcome] += 1
            longest = max(longest, found.seconds)
            if found.outcome == "fault":
                faults.append(f"fault in number {k} of seed {given.seed} ({kind} of {base}): {found.words}")
    for kind, count in counts.items():
        print(f"{kind:22} {count['drafted']:4} drafted {count['refused']:4} refused {count['fault']:4} faults")
    print(f"{given.number} files, the longest {longest:.1f} s; {len(faults)} faults", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
