"""What scenes may say of linkages."""
