"""Vocabulary of linkages in scenes."""
