"""Contact pairs from two faces of a mesh."""
