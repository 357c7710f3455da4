"""Stability of periodic motions: Floquet multipliers along a curve."""
