"""The forced response of a tuned disk from one of its sectors."""
