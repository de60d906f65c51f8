"""Balls with their centre of mass off centre that slide on a plane: the tippe top."""
