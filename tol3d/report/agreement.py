"""How far the two roads differ, and what explains it: the lines below a measure's table."""

from collections.abc import Iterator, Sequence

from tol3d.report.number import COUNTED, difference_text, percent_text
from tol3d.runs.summary.agreement import Agreement, Explanation, LinearPart

NAMED = 3  # contributors of one reason


def agreement_lines(agreement: Agreement, unit: str, chord_words: str = "") -> Iterator[str]:
    """The differences trial by trial, what the tessellation may explain of them, and what else does.

    Args:
        agreement: of a measure.
        unit: its unit.
        chord_words: what chord errors may explain; nothing where there are none.
    """
    line = (
        f"3D simulation − analytic, trial by trial: at most {difference_text(agreement.max_abs_difference, unit)}, "
        f"rms {difference_text(agreement.rms_difference, unit)}, "
        f"mean {difference_text(agreement.mean_difference, unit)}"
    )
    line += f"; {chord_words}" if chord_words else ""
    explanation = agreement.explanation
    if explanation is None:
        yield line
    elif explanation.undecided:
        yield f"{line}; {explanation.undecided}"
    elif explanation.faults:
        yield line
    else:
        why = [_of_first_order(explanation), _of_second_order(explanation, unit), *_neglected(explanation, unit)]
        yield f"{line}; explained: {'; '.join(why)}"
        yield from _left_out(explanation.linear)


def unexplained_lines(agreement: Agreement | None) -> list[str]:
    """What is not explained, to be said aloud."""
    explanation = agreement.explanation if agreement else None
    return [f"NOT EXPLAINED: {fault}" for fault in (explanation.faults if explanation else ())]


def _of_first_order(explanation: Explanation) -> str:
    other = "other " if explanation.linear else ""
    largest = explanation.largest_percent
    if not largest:  # counts what is beyond chance
        return f"no {other}contributor has a part in it beyond chance"
    return f"no {other}contributor's part in it is above {largest:.2g} % of its own effect"


def _of_second_order(explanation: Explanation, unit: str) -> str:
    rms = explanation.second_order_rms
    if unit in COUNTED:
        return "what is near a bound one road counts and the other does not"
    if rms is None:
        return "of what order the rest is cannot be told, for nominal builds do not seat"
    named = ", ".join(explanation.second_order_of)
    shift = difference_text(explanation.second_order_mean, unit)
    terms = f"terms of second order have rms {difference_text(rms, unit)}, mean {shift}"
    return f"{terms}, the most by {named}" if named else terms


def _neglected(explanation: Explanation, unit: str) -> Iterator[str]:
    """What the stack-up leaves out that no contributor's part in the differences shows, where it is seen at all."""
    nothing, shown = difference_text(0.0, unit), {part.by for part in explanation.linear}
    for what, rms in explanation.neglected.items():
        if what not in shown and (text := difference_text(rms, unit)) != nothing:
            yield f"the stack-up leaves out {what}: rms {text}"


def _left_out(linear: Sequence[LinearPart]) -> Iterator[str]:
    """A line for each thing that the stack-up leaves out, with the contributors that it explains."""
    for reason in dict.fromkeys(part.by for part in linear):
        own = sorted((part for part in linear if part.by == reason), key=lambda part: -part.percent)
        named = ", ".join(f"{part.contributor} {percent_text(part.percent)} %" for part in own[:NAMED])
        more = f" and {len(own) - NAMED} more" if len(own) > NAMED else ""
        what = reason if reason.startswith("second order") else f"the stack-up leaves out: {reason}"
        yield f"{what} (of their own effects: {named}{more})"
