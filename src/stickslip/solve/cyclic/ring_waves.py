"""The modes of a whole disk in its waves: products with one matrix a wave instead of one of all sectors.

Coefficients of the unknowns and of the pairs are those of sector after sector. In the wave d the tuned disk moves by
``u_s = N^-1/2 e^{2 pi i d s / N} q_d``, so a Fourier transform over the sectors parts its matrices into those of the
waves (block-circulant matrices; P. J. Davis, Circulant Matrices, 1979). Coefficients are real, so the waves d and N - d
have conjugate amplitudes: arrays contain the D + 1 = N // 2 + 1 waves from 0 to N / 2 alone, and matrices as many.

Modal amplitudes are real too, those of the standing waves: ``q_d = x_d`` where the wave is its own opposite (d = 0 and
N / 2), and else ``q_d = (x_d + i y_d) / sqrt(2)``, in the order x_0, x_1, ... x_D, y_1, y_2, ... Their Euclidean norm
is the mass norm of the motion. Blades that differ change the stiffness of the disk by ``P^H diag(c) P`` with k rows a
blade (:mod:`stickslip.structure.blade_alone`); the formula of Sherman, Morrison and Woodbury adds it to the response.
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
from stickslip.solve.harmonic.harmonic_modes import IndexArray, LocalCompliance, LowRankCompliance

ROOT = math.sqrt(0.5)
# chosen: modes of the preconditioner beside the compliance within sectors, over those without it (24 sectors of 110
# pairs: a third of the shapes, one iteration more).
BESIDE_LOCAL = 3.0


def to_waves(of_sectors: FloatArray) -> ComplexArray:
    """Waves (..., D+1, k) of real values (..., N, k) in the sectors."""
    return np.asarray(np.fft.rfft(of_sectors, axis=-2, norm="ortho"))


def to_sectors(of_waves: ComplexArray, sectors: int) -> FloatArray:
    """Real values (..., N, k) in the sectors of waves (..., D+1, k)."""
    return np.asarray(np.fft.irfft(of_waves, sectors, axis=-2, norm="ortho"))


def both_parts(sectors: int) -> IndexArray:
    """(N,) the wave of each row of standing waves: x_0, ... x_D, y_1, ..."""
    return np.append(np.arange(sectors // 2 + 1), np.arange(1, (sectors + 1) // 2))


def to_standing(of_waves: ComplexArray, sectors: int) -> FloatArray:
    """Standing waves (..., N, k) of waves (..., D+1, k)."""
    single, paired = sectors // 2 + 1, slice(1, (sectors + 1) // 2)
    answer = np.empty((*of_waves.shape[:-2], sectors, of_waves.shape[-1]))
    answer[..., :single, :] = of_waves.real
    answer[..., paired, :] *= 1.0 / ROOT
    np.multiply(of_waves[..., paired, :].imag, 1.0 / ROOT, out=answer[..., single:, :])
    return answer


def from_standing(standing: FloatArray) -> ComplexArray:
    """Waves (..., D+1, k) of standing waves (..., N, k)."""
    sectors = standing.shape[-2]
    single, paired = sectors // 2 + 1, slice(1, (sectors + 1) // 2)
    answer = standing[..., :single, :].astype(complex)
    answer[..., paired, :] += 1j * standing[..., single:, :]
    answer[..., paired, :] *= ROOT
    return answer


def all_waves(matrices: ComplexArray, sectors: int) -> ComplexArray:
    """(N, a, a) of all waves from those (D+1, a, a) of half of them: the opposite wave has the transpose of a
    compliance."""
    return np.concatenate([matrices, matrices[(sectors - 1) // 2 : 0 : -1].swapaxes(1, 2)])


def products(matrices: NDArray[Any], vectors: NDArray[Any]) -> ComplexArray:
    """Products (..., D+1, a) of a matrix (D+1, a, b) for each wave with vectors (..., D+1, b)."""
    shape = vectors.shape
    columns = vectors.reshape(math.prod(shape[:-2]), *shape[-2:]).transpose(1, 2, 0)
    return np.asarray((matrices @ columns).transpose(2, 0, 1).reshape(*shape[:-1], matrices.shape[1]))


def adjoint(matrices: NDArray[Any]) -> NDArray[Any]:
    """Conjugate transposes (D+1, b, a)."""
    return np.ascontiguousarray(matrices.conj().swapaxes(1, 2))


def standing_shapes(matrices: ComplexArray, sectors: int, place: IndexArray, mode: IndexArray) -> FloatArray:
    """(N a, c) values of matrices (D+1, a, b) in the sectors for unit amplitudes: row ``place`` of the standing waves
    and column ``mode``."""
    wave = both_parts(sectors)[place]
    paired = (wave > 0) & (2 * wave < sectors)
    scale = np.where(paired, 1.0 / ROOT, 1.0) * np.where(place > sectors // 2, 1j, 1.0) / math.sqrt(sectors)
    turned = np.exp(2j * np.pi * np.outer(np.arange(sectors), wave) / sectors) * scale  # (N, c)
    shapes = matrices[wave, :, mode].T  # (a, c)
    return np.asarray((turned[:, None] * shapes).real.reshape(sectors * len(shapes), len(wave)))


@dataclass(frozen=True)
class BladeChange:
    """Changes of stiffness of the blades: ``participation`` (D+1, k, r) of each wave's coordinates, ``changes`` (N k,)
    (rad/s)^2 of sector after sector."""

    participation: ComplexArray
    changes: FloatArray

    @cached_property
    def adjoint(self) -> ComplexArray:
        """(D+1, r, k)."""
        return adjoint(self.participation)

    @property
    def sectors(self) -> int:
        """N."""
        return int(self.changes.size // self.participation.shape[1])

    def core(self, compliance: ComplexArray) -> ComplexArray:
        """``(I + C Q)^-1 C`` (N k, N k) with ``Q = P A P^H`` of a tuned response, whose waves (D+1, k, k) are
        ``compliance``."""
        count, rows = self.sectors, compliance.shape[1]
        blocks = np.fft.ifft(all_waves(compliance, count), axis=0)
        ahead = (np.arange(count)[:, None] - np.arange(count)) % count
        whole = blocks[ahead].transpose(0, 2, 1, 3).reshape(count * rows, count * rows)
        return np.linalg.solve(np.eye(count * rows) + self.changes[:, None] * whole, np.diag(self.changes))

    def core_of_gain(self, gain: ComplexArray) -> ComplexArray:
        """The cores (H, N k, N k) of responses with gains (H, D+1, r)."""
        return np.array([self.core((self.participation * each[:, None]) @ self.adjoint) for each in gain])

    def forces(self, core: ComplexArray, amplitude: ComplexArray) -> ComplexArray:
        """(2H, D+1, r) the forces of the changes on amplitudes (2H, D+1, r) of the tuned response."""
        moved = to_sectors(products(self.participation, amplitude), self.sectors)
        motion = to_complex(moved.reshape(len(moved), -1))
        resisted = to_real(np.matmul(core, motion[..., None])[..., 0])
        return products(self.adjoint, to_waves(resisted.reshape(moved.shape)))


def of_both_parts(gain: ComplexArray, amplitude: ComplexArray) -> ComplexArray:
    """Amplitudes (2H, D+1, r) after gains (H, D+1, r): cosine and sine of a wave are complex, see
    :func:`stickslip.solve.harmonic.gain.times_gain`."""
    answer = np.empty_like(amplitude)
    cosine, sine = amplitude[0::2], amplitude[1::2]
    answer[0::2] = gain.real * cosine + gain.imag * sine
    answer[1::2] = gain.real * sine - gain.imag * cosine
    return answer


class MistunedGain(DiagonalGain):
    """The gains of the tuned modes (D+1, r) of all waves, with blades that differ; damping is that of the tuned disk.

    Amplitudes are those of standing waves.
    """

    def __init__(
        self, circular_frequency: FloatArray, damping: FloatArray, harmonics: int, near: int, change: BladeChange
    ) -> None:
        both = both_parts(change.sectors)
        self.shape = len(both), circular_frequency.shape[1]
        super().__init__(circular_frequency[both].ravel(), damping[both].ravel(), harmonics, near)
        self._change = change
        self._core: tuple[float, ComplexArray] | None = None

    def answer(self, omega: float, force: FloatArray) -> FloatArray:
        gain = self._in_waves(omega)
        if self._core is None or self._core[0] != omega:
            self._core = omega, self._change.core_of_gain(gain)
        amplitude = times_gain(self._gain(omega), force)
        waves = from_standing(amplitude.reshape(-1, *self.shape))
        change = of_both_parts(gain, self._change.forces(self._core[1], waves))
        amplitude -= to_standing(change, self.shape[0]).reshape(amplitude.shape)
        return amplitude

    def slope(self, omega: float, amplitude: FloatArray) -> FloatArray:
        return -self.answer(omega, times_gain(self._own.by_frequency(omega), amplitude))

    def near(self, omega: float) -> ComplexArray:
        """(H, D+1, near_modes) of the tuned disk; :class:`RingNewton` adds the change of the blades."""
        return self._in_waves(omega)[:, :, : self.near_modes]

    def _in_waves(self, omega: float) -> ComplexArray:
        """(H, D+1, r)."""
        return self._gain(omega).reshape(self.harmonics, *self.shape)[:, : self.shape[0] // 2 + 1]


@dataclass(frozen=True)
class RingStatic:
    """The mean response of the disk to forces on its pairs.

    ``contact`` (D+1, m, m) is the compliance of the tuned disk, ``blade`` (D+1, k, m) the participation of the blades
    under forces on the pairs, and ``output`` (D+1, 1, m) the displacement that a result shows; ``of_blade`` (D+1, m, k)
    and ``output_of_blade`` (D+1, 1, k) are those under the forces of blades, ``core`` (N k, N k) is that of their
    changes.
    """

    contact: ComplexArray
    blade: ComplexArray
    output: ComplexArray
    of_blade: ComplexArray
    output_of_blade: ComplexArray
    core: FloatArray
    sectors: int

    def relative(self, force: FloatArray) -> FloatArray:
        """(..., N m) mean relative displacements under mean forces (..., N m)."""
        return self._response(self.contact, self.of_blade, force)

    def outputs(self, force: FloatArray) -> FloatArray:
        """(N,) mean of the output of each sector under mean forces (N m,) on the pairs."""
        return self._response(self.output, self.output_of_blade, force)

    def _response(self, tuned: ComplexArray, of_blade: ComplexArray, force: FloatArray) -> FloatArray:
        lead = force.shape[:-1]
        waves = to_waves(force.reshape(*lead, self.sectors, self.contact.shape[2]))
        moved = to_sectors(products(self.blade, waves), self.sectors)
        resisted = to_waves((moved.reshape(*lead, len(self.core)) @ self.core.T).reshape(moved.shape))
        answer = to_sectors(products(tuned, waves) - products(of_blade, resisted), self.sectors)
        return np.asarray(answer.reshape(*lead, answer.shape[-2] * answer.shape[-1]))


class RingModes:
    """Modes of all waves, see :class:`stickslip.solve.harmonic.harmonic_modes.HarmonicModes`.

    Parameters
    ----------
    modes, contact:
        (D+1, n, n) and (D+1, m, n) of each wave, the modes and their relative displacements in a sector.
    circular_frequency:
        (D+1, n) rad/s.
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
        self._sectors = static.sectors
        self._of_force, self._of_contact = adjoint(modes), adjoint(contact)
        far = contact[:, :, near:]
        self._far = (far / circular_frequency[:, None, near:] ** 2) @ adjoint(far)
        self._near = np.ascontiguousarray(contact[:, :, :near]), np.ascontiguousarray(self._of_contact[:, :near])
        self._change = BladeChange(np.ascontiguousarray(change.participation[:, :, :near]), change.changes)
        self._shapes: dict[str, tuple[NDArray[np.bool_], FloatArray]] = {}

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
        rows = amplitude.reshape(-1, amplitude.shape[-1])
        return self._in_sectors(self._modes, rows).reshape(amplitude.shape)

    def newton(self, mean_contact: FloatArray, columns: IndexArray, gain: ComplexArray) -> RingNewton:
        """See :class:`stickslip.solve.harmonic.harmonic_modes.HarmonicModes`; the mean is that of ``static``."""
        return RingNewton(self._static, self._far, *self._near, self._change, gain, columns)

    def low_rank(
        self, rows: IndexArray, columns: IndexArray, gain: ComplexArray, compliance: float
    ) -> LowRankCompliance:
        """See :class:`stickslip.solve.harmonic.harmonic_modes.HarmonicModes`, with the static compliance of the tuned
        disk within each sector, on the mean and of the far modes."""
        change, both = self._change, both_parts(self._sectors)
        softness = np.abs(gain).max(axis=0) * (np.abs(self._near[0]) ** 2).sum(axis=1)
        strong = softness > BESIDE_LOCAL * compliance
        shapes = self._standing("pairs", self._near[0], strong)
        blades = self._standing("blades", change.participation, strong)
        own = gain[:, both][:, strong[both]]
        bent = own[:, :, None] * (blades.T @ change.core_of_gain(gain) @ blades) * own[:, None]
        coupled = own[:, :, None] * np.eye(own.shape[1]) - bent
        no_mean = np.empty((rows.size, 0)), np.empty((columns.size, 0))
        return LowRankCompliance(*no_mean, shapes[rows], shapes[columns], coupled, self._local)

    @cached_property
    def _local(self) -> LocalCompliance:
        """The static compliance within a sector."""
        count = self._sectors
        return LocalCompliance(
            *(all_waves(each, count).real.mean(axis=0) for each in (self._static.contact, self._far))
        )

    def _standing(self, name: str, matrices: ComplexArray, chosen: NDArray[np.bool_]) -> FloatArray:
        """:func:`standing_shapes` of ``chosen`` (D+1, b) columns; the last ones are kept, as they hardly change."""
        last = self._shapes.get(name)
        if last is None or not np.array_equal(last[0], chosen):
            place = np.nonzero(chosen[both_parts(self._sectors)])
            last = self._shapes[name] = chosen, standing_shapes(matrices, self._sectors, *place)
        return last[1]

    def _onto_modes(self, matrices: ComplexArray, force: FloatArray) -> FloatArray:
        waves = to_waves(force.reshape(len(force), self._sectors, -1))
        return to_standing(products(matrices, waves), self._sectors).reshape(len(force), -1)

    def _in_sectors(self, matrices: ComplexArray, amplitude: FloatArray) -> FloatArray:
        waves = from_standing(amplitude.reshape(len(amplitude), self._sectors, -1))
        return to_sectors(products(matrices, waves), self._sectors).reshape(len(amplitude), -1)


