"""The joint: laws, stiffness, pairing of faces."""
