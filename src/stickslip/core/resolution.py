"""Harmonics and samples of a period, and limits of a wanted accuracy, which study files and solver share."""

from __future__ import annotations

from typing import NamedTuple

# chosen: sampling has errors of 1e-4 and more, so that a finer accuracy of the harmonics has no meaning; above a tenth
# the estimate, which is linear, is none.
FINEST_ACCURACY, COARSEST_ACCURACY = 1e-5, 0.1
# chosen: fewer samples of a period do not resolve friction to the coarsest accuracy.
LEAST_SAMPLES = 64
# A period has at least this number of samples for each harmonic, so that the estimate can have twice the harmonics.
SAMPLES_PER_HARMONIC = 4


class Resolution(NamedTuple):
    """Harmonics and samples of a period with which an equation is solved."""

    harmonics: int
    samples: int
