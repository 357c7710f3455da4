"""Matrices of other programs: read, checked, converted to SI units, reduced, and exchanged in one file."""
