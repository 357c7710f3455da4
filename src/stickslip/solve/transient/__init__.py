"""Time integration, written apart as an independent check."""
