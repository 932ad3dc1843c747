"""Derivatives of measures through the contact, and the coefficients that a check shows."""
