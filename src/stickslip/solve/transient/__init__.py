"""Time integration, independent of the harmonic balance as a check."""
