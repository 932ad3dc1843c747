"""Grammar of assemblies in scenes."""
