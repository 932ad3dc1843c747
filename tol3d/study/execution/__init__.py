"""Execution of a study: workers, scheduling of its blocks, folding of their statistics."""
