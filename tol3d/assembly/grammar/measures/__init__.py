"""Kinds of measure: every class with a word is one, in whatever file of this folder it is."""
