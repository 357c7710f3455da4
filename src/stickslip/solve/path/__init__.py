"""Path following along a curve of solutions; independent of friction and of frequencies."""
