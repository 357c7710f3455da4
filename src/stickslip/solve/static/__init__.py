"""The state at rest under a static load."""
