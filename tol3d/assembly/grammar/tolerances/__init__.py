"""Kinds of tolerance by their names on drawings: every class with a word in any file of this folder is one."""
