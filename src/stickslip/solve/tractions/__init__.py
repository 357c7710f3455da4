"""Tractions that assembly locks in: how far they can move a curve."""
