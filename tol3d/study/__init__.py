"""Study of a system: its settings, draws, tallies, stopping and findings."""
