"""The nominal cycloid stage and its deviations."""
