"""Kinds of part, one file each."""
