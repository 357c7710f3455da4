"""Contact stiffness from roughness and load."""
