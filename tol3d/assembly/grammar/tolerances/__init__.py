"""Kinds of tolerance by their names on drawings: every class with a word is one, in whatever file it is."""
