"""Sweeps: many cases on any executor."""
