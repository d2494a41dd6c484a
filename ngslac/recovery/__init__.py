"""Continuous pressure and traction from the multipliers of macro-elements."""
