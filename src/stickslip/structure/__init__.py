"""Finite elements, superelements and their reduction."""
