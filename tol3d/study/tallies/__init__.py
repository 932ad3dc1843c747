"""Statistics of trials, folded block by block: samples, curves, joint results, regressions, Ppk."""
