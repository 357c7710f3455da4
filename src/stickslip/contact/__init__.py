"""What the joint does: laws, stiffness, pairing of faces."""
