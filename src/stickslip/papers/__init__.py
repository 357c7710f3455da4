"""Published studies, computed again."""
