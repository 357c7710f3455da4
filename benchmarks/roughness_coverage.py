"""How often the 95 % intervals of ``fit_roughness`` hold the true D and G, on generated profiles.

Run ``python benchmarks/roughness_coverage.py PROFILES POINTS [KIND]``; 40 profiles of 1000 points of all kinds take a
quarter of an hour. The kinds of surface:

* endless: Weierstrass-Mandelbrot, waves from 20 profile lengths down to a third of the spacing;
* short band: waves from one profile length down to two spacings, which the fit is not told;
* short band, told: the same, with ``longest_wave`` given;
* Gaussian: normal amplitudes from all directions, as a measured surface nearly has, endless as the first.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np

import stickslip as ss
from stickslip.contact.stiffness.detrended_lines import wavelengths
from stickslip.contact.stiffness.random_lines import LineSet, Spectrum, simulate
from stickslip.contact.stiffness.surface import draw_phases, frequency_count
from stickslip.core.validation import FloatArray

SPACING = 1e-6
SURFACES = ((2.2, 1e-12), (2.4, 1e-9), (2.6, 1e-8), (2.8, 1e-7))
RIDGES = 10


def mandelbrot(longest: float, shortest: float) -> Callable[[float, float, int, int], FloatArray]:
    """A maker of Weierstrass-Mandelbrot profiles: ``longest`` in profile lengths, ``shortest`` in spacings."""

    def make(dimension: float, roughness: float, points: int, seed: int) -> FloatArray:
        length = longest * points * SPACING
        phases = draw_phases(seed, RIDGES, frequency_count(length, shortest * SPACING))
        along, angle = SPACING * np.arange(points), np.random.default_rng([7, seed]).uniform(0.0, 2.0 * np.pi)
        x, y = along * np.cos(angle), along * np.sin(angle)
        return ss.fractal_surface(x, y, dimension, roughness, length, RIDGES, phases)

    return make


def gaussian(dimension: float, roughness: float, points: int, seed: int) -> FloatArray:
    """A profile of a Gaussian surface without ends."""
    waves = wavelengths(100.0 * points * SPACING, SPACING)
    spectrum = Spectrum.of(waves, 3.0 - dimension, roughness ** (2.0 * (dimension - 2.0)), 0.0)
    lines = (LineSet(points, SPACING, np.zeros(1), along_x=True),)
    return next(simulate(lines, spectrum, np.random.default_rng([2, seed])))[0][0]


KINDS: dict[str, tuple[Callable[[float, float, int, int], FloatArray], bool]] = {
    "endless": (mandelbrot(20.0, 1 / 3), False),
    "short band": (mandelbrot(1.0, 2.0), False),
    "short band, told": (mandelbrot(1.0, 2.0), True),
    "Gaussian": (gaussian, False),
}


def main(profiles: int, points: int, kinds: list[str]) -> None:
    """Print a table: mean and scatter of D, mean half-width of its interval, median log10 G, share of hits.

    "line" is the D that a straight line through ln S over ln tau at the same lags would give, 3 less half its slope.
    """
    print(f"{profiles} profiles of {points} points each")
    print(
        "surface            D    log10 G | line  | mean D  sd D  half-width | median log10 G | D held G held | unlike"
    )
    for kind in kinds:
        make, told = KINDS[kind]
        for dimension, roughness in SURFACES:
            fits = [
                ss.fit_roughness(
                    make(dimension, roughness, points, seed),
                    SPACING,
                    longest_wave=points * SPACING if told else None,
                    seed=seed,
                )
                for seed in range(profiles)
            ]
            found = np.array([fit.fractal_dimension for fit in fits])
            ends = np.array([fit.fractal_dimension_interval for fit in fits])
            held = np.mean((ends[:, 0] <= dimension) & (dimension <= ends[:, 1]))
            ranges = np.array([fit.fractal_roughness_interval for fit in fits])
            roughness_held = np.mean((ranges[:, 0] <= roughness) & (roughness <= ranges[:, 1]))
            middle = np.log10(np.median([fit.fractal_roughness for fit in fits]))
            slopes = [np.polyfit(np.log(fit.lag), np.log(fit.structure_function), 1)[0] for fit in fits]
            unlike = np.mean([any("Not fractal" in each for each in fit.warnings) for fit in fits])
            print(
                f"{kind:<17} {dimension:.1f} {np.log10(roughness):6.1f}    | {3.0 - 0.5 * np.mean(slopes):.3f} | "
                f"{found.mean():.3f}  {found.std():.3f} {0.5 * np.ptp(ends, axis=1).mean():8.3f}   | {middle:10.2f} "
                f"    | {100 * held:4.0f} % {100 * roughness_held:4.0f} % | {100 * unlike:.0f} %",
                flush=True,
            )


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:] or list(KINDS))
