"""The whole study of the paper on this package's model: its tables and figures, and a verdict on each of its claims."""
