"""How far the two roads differ, and what explains it: the lines below a measure's table."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from tol3d.report.number import difference_text, percent_text

Summary = Mapping[str, Any]

FLANKS_OF_A_BACKLASH = 4  # two at the contact, two at the gap; each may miss the true flank by the chord error
NAMED = 3  # contributors of one reason


def agreement_lines(
    agreement: Summary, unit: str, chord_error_um: float | None = None, whose: str = ""
) -> Iterator[str]:
    """The differences trial by trial, what the tessellation may explain of them, and what else does.

    `whose` says of what the normal backlash is, where that is not the measure's one mesh.
    """
    line = (
        f"3D simulation − analytic, trial by trial: at most {difference_text(agreement['max_abs_difference'], unit)}, "
        f"rms {difference_text(agreement['rms_difference'], unit)}, "
        f"mean {difference_text(agreement['mean_difference'], unit)}"
    )
    if chord_error_um:
        whole = FLANKS_OF_A_BACKLASH * chord_error_um
        line += (
            f"; up to {whole:.3f} µm of normal backlash{whose} may be chord error ({chord_error_um:.3f} µm on each of "
            f"{FLANKS_OF_A_BACKLASH} flanks)"
        )
    explanation = agreement.get("explanation")
    if explanation is None:
        yield line
    elif explanation["undecided"]:
        yield f"{line}; {explanation['undecided']}"
    elif explanation["faults"]:
        yield line
    else:
        yield f"{line}; explained: {_of_first_order(explanation)}; {_of_second_order(explanation, unit)}"
        yield from _left_out(explanation["linear"])


def unexplained_lines(agreement: Summary) -> list[str]:
    """What is not explained, to be said aloud."""
    return [f"NOT EXPLAINED: {fault}" for fault in (agreement.get("explanation") or {}).get("faults", ())]


def _of_first_order(explanation: Summary) -> str:
    other = "other " if explanation["linear"] else ""
    largest = explanation["largest_percent"]
    if not largest:  # counts what is beyond chance
        return f"no {other}contributor has a part in it beyond chance"
    return f"no {other}contributor's part in it is above {largest:.2g} % of its own effect"


def _of_second_order(explanation: Summary, unit: str) -> str:
    rms = explanation["second_order_rms"]
    if rms is None:
        return "of what order the rest is cannot be told, for nominal builds do not seat"
    named = ", ".join(explanation["second_order_of"])
    shift = difference_text(explanation["second_order_mean"], unit)
    terms = f"terms of second order have rms {difference_text(rms, unit)}, mean {shift}"
    return f"{terms}, the most by {named}" if named else terms


def _left_out(linear: Sequence[Summary]) -> Iterator[str]:
    """A line for each thing that the stack-up leaves out, with the contributors that it explains."""
    for reason in dict.fromkeys(part["by"] for part in linear):
        own = sorted((part for part in linear if part["by"] == reason), key=lambda part: -part["percent"])
        named = ", ".join(f"{part['contributor']} {percent_text(part['percent'])} %" for part in own[:NAMED])
        more = f" and {len(own) - NAMED} more" if len(own) > NAMED else ""
        what = reason if reason.startswith("second order") else f"the stack-up leaves out: {reason}"
        yield f"{what} (of their own effects: {named}{more})"
