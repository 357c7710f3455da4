"""The kinds of structure that a study can have."""
