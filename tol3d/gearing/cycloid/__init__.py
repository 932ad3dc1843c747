"""Cycloid discs among pins: the second stage of an RV reducer, its geometry and both methods."""
