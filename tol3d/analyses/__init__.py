"""Analyses for decisions of an engineer: questions about any scene, answered by its responses alone."""
