"""The analytic road of a cycloid stage: turns to first order."""
