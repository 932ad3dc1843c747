"""Runs beside each other as tables: mean, sigma and range of each run and road, and how far the roads differ."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text

from tol3d.errors import InputError
from tol3d.report.column import seated_text
from tol3d.report.difference import difference_of
from tol3d.report.ends import is_bounded
from tol3d.report.heading import heading, reading_words
from tol3d.report.number import NOTHING, UNIT_SIGNS, difference_text, share_text, value_text
from tol3d.report.sheet import Heading, Row, Sheet, note
from tol3d.runs.run import Run

Summary = Mapping[str, Any]

NO_ONE_MEAN = "no row: it is 0 with the load on one side and jumps where the load changes side; the picture shows it"
SHOWN_APART = "not all of these runs read it alike, at the same positions and teeth: shown apart"
ENDS_BEFORE = "trials end before mean ∓ 3 sigma here: low and high are no ends of theirs"
SHORT = {"analytic": "analytic", "geometric": "3D"}
KEYS = ("mean", "sigma", "low_3sigma", "high_3sigma")


@dataclass(frozen=True)
class Compared:
    """A measure as runs may share it on one axis; the same name over other positions is another measure.

    Args:
        name, unit, kind, over, take, reading: as in its summary.
        at: the gear whose angle it is, the shaft that is read, or the point of an arm.
    """

    name: str
    unit: str
    kind: str
    at: str | None
    over: str
    take: str
    reading: str

    @classmethod
    def of(cls, name: str, measure: Summary) -> "Compared":
        """From a measure's summary."""
        unit, kind, over, take = (measure[key] for key in ("unit", "kind", "over", "take"))
        at = measure["gear"] or measure.get("point") or measure.get("shaft")
        return cls(name, unit, kind, at, over, take, reading_words(measure))

    @property
    def jumps(self) -> bool:
        """Whether it is a curve whose mean over its positions says nothing: many of them are 0."""
        return (self.kind, self.take) == ("tip_error", "curve")

    def found_in(self, runs: Sequence[Run]) -> list[tuple[str, Run]]:
        """The runs that have it, each with its label."""
        return [(label, run) for label, run in labelled(runs) if self in measures_of([run])]


def measures_of(runs: Sequence[Run]) -> list[Compared]:
    """The measures of all runs, each once.

    Raises:
        InputError: there are no runs.
    """
    if not runs:
        raise InputError("nothing to compare: give the folder of at least one run")
    found = (Compared.of(name, measure) for run in runs for name, measure in run.summary["measures"].items())
    return list(dict.fromkeys(found))


def comparison_report(runs: Sequence[Run]) -> Group:
    """Tables of every measure: mean, sigma and range of each run and road, and how far the roads differ."""
    blocks: list[RenderableType] = []
    for measure in measures_of(runs):
        own = measure.found_in(runs)
        blocks += [Text("\n").append(measure.name, style="bold cyan")]
        blocks += [Text(heading(own[0][1].summary["measures"][measure.name]), style="dim")]
        blocks += [note(NO_ONE_MEAN)] if measure.jumps else ["", _table(measure.name, measure.unit, own)]
        blocks += [note(SHOWN_APART)] if len(own) < _named_alike(measure.name, runs) else []
        bounded = any(is_bounded(run.summary["measures"][measure.name]) for _, run in own)
        blocks += [note(ENDS_BEFORE)] if bounded else []
    words = "low and high: mean ∓ 3 sigma; max and rms: of 3D simulation − analytic, trial by trial"
    words += (
        "; means and sigmas are of the trials that seated, out of limits is of all of them" if _any_failed(runs) else ""
    )
    words += "; shift: of the mean against the first run" if len(runs) > 1 else ""
    blocks.append(Text(f"\n{words}", style="dim"))
    return Group(*blocks)


def _named_alike(name: str, runs: Sequence[Run]) -> int:
    return sum(name in run.summary["measures"] for run in runs)


def _any_failed(runs: Sequence[Run]) -> bool:
    return any(seated_text(measure) for run in runs for measure in run.summary["measures"].values())


