"""Systems whose answers are known by heart, built outside the package as any mechanism may be: what a study finds of
them is held to closed forms and to slow references that share nothing with it.

    parabola    sums of parabolas, known moments
    pins        a disc between 40 pins: a minimum over contacts, two load paths by a programme
    rods        contributors that read others

A program that uses one registers it: `tol3d.register(toys.parabola.PARABOLA)`.
"""
