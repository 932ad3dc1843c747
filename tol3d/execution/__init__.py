"""Who runs a study, and how its blocks are handed out and folded."""
