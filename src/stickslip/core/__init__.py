"""What all rooms share: errors, checks of values, units, Fourier matrices, files, threads, progress."""
