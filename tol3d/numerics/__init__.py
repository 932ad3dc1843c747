"""Numerics: poses of many trials, programmes in kernels, compiled code and its cache, the causes of last bits.

It knows no tolerances, parts or gears. `arrays.py` has the types of arrays of trials, `compiled.py` is the only module
that imports numba, `programme.py` and `cone_programme.py` solve one programme per trial, `kept.py` keeps results that
are computed once. Read `compiled.py` first.
"""