def labelled(runs: Sequence[Run]) -> list[tuple[str, Run]]:
    """Each run with as much of its folder's path, from the end, as tells it from the others."""
    paths = [run.path.resolve() for run in runs]
    labels = [_end_of(path, [other for other in paths if other != path]) for path in paths]
    return list(zip(labels, runs, strict=True))


def _end_of(path: Path, others: Sequence[Path]) -> str:
    """The shortest end of a path that no other path ends with.

    >>> _end_of(Path("/runs/a/spur"), [Path("/runs/b/spur")]), _end_of(Path("/runs/a/spur"), [Path("/runs/a/bevel")])
    ('a/spur', 'spur')
    """
    ends = (path.parts[-count:] for count in range(1, len(path.parts) + 1))
    shortest = next((end for end in ends if all(other.parts[-len(end) :] != end for other in others)), path.parts)
    return str(Path(*shortest))


def _table(name: str, unit: str, runs: Sequence[tuple[str, Run]]) -> Sheet:
    shift = ("shift",) if len(runs) > 1 else ()
    out = ("out of limits",) if any(_judged(run.summary["measures"][name]) for _, run in runs) else ()
    numbers = ("trials", "mean", "sigma", "low", "high", *out, "max", "rms", *shift)
    headings = [Heading("road", words=True), *(Heading(word) for word in numbers)]
    rows, first = [], dict[str, float]()
    for label, run in runs:
        for index, (road, sample) in enumerate(_samples(run.summary["measures"][name])):
            mean = sample.get("mean")
            cells = [SHORT[road], _trials_text(sample), *(value_text(sample.get(key), unit) for key in KEYS)]
            cells += [share_text(sample.get("out_ppm"))] if out else []
            cells += _differences(run, name, unit) if road == "geometric" else [NOTHING, NOTHING]
            if shift:
                cells.append(NOTHING if mean is None else _bare(mean - first.setdefault(road, mean), unit))
            rows.append(Row(label if index == 0 else "", cells))
    return Sheet("run" if unit == "arcmin" else f"run [{UNIT_SIGNS[unit]}]", headings, rows, repeated=1)


def _judged(measure: Summary) -> bool:
    """Whether trials of a measure can be out: it has a limit, or some of them failed."""
    return (measure["lower_limit"], measure["upper_limit"]) != (None, None) or bool(seated_text(measure))


def _trials_text(sample: Summary) -> str:
    """How many trials its mean and sigma are of, and of how many there were where some failed."""
    count, trials = sample.get("count", ""), sample.get("trials")
    return f"{count} of {trials}" if trials is not None and count not in ("", trials) else str(count)


def _samples(measure: Summary) -> Iterator[tuple[str, Summary]]:
    """What each road found; of a curve the average over its positions."""
    for road in SHORT:
        if measure["take"] != "curve" and road in measure:
            yield road, measure[road]
        elif road in measure.get("curve", {}):
            curve = {key: [v for v in measure["curve"][road][key] if v is not None] for key in ("mean", "sigma")}
            own = {key: float(np.mean(values)) for key, values in curve.items() if values}
            status = measure.get("status", {}) if road == "geometric" else {}
            counted = {"count": status.get("ok", 0), "trials": sum(status.values())} if status else {}
            yield road, own | {"out_ppm": measure["curve"][road].get("out_ppm"), **counted}


def _differences(run: Run, name: str, unit: str) -> list[str]:
    agreement = run.summary["measures"][name].get("agreement")
    if agreement is not None:
        found = (agreement["max_abs_difference"], agreement["rms_difference"])
    else:
        difference = difference_of(run, name)
        found = (difference.largest, difference.rms) if difference else (None, None)
    return [_bare(value, unit) for value in found]


def _bare(difference: float | None, unit: str) -> str:
    """A difference in a table whose corner tells the unit."""
    return difference_text(difference, unit).removesuffix(f" {UNIT_SIGNS[unit]}")
