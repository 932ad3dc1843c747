"""The seam between a study and what it studies."""
