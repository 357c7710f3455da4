"""Ridges: peaks followed while a load changes."""
