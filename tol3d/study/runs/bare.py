"""A run of a mechanism that is not installed here: the common part of its summary, for reports."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tol3d.study.runs.manifest import Manifest
from tol3d.study.runs.run import LARGEST_SUMMARY, SUMMARY, Run, open_run
from tol3d.study.runs.summary.agreement import WitnessSummary
from tol3d.study.runs.summary.kinds import SummaryKinds, default_kinds
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary, StudySummary
from tol3d.study.runs.summary.text import missing_mechanism, parsed


class MissingMechanismWarning(UserWarning):
    """A run is shown without the additions of its mechanism, which is not installed."""


def open_even_bare(path: Path | str) -> tuple[Run, str]:
    """Open a run, one of an unknown mechanism without its additions; the missing parts in words, "" for none.

    Raises:
        RunError: not a run, damaged, or changed since it was made.
    """
    folder = Path(path)
    if not (folder / SUMMARY).exists():
        return open_run(folder), ""
    summary = parsed(Manifest.read(folder).content(SUMMARY, LARGEST_SUMMARY), folder / SUMMARY)
    known = default_kinds(summary)
    if not missing_mechanism(summary, known):
        return open_run(folder), ""
    unknown = known.unknown_in(summary)
    kinds = known | SummaryKinds(plain=tuple((word, "") for word in unknown))
    run = Run(folder, _common(summary, unknown), kinds)
    maker = run.found.mechanism
    named = f"mechanism {maker.name!r} (Python module {maker.module!r})" if maker else "mechanism that made this run"
    return run, f"the {named} is not installed here: its own tables, pictures and 3D view are left out"


def _common(summary: Mapping[str, Any], unknown: tuple[str, ...]) -> Mapping[str, Any]:
    """A summary with the keys that every one may have."""
    found = {key: value for key, value in summary.items() if key in _keys(RunSummary) - {"published"}}
    for name, section in (("study", StudySummary), ("witness", WitnessSummary)):
        if isinstance(own := found.get(name), dict):
            found[name] = {key: value for key, value in own.items() if key in _keys(section)}
    measures = found.get("measures")
    if isinstance(measures, dict):
        found["measures"] = {
            name: {key: own for key, own in entry.items() if key in _keys(MeasureSummary)}
            if isinstance(entry, dict) and entry.get("kind") in unknown
            else entry
            for name, entry in measures.items()
        }
    return found


def _keys(section: type[Any]) -> frozenset[str]:
    return frozenset(field.alias or name for name, field in section.model_fields.items())
