"""The exact method: finite poses of features, datum frames and parts, trial by trial in arrays."""
