"""Numbers: poses of many trials, compiled kernels and where they are kept, what decides a last bit."""
