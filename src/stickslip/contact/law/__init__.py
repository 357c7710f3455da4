"""Force laws of contact pairs."""
