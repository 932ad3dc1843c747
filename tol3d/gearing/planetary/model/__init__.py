"""A planetary set, its tooth numbers and its deviations."""
