"""A run on disk: its blocks of trials, what is kept of them, and who may replace it."""
