"""Models of other programs: mesh, sets, materials, constraints and loads."""
