"""Vocabulary of gears in a housing, besides the kinds of gears and of assemblies."""
