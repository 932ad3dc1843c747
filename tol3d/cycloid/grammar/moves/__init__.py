"""Kinds of move, one file each."""
