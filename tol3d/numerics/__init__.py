"""Numbers: poses of many trials, compiled kernels and their cache, the causes of last bits."""
