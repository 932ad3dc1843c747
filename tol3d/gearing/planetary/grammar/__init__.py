"""Vocabulary of planetary sets in scenes, besides the kinds of gears."""
