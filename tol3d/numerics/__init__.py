"""Numbers: poses of many trials, programmes in kernels, compiled code and its cache, the causes of last bits.

Nothing of tolerances, parts or gears is known here. `arrays.py` says what an array of trials is, `compiled.py` is the
only module that imports numba, `programme.py` and `cone_programme.py` solve a programme per trial, `kept.py` keeps what
is computed once. Read `compiled.py` first.
"""
