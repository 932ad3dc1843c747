"""The app, and the arguments that several commands take."""

import math
import re
from collections.abc import Callable
from decimal import Decimal
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.commands import CommandGroup

if TYPE_CHECKING:
    from tol3d.study.runs.summary.judged import Accepted

PPM_PER = {"%": 1e4, "ppm": 1.0}
WHOLE = re.compile(r"\d{1,19}(\.0*)?([eE]\+?\d{1,2})?")
SHARE = re.compile(r"\s*(?P<number>\d+\.?\d*|\.\d+)\s*(?P<unit>%|ppm)\s*")

app = typer.Typer(
    name="tol3d",
    cls=CommandGroup,
    help="Open 3D tolerance simulator for gears and robots: thousands of virtual builds on real geometry, "
    "beside an independent analytic model.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

SceneArgument = Annotated[
    str, typer.Argument(metavar="SCENE", help="A scene file, or the name of a bundled one (spur_pair).")
]
EngineOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="Engine instead of the scene's: exact, analytic, fcl of gears.")
]
RunArgument = Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a finished run.")]
TrustParts = Annotated[
    bool, typer.Option("--trust-parts", help="Allow the scene to read files outside its own folder.")
]
RunBuilders = Annotated[
    bool, typer.Option("--run-builders", help="Run the Python files that the scene names as builders of its parts.")
]


class SamplerName(StrEnum):
    """Ways to draw that a run may choose."""

    MONTE_CARLO = "monte_carlo"
    SOBOL = "sobol"
    LATIN_HYPERCUBE = "latin_hypercube"


class PicturesWord(StrEnum):
    """Measures that a run of many draws."""

    WORST = "worst"
    ALL = "all"


def trials_or_auto(text: str) -> int | str:
    """A number of trials, or auto, as --trials gives it."""
    return text if text == "auto" else whole(1, " or auto")(text)


def whole(least: int, other: str = "", most: int | None = None) -> Callable[[str | int], int]:
    """Parser of a whole number from `least` on, such as 20000 or 2e4; up to `most`, if given.

    >>> whole(1)("1e6")
    1000000
    """
    ends = f"from {least} on" if most is None else f"from {least} to {most}"

    def read(text: str | int) -> int:
        said = WHOLE.fullmatch(str(text))
        found = int(Decimal(said[0])) if said else -1
        if not least <= found or (most is not None and found > most):
            raise typer.BadParameter(f"expected a whole number {ends}{other and ','}{other}, got {str(text)!r}")
        return found

    return read


def accepted_ppm(text: str) -> float:
    """A share of the trials with its unit [ppm], as --accept gives it.

    >>> accepted_ppm("0.27 %"), accepted_ppm("100ppm")
    (2700.0, 100.0)
    """
    found = SHARE.fullmatch(text)
    ppm = float(found["number"]) * PPM_PER[found["unit"]] if found else math.nan
    if not 0.0 <= ppm < PPM_PER["%"] * 100:
        raise typer.BadParameter(f'expected a share of the trials, such as "0.27 %" or "100 ppm", got {text!r}')
    return ppm


def accepted_ppk(text: str | float) -> float:
    """A Ppk, as --accept-ppk gives it.

    >>> accepted_ppk("1.33")
    1.33
    """
    from tol3d.statistics.estimates.limits import MOST_PPK

    try:
        ppk = float(text)
    except ValueError:
        ppk = math.nan
    if not 0.0 < ppk < MOST_PPK:
        raise typer.BadParameter(f"expected a number above 0 and below {MOST_PPK:g}, such as 1.33, got {str(text)!r}")
    return ppk


def accepted_of(share: float | None, ppk: float | None) -> "Accepted | None":
    """Demand of --accept or --accept-ppk on measures; None if neither is given."""
    from tol3d.study.runs.summary.judged import AcceptedPpk

    if share is not None and ppk is not None:
        raise typer.BadParameter("--accept states a share out of limits, --accept-ppk a Ppk; leave out one of them")
    return share if ppk is None else AcceptedPpk(ppk)


def scene_path(text: str) -> Path:
    """A scene's file: the path itself, or the bundled scene of that name.

    Raises:
        SceneError: a bare name, and there is neither.
    """
    from tol3d.scene import bundled

    return bundled.scene_path(text)


PICTURE = "histogram.png"

TrialsOption = Annotated[
    Any, typer.Option(parser=trials_or_auto, metavar="N|auto", help="Number of trials instead of the scene's.")
]
SeedOption = Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Seed instead of the scene's.")]
SamplerOption = Annotated[SamplerName | None, typer.Option(help="Sampler instead of the scene's.")]
WitnessOption = Annotated[
    Any,
    typer.Option(parser=whole(0), metavar="N", help="Trials that another engine measures again, of gears FCL."),
]
OutOption = Annotated[
    Path | None, typer.Option(help="The run's folder; default: runs/<scene>, or -2, -3 … of another study.")
]
ForceOption = Annotated[
    bool, typer.Option("--force", help="Replace a run of another study; what else lies there is moved aside.")
]
WorkersOption = Annotated[
    Any,
    typer.Option(
        parser=whole(1), metavar="N", help="Threads or processes; default: one, or all cores for a long study."
    ),
]
SchedulerOption = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Run on the workers of this Dask scheduler.")
]
NoTrials = Annotated[bool, typer.Option("--no-trials", help="Keep statistics only, no rows of trials.")]
ResumeOption = Annotated[
    bool, typer.Option("--resume", help="Go on with an interrupted run, or mend a damaged one; never start anew.")
]
ReportOption = Annotated[bool, typer.Option("--report", help="Write its report too, report.html in its folder.")]
NoPicture = Annotated[bool, typer.Option("--no-picture", help="Draw nothing.")]
PicturesOption = Annotated[
    PicturesWord | None,
    typer.Option(
        "--pictures",
        help=f"Of more than four measures {PICTURE} shows the four worst; all: an overview, and each by itself.",
    ),
]
AcceptOption = Annotated[
    Any,
    typer.Option(parser=accepted_ppm, metavar="SHARE", help="Share of trials that may be out of limits; 0.27 %."),
]
AcceptPpkOption = Annotated[
    Any,
    typer.Option(
        "--accept-ppk", parser=accepted_ppk, metavar="PPK", help="Ppk that measures must have, such as 1.33, instead."
    ),
]
FailOnLimits = Annotated[
    bool,
    typer.Option(
        "--fail-on-limits",
        help="Exit with 1 when a trial is out of limits or failed; with --accept or --accept-ppk, when not OK.",
    ),
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="Print the verdict and warnings only.")]
VerboseOption = Annotated[
    bool, typer.Option("--verbose", "-v", help="Print everything: agreement, witness, sampling errors, all tables.")
]
