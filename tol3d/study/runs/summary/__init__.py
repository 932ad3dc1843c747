"""Contents of summary.json, key by key, defined here alone. `tol3d schema --summary` prints them as JSON Schema.

    values      numbers, names and sentences as a summary may hold them; the base of all classes here
    sample      statistics of a measure's trials, by either method
    agreement   difference of both methods and its explanation; findings of the witness
    measure     one measure
    joint       joint results of the measures
    run         the whole
    kinds       additions of mechanisms: classes of their measures, sections of their own
    text        reading and writing summary.json

A run's summary is held against it when it is written, so a key that is not here is a warning that fails the tests, and
when it is read, for a stranger may have made the file: numbers are finite and bounded, names and sentences hold no
control characters. A NEW KEY of summary.json is one line in the class of its place; a key that is not in every summary
is Optional-by-absence: `Maybe[...] = LEFT_OUT`; it may be missing, but not be null. What is made of the values
elsewhere (lengths of lists, a seed that stands twice) is compared in `_refuse_contradictions`.
"""
