"""What an engineer decides from: questions that are asked of any scene, by its responses alone."""
