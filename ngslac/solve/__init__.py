"""One equilibrium: Newton's method with its safeguards, for bulk and contact together."""
