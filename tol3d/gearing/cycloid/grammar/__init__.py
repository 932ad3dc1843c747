"""Vocabulary of RV reducers in scenes, besides the kinds of gears."""
