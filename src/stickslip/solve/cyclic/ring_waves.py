"""The modes of a whole disk in its waves: products with one matrix a wave instead of one of all sectors.

Coefficients of the unknowns and of the pairs are those of sector after sector. In the wave d the tuned disk moves by
``u_s = N^-1/2 e^{2 pi i d s / N} q_d``, so a Fourier transform over the sectors parts its matrices into those of the
waves (block-circulant matrices; P. J. Davis, Circulant Matrices, 1979). Modal amplitudes are those of wave after wave.
Blades that differ change the stiffness of the disk by ``P^H diag(c) P`` with k rows a blade
(:mod:`stickslip.structure.blade_alone`), which the formula of Sherman, Morrison and Woodbury adds to the response.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.gain import ComplexArray, DiagonalGain, times_gain, to_complex, to_real
from stickslip.solve.harmonic.harmonic_modes import IndexArray


def to_waves(of_sectors: NDArray[Any]) -> ComplexArray:
    """Waves (..., N, k) of values in each sector."""
    return np.asarray(np.fft.fft(of_sectors, axis=-2, norm="ortho"))


def to_sectors(of_waves: NDArray[Any]) -> ComplexArray:
    """Values (..., N, k) in each sector of waves."""
    return np.asarray(np.fft.ifft(of_waves, axis=-2, norm="ortho"))


def products(matrices: NDArray[Any], vectors: NDArray[Any]) -> ComplexArray:
    """Products (..., N, a) of a matrix (N, a, b) for each wave with vectors (..., N, b)."""
    shape = vectors.shape
    columns = vectors.reshape(math.prod(shape[:-2]), *shape[-2:]).transpose(1, 2, 0)
    return np.asarray((matrices @ columns).transpose(2, 0, 1).reshape(*shape[:-1], matrices.shape[1]))


def adjoint(matrices: NDArray[Any]) -> NDArray[Any]:
    """Conjugate transposes (N, b, a)."""
    return np.ascontiguousarray(matrices.conj().swapaxes(1, 2))


@dataclass(frozen=True)
class BladeChange:
    """Changes of stiffness of the blades: ``participation`` (N, k, r) of each wave's coordinates, ``changes`` (N k,)
    (rad/s)^2 of sector after sector."""

    participation: NDArray[Any]
    changes: FloatArray

    @cached_property
    def _adjoint(self) -> NDArray[Any]:
        return adjoint(self.participation)

    def core(self, compliance: NDArray[Any]) -> ComplexArray:
        """``(I + C Q)^-1 C`` (N k, N k) with ``Q = P A P^H`` of a tuned response, whose waves (N, k, k) are
        ``compliance``."""
        count, rows = compliance.shape[:2]
        blocks = np.fft.ifft(compliance, axis=0)
        ahead = (np.arange(count)[:, None] - np.arange(count)) % count
        whole = blocks[ahead].transpose(0, 2, 1, 3).reshape(count * rows, count * rows)
        return np.linalg.solve(np.eye(count * rows) + self.changes[:, None] * whole, np.diag(self.changes))

    def core_of_gain(self, gain: ComplexArray) -> ComplexArray:
        """The cores (H, N k, N k) of responses with gains (H, N, r)."""
        return np.array([self.core((self.participation * each[:, None]) @ self._adjoint) for each in gain])

    def forces(self, core: ComplexArray, amplitude: ComplexArray) -> ComplexArray:
        """(..., H, N, r) the forces of the changes on amplitudes (..., H, N, r) of the tuned response."""
        moved = to_sectors(products(self.participation, amplitude))
        shape = moved.shape
        resisted = np.matmul(core, moved.reshape(*shape[:-2], -1)[..., None])[..., 0]
        return products(self._adjoint, to_waves(resisted.reshape(shape)))


class MistunedGain(DiagonalGain):
    """The gains of the tuned modes (N, r) of all waves, with blades that differ; damping is that of the tuned disk."""

    def __init__(
        self, circular_frequency: FloatArray, damping: FloatArray, harmonics: int, near: int, change: BladeChange
    ) -> None:
        self.shape = circular_frequency.shape
        super().__init__(circular_frequency.ravel(), damping.ravel(), harmonics, near)
        self._change = change
        self._core: tuple[float, ComplexArray] | None = None

    def answer(self, omega: float, force: FloatArray) -> FloatArray:
        gain = self._gain(omega).reshape(self.harmonics, *self.shape)
        if self._core is None or self._core[0] != omega:
            self._core = omega, self._change.core_of_gain(gain)
        amplitude = gain * to_complex(force).reshape(gain.shape)
        amplitude -= gain * self._change.forces(self._core[1], amplitude)
        return to_real(amplitude.reshape(self.harmonics, -1))

    def slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        return -self.answer(omega, times_gain(self._own.by_frequency(omega), amplitude))

    def near(self, omega: float) -> ComplexArray:
        """(H, N, near_modes) of the tuned disk; :class:`RingNewton` adds the change of the blades."""
        return self._gain(omega).reshape(self.harmonics, *self.shape)[:, :, : self.near_modes]


@dataclass(frozen=True)
class RingStatic:
    """The mean response of the disk to forces on its pairs.

    ``contact`` (N, m, m) is the compliance of the tuned disk, ``blade`` (N, k, m) the participation of the blades under
    forces on the pairs, and ``output`` (N, 1, m) the displacement that a result shows; ``of_blade`` (N, m, k) and
    ``output_of_blade`` (N, 1, k) are those under the forces of blades, ``core`` (N k, N k) is that of their changes.
    """

    contact: ComplexArray
    blade: ComplexArray
    output: ComplexArray
    of_blade: ComplexArray
    output_of_blade: ComplexArray
    core: ComplexArray

    def relative(self, force: FloatArray) -> FloatArray:
        """(..., N m) mean relative displacements under mean forces (..., N m)."""
        return self._response(self.contact, self.of_blade, force)

    def outputs(self, force: FloatArray) -> FloatArray:
        """(N,) mean of the output of each sector under mean forces (N m,) on the pairs."""
        return self._response(self.output, self.output_of_blade, force)

    def _response(self, tuned: ComplexArray, of_blade: ComplexArray, force: FloatArray) -> FloatArray:
        lead = force.shape[:-1]
        waves = to_waves(force.reshape(*lead, len(self.contact), self.contact.shape[2]))
        moved = to_sectors(products(self.blade, waves))
        resisted = to_waves((moved.reshape(*lead, len(self.core)) @ self.core.T).reshape(moved.shape))
        answer = to_sectors(products(tuned, waves) - products(of_blade, resisted)).real
        return np.asarray(answer.reshape(*lead, answer.shape[-2] * answer.shape[-1]))


class RingModes:
    """Modes of all waves, see :class:`stickslip.solve.harmonic.harmonic_modes.HarmonicModes`.

    Parameters
    ----------
    modes, contact:
        (N, n, n) and (N, m, n) of each wave, the modes and their relative displacements in a sector.
    circular_frequency:
        (N, n) rad/s.
    near:
        number of modes of each wave that are not springs in Newton's matrix.
    change:
        the changes of the blades, in the coordinates of the modes.
    static:
        the mean response, which the balance of a disk takes from here.
    """

    def __init__(
        self,
        modes: ComplexArray,
        contact: ComplexArray,
        circular_frequency: FloatArray,
        near: int,
        change: BladeChange,
        static: RingStatic,
    ) -> None:
        self._modes, self._contact, self._static = modes, contact, static
        self._of_force, self._of_contact = adjoint(modes), adjoint(contact)
        far = contact[:, :, near:]
        self._far = (far / circular_frequency[:, None, near:] ** 2) @ adjoint(far)
        self._near = np.ascontiguousarray(contact[:, :, :near]), np.ascontiguousarray(self._of_contact[:, :near])
        self._change = BladeChange(np.ascontiguousarray(change.participation[:, :, :near]), change.changes)

    def of_force(self, force: FloatArray) -> FloatArray:
        """``Phi_d^H p_d``."""
        return self._onto_modes(self._of_force, force)

    def of_contact(self, force: FloatArray) -> FloatArray:
        """``(B_d Phi_d)^H f_d``."""
        return self._onto_modes(self._of_contact, force)

    def relative(self, amplitude: FloatArray, out: FloatArray) -> None:
        """``B_d Phi_d q_d`` in the sectors."""
        out[:] = self._in_sectors(self._contact, amplitude)

    def displacement(self, amplitude: FloatArray) -> FloatArray:
        """``Phi_d q_d`` in the sectors."""
        rows = amplitude.reshape(-1, *amplitude.shape[-2:])
        return np.array([self._in_sectors(self._modes, each) for each in rows]).reshape(amplitude.shape)

    def newton(self, mean_contact: FloatArray, columns: IndexArray, gain: ComplexArray) -> RingNewton:
        """See :class:`stickslip.solve.harmonic.harmonic_modes.HarmonicModes`; the mean is that of ``static``."""
        return RingNewton(self._static, self._far, *self._near, self._change, gain, columns)

    def _onto_modes(self, matrices: ComplexArray, force: FloatArray) -> FloatArray:
        amplitudes = to_complex(force)
        waves = to_waves(amplitudes.reshape(len(amplitudes), len(matrices), -1))
        return to_real(products(matrices, waves).reshape(len(amplitudes), -1))

    def _in_sectors(self, matrices: ComplexArray, amplitude: FloatArray) -> FloatArray:
        amplitudes = to_complex(amplitude)
        waves = products(matrices, amplitudes.reshape(len(amplitudes), len(matrices), -1))
        return to_real(to_sectors(waves).reshape(len(amplitudes), -1))


@dataclass(frozen=True)
class RingNewton:
    """``A_h`` of a disk with near modes and springs for the far ones
    (:class:`stickslip.solve.harmonic.harmonic_modes.NewtonOperator`); ``gain`` is (H, N, p).

    ``left`` (N, m, p) and ``right`` (N, p, m) are the near modes at the pairs.
    """

    static: RingStatic
    far: ComplexArray
    left: ComplexArray
    right: ComplexArray
    change: BladeChange
    gain: ComplexArray
    columns: IndexArray

    @cached_property
    def _core(self) -> ComplexArray:
        return self.change.core_of_gain(self.gain)

    @property
    def _rows(self) -> int:
        return int(self.far.shape[0] * self.far.shape[1])

    @cached_property
    def mean(self) -> FloatArray:
        """(k, m) A of the mean."""
        return self.static.relative(np.eye(self._rows)[self.columns])

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""
        force = np.zeros((len(deviation), self._rows))
        force[:, self.columns] = deviation
        answer = np.empty_like(force)
        answer[0] = self.static.relative(force[0])
        answer[1:] = self._moved(force[1:], self.gain, self._core)
        return answer

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        answer = np.empty((len(weights), self.columns.size))
        answer[0] = self.static.relative(weights[0])[self.columns]  # the mean is symmetric
        cores = self._core.conj().swapaxes(1, 2)
        answer[1:] = self._moved(weights[1:], self.gain.conj(), cores)[:, self.columns]
        return answer

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        count, size = self.far.shape[:2]
        gain, core = self.gain[order - 1], self._core[order - 1]
        tuned = np.fft.ifft(self.far + (self.left * gain[:, None]) @ self.right, axis=0)
        (first, row), (second, column) = np.divmod(rows, size), np.divmod(self.columns, size)
        answer = tuned[(first[:, None] - second) % count, row[:, None], column]
        bent = np.fft.ifft((self.change.participation * gain[:, None]) @ self.right, axis=0)
        turned = np.fft.ifft((self.left * gain[:, None]) @ adjoint(self.change.participation), axis=0)
        sectors = np.arange(count)
        onto = bent[(sectors[:, None] - second) % count, :, column].transpose(0, 2, 1).reshape(len(core), column.size)
        back = turned[(first[:, None] - sectors) % count, row[:, None]].reshape(rows.size, len(core))
        return np.asarray(answer - back @ (core @ onto))

    def _moved(self, force: FloatArray, gain: ComplexArray, core: ComplexArray) -> FloatArray:
        amplitudes = to_complex(force)
        waves = to_waves(amplitudes.reshape(len(amplitudes), len(self.far), -1))
        amplitude = gain * products(self.right, waves)
        amplitude -= gain * self.change.forces(core, amplitude)
        moved = to_sectors(products(self.left, amplitude) + products(self.far, waves))
        return to_real(moved.reshape(len(amplitudes), -1))
