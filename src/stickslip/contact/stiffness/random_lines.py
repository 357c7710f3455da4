"""Random isotropic fractal lines and maps with a given spectrum, for the intervals of a fit of D and G."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.stiffness.detrended_lines import wave_weights
from stickslip.core.validation import FloatArray

DIRECTIONS = 24  # random directions of each wavelength in every simulated surface
_BLOCK = 64  # points along a line that share the factors of one coarse step


@dataclass(frozen=True)
class LineSet:
    """Parallel lines on the plane: points at ``spacing`` (m) along the line, lines at ``offset`` (n,) (m) beside."""

    points: int
    spacing: float
    offset: FloatArray
    along_x: bool


@dataclass(frozen=True)
class Spectrum:
    """Height variance at each wavelength, as its part of S, and of uncorrelated heights."""

    waves: FloatArray  # wavelengths in m
    weights: FloatArray  # (n_waves,) m2
    noise: float  # constant of S in m2, 2 sigma^2

    @classmethod
    def of(cls, waves: FloatArray, hurst: float, factor: float, constant: float) -> Spectrum:
        """The spectrum with S = ``factor`` sum(lambda^(2H) ...) + ``constant`` (m2).

        A negative constant means that short waves are missing; they are removed, the shortest first.
        """
        weights, shorter = wave_weights(waves, hurst)
        weights, noise = factor * weights, factor * shorter + constant
        if noise >= 0.0:
            return cls(waves, weights, noise)
        before = np.cumsum(weights[::-1])[::-1] - weights  # of all shorter waves
        return cls(waves, weights - np.clip(-noise - before, 0.0, weights), 0.0)

    @property
    def shortest(self) -> float:
        """Wavelength in m below which the spectrum is zero, 0 if the waves continue below the spacing."""
        if self.noise > 0.0:
            return 0.0
        present = np.flatnonzero(self.weights > 0.0)
        return float(self.waves[present[-1]]) if present.size else float(self.waves[0])


def simulate(
    sets: tuple[LineSet, ...], spectrum: Spectrum, rng: np.random.Generator
) -> Iterator[tuple[FloatArray, ...]]:
    """Unbounded surfaces, each as the lines (n, points) of every set; heights in m about an arbitrary constant.

    Every wavelength has new random directions and complex normal amplitudes: a Gaussian surface, as measured ones
    nearly are.
    """
    nonzero = spectrum.weights > 0.0
    waves, weights = spectrum.waves[nonzero], spectrum.weights[nonzero]
    scale = np.sqrt(0.5 * weights / DIRECTIONS)[:, None]
    while True:
        angle = rng.uniform(0.0, 2.0 * np.pi, (waves.size, DIRECTIONS))
        amplitude = (scale * (rng.normal(size=angle.shape) + 1j * rng.normal(size=angle.shape))).ravel()
        number = (2.0 * np.pi / waves)[:, None]
        across, up = (number * np.cos(angle)).ravel(), (number * np.sin(angle)).ravel()
        surface = []
        for lines in sets:
            along, beside = (across, up) if lines.along_x else (up, across)
            heights = _heights(lines, along, beside, amplitude)
            surface.append(heights + np.sqrt(0.5 * spectrum.noise) * rng.normal(size=heights.shape))
        yield tuple(surface)


def _heights(lines: LineSet, along: FloatArray, beside: FloatArray, amplitude: NDArray[np.complex128]) -> FloatArray:
    """Real part of sum a exp(i k.x) on the lines; block by block, so that it is one product of small matrices."""
    blocks = -(-lines.points // _BLOCK)
    fine = np.exp(1j * lines.spacing * np.outer(along, np.arange(_BLOCK)))
    coarse = np.exp(1j * _BLOCK * lines.spacing * np.outer(np.arange(blocks), along))
    first = amplitude * np.exp(1j * np.outer(lines.offset, beside))
    result = np.einsum("lw,bw->lbw", first, coarse).reshape(-1, along.size) @ fine
    return np.asarray(result.real.reshape(lines.offset.size, -1)[:, : lines.points])
