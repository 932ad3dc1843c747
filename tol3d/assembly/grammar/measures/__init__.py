"""Kinds of measure: every class with a word in any file of this folder is one."""
