"""The analytic road: small displacements, propagated by linear algebra from the nominal geometry."""
