"""The analytic road of planetary sets: gaps to first order."""