@dataclass(frozen=True)
class RingNewton:
    """``A_h`` of a disk with near modes and springs for the far ones
    (:class:`stickslip.solve.harmonic.harmonic_modes.NewtonOperator`); ``gain`` is (H, D+1, p).

    ``left`` (D+1, m, p) and ``right`` (D+1, p, m) are the near modes at the pairs.
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
        return int(self.static.sectors * self.far.shape[1])

    @cached_property
    def mean(self) -> FloatArray:
        """(k, m) A of the mean."""
        units = np.zeros((self.columns.size, self._rows))
        units[np.arange(self.columns.size), self.columns] = 1.0
        return self.static.relative(units)

    def apply(self, deviation: FloatArray) -> FloatArray:
        """A @ deviation: (2H+1, m) from (2H+1, k)."""
        force = np.zeros((len(deviation), self._rows))
        force[:, self.columns] = deviation
        answer = np.empty_like(force)
        answer[0] = self.static.relative(force[0])
        answer[1:] = self._moved(force[1:], self.gain, self._core)
        return answer

    def apply_at(self, deviation: FloatArray, rows: IndexArray) -> FloatArray:
        """A @ deviation at some rows: (2H+1, r) from (2H+1, k)."""
        return self.apply(deviation)[:, rows]

    def apply_transposed(self, weights: FloatArray) -> FloatArray:
        """A^T @ weights: (2H+1, k) from (2H+1, m); that of complex amplitudes is the adjoint."""
        answer = np.empty((len(weights), self.columns.size))
        answer[0] = self.static.relative(weights[0])[self.columns]  # the mean is symmetric
        cores = self._core.conj().swapaxes(1, 2)
        answer[1:] = self._moved(weights[1:], self.gain.conj(), cores)[:, self.columns]
        return answer

    def block(self, order: int, rows: IndexArray) -> ComplexArray:
        """``A_h`` (rows, k) of harmonic ``order`` >= 1."""
        count, size = self.static.sectors, self.far.shape[1]
        gain, core = self.gain[order - 1], self._core[order - 1]
        near = (self.left * gain[:, None]) @ self.right
        tuned = np.fft.ifft(all_waves(self.far + near, count), axis=0)
        (first, row), (second, column) = np.divmod(rows, size), np.divmod(self.columns, size)
        answer = tuned[(first[:, None] - second) % count, row[:, None], column]
        alone = self.change.participation
        bent = self._circulant((alone * gain[:, None]) @ self.right, (alone * gain.conj()[:, None]) @ self.right)
        back = self.change.adjoint
        turned = self._circulant((self.left * gain[:, None]) @ back, (self.left * gain.conj()[:, None]) @ back)
        sectors = np.arange(count)
        onto = bent[(sectors[:, None] - second) % count, :, column].transpose(0, 2, 1).reshape(len(core), column.size)
        from_blades = turned[(first[:, None] - sectors) % count, row[:, None]].reshape(rows.size, len(core))
        return np.asarray(answer - from_blades @ (core @ onto))

    def _circulant(self, waves: ComplexArray, opposite: ComplexArray) -> ComplexArray:
        """Blocks (N, a, b) by the distance of two sectors, from those of the waves 0 to D and the conjugate ones of
        their opposites."""
        others = opposite[(self.static.sectors - 1) // 2 : 0 : -1].conj()
        return np.asarray(np.fft.ifft(np.concatenate([waves, others]), axis=0))

    def _moved(self, force: FloatArray, gain: ComplexArray, core: ComplexArray) -> FloatArray:
        waves = to_waves(force.reshape(len(force), self.static.sectors, -1))
        amplitude = of_both_parts(gain, products(self.right, waves))
        amplitude -= of_both_parts(gain, self.change.forces(core, amplitude))
        moved = to_sectors(products(self.left, amplitude) + products(self.far, waves), self.static.sectors)
        return moved.reshape(len(force), -1)
