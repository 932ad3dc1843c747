"""What scenes say of assemblies."""
