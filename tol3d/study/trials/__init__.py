"""Trials of a study: its settings and overrides, its draws, and both methods' values of them as columns."""
