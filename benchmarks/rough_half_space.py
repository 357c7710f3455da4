"""Contact of a rough, periodic half-space with a flat by boundary elements: the truth for laws of contact stiffness.

``pressed`` finds the pressure and the contact area with the package ContactMechanics (MIT licence), elastic or with the
pressure limited to the hardness; ``pressed_by_tamaas`` (AGPL) checks it. ``small_oscillation`` then finds the stiffness
of a small motion about that state: no point slips, closes or opens, so the motion is that of a flat punch with the
shape of the contact area. This is a linear problem, solved here with Fourier transforms and conjugate gradients. It is
exact for an elastic contact (its load is stationary in the contact area), and for a plastic one it is the elastic
response of the flattened surface.

Requires the extra ``bench``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from scipy.fft import irfft2, rfft2

from stickslip.contact.stiffness.surface import draw_phases, frequency_count
from stickslip.core.validation import FloatArray

RIDGES = 10
RATIO = 1.5


@dataclass(frozen=True)
class RoughSquare:
    """The surface of equation 3 on a periodic square of ``waves`` times its longest wave.

    Each wave vector is the nearest one that fits the square; amplitudes, directions and phases are those of the
    package. Lengths in m.
    """

    fractal_dimension: float
    fractal_roughness: float
    longest: float
    shortest: float
    waves: int  # longest waves along one side of the square
    seed: int

    @property
    def side(self) -> float:
        """Side of the square in m."""
        return self.waves * self.longest

    def heights(self, points: int) -> FloatArray:
        """(points, points) heights in m, mean zero."""
        count = frequency_count(self.longest, self.shortest, RATIO) + 1
        phases = draw_phases(self.seed, RIDGES, count - 1)
        dimension, length = self.fractal_dimension, self.longest
        amplitude = length * (self.fractal_roughness / length) ** (dimension - 2.0) * sqrt(log(RATIO) / RIDGES)
        spectrum = np.zeros((points, points), dtype=complex)
        for ridge in range(RIDGES):
            for order in range(count):
                number = self.waves * RATIO**order
                angle = pi * (ridge + 1) / RIDGES
                row, column = round(number * np.sin(angle)), round(number * np.cos(angle))
                spectrum[row % points, column % points] -= (
                    amplitude * RATIO ** ((dimension - 3.0) * order) * np.exp(1j * phases[ridge, order])
                )
        heights = np.fft.ifft2(spectrum).real * points**2
        return np.asarray(heights - heights.mean())


@dataclass(frozen=True)
class Pressed:
    """A contact under load."""

    pressure: FloatArray  # (n, n) Pa
    iterations: int

    @property
    def contact(self) -> np.ndarray:
        """(n, n) True where the pressure is above zero."""
        return self.pressure > 0.0


def pressed(heights: FloatArray, side: float, modulus: float, mean: float, hardness: float | None = None) -> Pressed:
    """The contact under the mean pressure ``mean`` Pa; ``modulus`` E* and ``hardness`` in Pa (None: elastic).

    ContactMechanics: constrained conjugate gradients of Polonsky and Keer, with the pressure limited to the hardness.
    These do not converge for many contacts with nearly all points at the hardness; ``pressed_by_projection`` solves
    them. Raises RuntimeError if neither converges.
    """
    from ContactMechanics import PeriodicFFTElasticHalfSpace
    from ContactMechanics.Optimization import constrained_conjugate_gradients
    from SurfaceTopography import Topography

    n = heights.shape[0]
    pixel = (side / n) ** 2
    limit = {} if hardness is None else {"hardness": hardness * pixel}
    result = constrained_conjugate_gradients(
        PeriodicFFTElasticHalfSpace((n, n), modulus, (side, side)),
        Topography(heights, (side, side), periodic=True),
        external_force=mean * side**2,
        pentol=1e-6 * float(heights.std()),
        maxiter=150,
        **limit,
    )
    if not result.success:
        if hardness is None:
            raise RuntimeError(f"no contact under {mean:g} Pa: {result.message}")
        return pressed_by_projection(heights, side, modulus, mean, hardness)
    return Pressed(np.asarray(result.jac / pixel), int(result.nit))


def pressed_by_projection(heights: FloatArray, side: float, modulus: float, mean: float, hardness: float) -> Pressed:
    """The same: the least energy of all pressures from 0 to the hardness with this mean, by projected gradients.

    Steps by Barzilai and Borwein; the projection on limits and mean is a shift, found by bisection. Converged if the
    gap of the points between the limits varies by less than 1e-4 of Sq, and no point beyond a limit pulls back by more.
    Raises RuntimeError after 6000 steps.
    """
    inverse = _kernel(heights.shape[0], side, modulus)
    pressure = _projected(hardness * (heights > np.quantile(heights, 1.0 - mean / hardness)), mean, hardness)
    goal, step = 1e-4 * float(heights.std()), 0.1 * modulus / side
    gradient = irfft2(inverse * rfft2(pressure), heights.shape) - heights
    for count in range(6000):
        after = _projected(pressure - step * gradient, mean, hardness)
        change = after - pressure
        pressure, before = after, gradient
        gradient = irfft2(inverse * rfft2(pressure), heights.shape) - heights
        free = (pressure > 0.0) & (pressure < hardness)
        if count % 20 == 0 and free.any():
            gap = gradient - gradient[free].mean()
            wrong = (np.abs(gap[free]).max(), -gap[pressure == 0.0].min(), gap[pressure == hardness].max(initial=0.0))
            if max(wrong) < goal:
                return Pressed(pressure, count)
        bend = float((change * (gradient - before)).sum())
        step = float((change**2).sum()) / bend if bend > 0.0 else step
    raise RuntimeError(f"no contact under {mean:g} Pa after {count + 1} projected steps")


def _projected(pressure: FloatArray, mean: float, hardness: float) -> FloatArray:
    """The nearest pressure between 0 and the hardness with this mean: shifted, then cut."""
    low, high = float(pressure.min()) - hardness, float(pressure.max())
    for _ in range(60):
        shift = 0.5 * (low + high)
        if np.clip(pressure - shift, 0.0, hardness).mean() > mean:
            low = shift
        else:
            high = shift
    return np.clip(pressure - high, 0.0, hardness)


def pressed_by_tamaas(heights: FloatArray, side: float, modulus: float, mean: float) -> Pressed:
    """The same for an elastic contact, by another program (AGPL)."""
    import tamaas

    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.Model(tamaas.model_type.basic_2d, [side, side], list(heights.shape))
    model.E, model.nu = modulus, 0.0
    solver = tamaas.PolonskyKeerRey(model, heights, 1e-8)
    solver.max_iter = 20000
    solver.solve(mean)
    return Pressed(np.array(model.traction).reshape(heights.shape), 0)


def small_oscillation(contact: np.ndarray, side: float, modulus: float, poisson_ratio: float) -> tuple[float, ...]:
    """Stiffness per area (N/m3) of a small motion: normal, along x, along y; all points of ``contact`` move as one.

    ``poisson_ratio`` is that of both bodies; normal and tangential motion are then independent (Johnson, Contact
    Mechanics, section 2.2 and 7.1). Surface of a half-space under traction of wave number q: normal u = 2 p / (E* q),
    tangential u_i = 2 / (E* q (1 - nu)) (delta_ij - nu q_i q_j / q^2) tau_j.
    """
    qx, qy = _wave_numbers(contact.shape[0], side)
    q, inverse = np.hypot(qx, qy), _kernel(contact.shape[0], side, modulus)
    direction = np.divide(1.0, q**2, out=np.zeros_like(q), where=q > 0.0)
    nu = poisson_ratio
    factor = inverse / (1.0 - nu)
    along = (factor * (1.0 - nu * qx**2 * direction), factor * (1.0 - nu * qy**2 * direction))
    across = -factor * nu * qx * qy * direction
    normal = _punch(contact, [[inverse]], 0)
    kernel = [[along[0], across], [across, along[1]]]
    return normal, _punch(contact, kernel, 0), _punch(contact, kernel, 1)


def _wave_numbers(n: int, side: float) -> tuple[FloatArray, FloatArray]:
    """Along x and y, as ``rfft2`` orders them."""
    return 2.0 * pi / side * np.fft.rfftfreq(n, 1.0 / n)[None, :], 2.0 * pi / side * np.fft.fftfreq(n, 1.0 / n)[:, None]


def _kernel(n: int, side: float, modulus: float) -> FloatArray:
    """Normal displacement for unit pressure, 2 / (E* q); 0 for the mean."""
    q = np.hypot(*_wave_numbers(n, side))
    return np.divide(2.0 / modulus, q, out=np.zeros_like(q), where=q > 0.0)


def _punch(contact: np.ndarray, kernel: list[list[FloatArray]], moved: int) -> float:
    """Mean traction over the displacement ``moved`` of the points of ``contact``, by conjugate gradients."""
    shape, size = contact.shape, len(kernel)

    def displacement(traction: FloatArray) -> FloatArray:
        waves = [rfft2(each) for each in traction]
        return np.array(
            [irfft2(sum(kernel[i][j] * waves[j] for j in range(size)), shape) * contact for i in range(size)]
        )

    # The unknown traction makes the displacement 1 along ``moved`` on the contact.
    traction = np.zeros((size, *shape))
    residual = np.zeros((size, *shape))
    residual[moved] = contact
    search, squared = residual.copy(), float((residual**2).sum())
    goal = (1e-3) ** 2 * squared  # the stiffness is stationary: its error is the square of this
    while squared > goal:
        image = displacement(search)
        step = squared / float((search * image).sum())
        traction += step * search
        residual -= step * image
        previous, squared = squared, float((residual**2).sum())
        search = residual + squared / previous * search
    return float(traction[moved].mean())
