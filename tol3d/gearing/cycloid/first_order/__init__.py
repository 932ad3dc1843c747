"""The analytic method of a cycloid stage: turns to first order."""
