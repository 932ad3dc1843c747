"""Findings of a study: tasks of its workers, attribution, agreement of the methods, the witness, summary.json."""
