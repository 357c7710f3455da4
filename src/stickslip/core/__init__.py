"""Common parts of all rooms: errors, checks of values, units, Fourier matrices, files, threads, progress."""
