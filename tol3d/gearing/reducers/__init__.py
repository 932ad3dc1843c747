"""Reducers alone and in trains: the code that planetary sets and RV reducers share, around their own solvers."""
