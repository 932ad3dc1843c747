"""The command on tolerances of least cost."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import tell


def allocate(
    subject: SubjectArgument,
    ppm: Annotated[
        float | None, typer.Option(metavar="NUMBER", help="Builds that may be out of the limits of a measure.")
    ] = None,
    ppk: Annotated[
        float | None, typer.Option(metavar="NUMBER", help="Instead, for each limit; 1.33 if neither is given.")
    ] = None,
    measure: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME[:low|high]", help="Which, and which of its limits; all that have some."),
    ] = None,
    cost: Annotated[Path | None, typer.Option(metavar="FILE", help="Costs by contributor, YAML; 1 by factor.")] = None,
    bounds: Annotated[str, typer.Option(metavar="LOW..HIGH", help="Of factors.")] = "0.5..3",
    bound: Annotated[
        list[str] | None, typer.Option(metavar="NAME=LOW..HIGH", help="Of the factor of one contributor.")
    ] = None,
    freeze: Annotated[list[str] | None, typer.Option(metavar="NAME", help="A tolerance that stays as it is.")] = None,
    stays: Annotated[
        list[str] | None, typer.Option(metavar="NAME=low|high", help="A limit that stays, instead of the middle.")
    ] = None,
    beyond_least: Annotated[
        bool, typer.Option("--beyond-least", help="Draw below what is physical, such as clearances below 0.")
    ] = False,
    draws: Annotated[
        Any, typer.Option(parser=whole(100), metavar="N", help="Of importance sampling, each time and for each limit.")
    ] = 12000,
    seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of them.")] = 1,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the scene with them here.")] = None,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find the tolerances of least cost for a share out of limits, which simulation confirms."""
    from tol3d.analyses import allocate as ask
    from tol3d.analyses.subject import subject_of
    from tol3d.scene.edit import write_scene

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    words: dict[str, Any] = {"ppm": ppm, "ppk": ppk, "measure": measure or (), "cost": cost, "bounds": bounds}
    words |= {"bound": bound or (), "freeze": freeze or (), "stays": stays or (), "beyond_least": beyond_least}
    words |= {"draws": draws, "seed": seed}
    found = answer("allocation", own, "tolerances", lambda activity: ask(own, **words, activity=activity), csv, picture)
    if out is not None:
        write_scene(found.scene, out)
        tell(f"scene: {out}")
