"""Results: labelled data, their measures and files."""
