"""Options of `tol3d run`."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.arguments import PicturesWord, SamplerName, accepted_ppm, trials_or_auto, whole

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
    Path | None, typer.Option(help="The run's folder; by default runs/<scene>, or -2, -3 … of another study.")
]
ForceOption = Annotated[
    bool, typer.Option("--force", help="Replace a run of another study; what else lies there is moved aside.")
]
WorkersOption = Annotated[
    Any,
    typer.Option(
        parser=whole(1), metavar="N", help="Threads or processes; by default one, or all cores for a long study."
    ),
]
SchedulerOption = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Run on the workers of this Dask scheduler.")
]
NoTrials = Annotated[bool, typer.Option("--no-trials", help="Keep statistics only, no rows of trials.")]
ResumeOption = Annotated[
    bool, typer.Option("--resume", help="Go on with an interrupted run, or mend a damaged one; never start anew.")
]
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
FailOnLimits = Annotated[
    bool,
    typer.Option(
        "--fail-on-limits",
        help="Exit with 1 when a trial is out of limits or failed; with --accept, when a verdict is not OK.",
    ),
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="Print the verdict and warnings only.")]
VerboseOption = Annotated[
    bool, typer.Option("--verbose", "-v", help="Print the tables of every measure, of more than 20 the worst.")
]
