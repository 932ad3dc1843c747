"""Independent answers to what tol3d computes: plain numbers in, plain numbers out, nothing of tol3d imported."""
