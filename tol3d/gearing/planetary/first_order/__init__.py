"""The analytic method of planetary sets: gaps to first order."""
