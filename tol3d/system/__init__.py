"""The seam between a study and the studied system."""
