"""Difference of the two methods, and its explanation."""
