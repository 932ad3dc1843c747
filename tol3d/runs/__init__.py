"""A run on disk: its blocks of trials, their storage, and the conditions of replacing it."""
