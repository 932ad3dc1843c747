"""The command on the effect of each contributor on each measure."""

from enum import StrEnum
from typing import Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import RunBuilders, TrustParts, whole


class PositionWord(StrEnum):
    """Treatment of positions in sensitivity indices."""

    AVERAGED = "averaged"
    AS_INPUT = "as-input"


def effects(
    subject: SubjectArgument,
    measure: Annotated[str | None, typer.Option(help="On which measure; all that are one number a trial.")] = None,
    base: Annotated[
        Any, typer.Option(parser=whole(2), metavar="N", help="Pairs of builds, a power of two; as time allows.")
    ] = None,
    seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of their points.")] = 1,
    position: Annotated[
        PositionWord, typer.Option(help="averaged: indices at a position, averaged; as-input: an input as well.")
    ] = PositionWord.AVERAGED,
    shapley: Annotated[
        bool, typer.Option("--shapley", help="Shapley effects too, also where nothing is correlated.")
    ] = False,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find what each contributor does to each measure: changes, shares of the variance and of failures."""
    from tol3d.analyses import effects as ask
    from tol3d.analyses.subject import subject_of

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    words: dict[str, Any] = {
        "measure": measure,
        "base": base,
        "seed": seed,
        "position": position.value,
        "shapley": shapley,
    }
    answer("effects", own, "effects", lambda activity: ask(own, **words, activity=activity), csv, picture)
