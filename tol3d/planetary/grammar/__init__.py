"""What scenes say of planetary sets besides the kinds of gears."""
