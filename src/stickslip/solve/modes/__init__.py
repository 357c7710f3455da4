"""Nonlinear modes: frequency and damping against amplitude, exact and by a quasi-static estimate."""
