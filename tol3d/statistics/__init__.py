"""Statistics: laws of deviations and limits of standards, samplers of uniforms, estimates from the values of trials.

    standards       limits that standards of drawings give to sizes, by letters and classes
    distributions   laws of a deviation: their words in scenes and their meaning
    samplers        uniforms of a trial, as pure functions of seed, stream and trial
    estimates       moments, quantiles, shares and fits, with their errors, gathered block by block

No scene, system or run is known here. Read `distributions/base.py` and `samplers/stream.py` first.
"""
