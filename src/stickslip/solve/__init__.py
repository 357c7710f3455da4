"""Solvers: the state at rest, periodic responses along the frequency, time integration."""
