"""What scenes say of RV reducers besides the kinds of gears."""
