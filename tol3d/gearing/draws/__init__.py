"""Draws of single flanks: pitch deviations by their laws, and flanks that were measured."""
