"""The harmonic balance of a structure with contact."""
