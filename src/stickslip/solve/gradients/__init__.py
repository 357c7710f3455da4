"""Gradients of a peak by each constant of the equation."""
