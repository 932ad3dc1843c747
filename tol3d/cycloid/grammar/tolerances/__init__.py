"""Kinds of tolerance, one file each."""
