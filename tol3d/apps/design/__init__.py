"""Finding planetary sets and their efficiencies, before anything is built."""
