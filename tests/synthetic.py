"""A small two-blade case that answers in a second: the same faces and pairs as the real one, ten unknowns.

Each blade has a flap and an edgewise mode, the damper is rigid; the 2 x 55 contact pairs sit on two faces at 30 deg.
The balance is solved here by a plain Newton method with frequency stepping, so tests of results and report do not
lean on the solver of the package.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import scipy.linalg

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import HarmonicForce, harmonic_force, harmonic_tangent
from stickslip.core.validation import FloatArray
from stickslip.results.linear_curves import LinearCurves
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.rough_patch import RoughPatch

FLAP, EDGE = 2 * np.pi * 418.0, 2 * np.pi * 1229.0
MODAL_MASS, DAMPER_MASS = 0.050, 0.0114
DAMPER_INERTIA = DAMPER_MASS * np.array([7.7e-7, 1.0e-7, 7.7e-7]) * 100.0
DAMPING_RATIO = 0.002  # high enough for a curve without a fold, which steps in frequency follow
N_UNKNOWNS = 10


def face_grid(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions (columns * rows, 2) m along the length and across the width of one face, and nodal areas m2."""
    length, width = np.linspace(-0.014, 0.014, columns), np.linspace(0.0, 0.0065, rows)
    along = np.full(columns, 0.028 / (columns - 1))
    across = np.full(rows, 0.0065 / (rows - 1))
    along[[0, -1]] *= 0.5
    across[[0, -1]] *= 0.5
    position = np.stack(np.meshgrid(length, width, indexing="ij"), axis=-1).reshape(-1, 2)
    return position, np.outer(along, across).ravel()


def _kinematics(point: np.ndarray, side: int) -> np.ndarray:
    """(3, 10) displacement of the damper minus that of the blade at a point of the face."""
    cross = np.array([[0, point[2], -point[1]], [-point[2], 0, point[0]], [point[1], -point[0], 0]])
    blade = np.zeros((3, N_UNKNOWNS))
    flap, edge = (0, 2) if side < 0 else (1, 3)
    offset = point[0] - side * 0.0175
    blade[0, flap], blade[2, flap] = 0.18, -2.2 * offset - 0.5 * point[1]
    blade[1, edge], blade[2, edge] = 0.09, -4.0 * point[1]
    damper = np.hstack([np.zeros((3, 4)), np.eye(3), cross])
    return damper - blade


def _model(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray, ContactPairs, np.ndarray]:
    position, area = face_grid(columns, rows)
    cosine, sine = np.cos(np.pi / 6), np.sin(np.pi / 6)
    operator = []
    for side in (-1, 1):
        frame = np.array([[0, 1, 0], [-side * cosine, 0, sine], [side * sine, 0, cosine]])
        for y, s in position:
            point = np.array([side * (0.0005 + s * cosine), y, -s * sine])
            point[0] = side * (0.0005 + (0.0065 - s) * cosine)
            point[2] = (s - 0.00325) * sine
            operator.append(frame @ _kinematics(point, side))
    share = np.tile(area / area.sum(), 2)
    pairs = ContactPairs(
        np.vstack(operator),
        normal_stiffness=2.0e7 * share,
        tangential_stiffness=1.6e7 * share,
        friction_coefficient=0.2,
        preload=70.0 * share * np.tile(1.7 - np.abs(position[:, 0]) / 0.012, 2),
    )
    mass = np.diag([MODAL_MASS] * 4 + [DAMPER_MASS] * 3 + list(DAMPER_INERTIA))
    stiffness = np.diag(MODAL_MASS * np.array([FLAP, FLAP, EDGE, EDGE]) ** 2)
    stiffness = np.pad(stiffness, ((0, 6), (0, 6)))
    # A released slider carries no mean traction, so the damper is held along the faces by a soft ground spring.
    stiffness[4:, 4:] = np.diag([2e3] * 3 + [0.1] * 3)
    return mass, stiffness, pairs, np.tile(area, 2)


def _dynamic_stiffness(
    mass: FloatArray, damping: FloatArray, stiffness: FloatArray, omega: float, harmonics: int
) -> FloatArray:
    n = len(mass)
    blocks = [stiffness]
    for order in range(1, harmonics + 1):
        w = order * omega
        diagonal, cross = stiffness - w**2 * mass, w * damping
        blocks.append(np.block([[diagonal, cross], [-cross, diagonal]]))
    matrix = scipy.linalg.block_diag(*blocks)
    # unknowns are stored (n, 2H+1); the blocks above hold (2H+1, n)
    position = np.arange(n * (2 * harmonics + 1)).reshape(2 * harmonics + 1, n).T.ravel()
    return np.asarray(matrix[np.ix_(position, position)])


@cache
def synthetic_response(
    columns: int = 11,
    rows: int = 5,
    harmonics: int = 3,
    samples: int = 64,
    n_points: int = 40,
    force_amplitude: float = 0.42,
) -> ForcedResponse:
    """Upward frequency sweep through the first stuck mode; every array of the response is computed, none invented."""
    mass, stiffness, pairs, _ = _model(columns, rows)
    n_col, size = 2 * harmonics + 1, N_UNKNOWNS * (2 * harmonics + 1)
    stuck = stiffness + pairs.operator.T @ (pairs.stuck_stiffness()[:, None] * pairs.operator)
    values, modes = scipy.linalg.eigh(stuck, mass)
    natural = np.sqrt(np.abs(values))
    shape = mass @ modes
    damping = shape @ np.diag(2 * DAMPING_RATIO * natural) @ shape.T
    force = np.zeros((N_UNKNOWNS, n_col))
    force[0, 2] = force_amplitude
    force[2, 2] = 4.0 * force_amplitude
    flap = natural / (2 * np.pi)
    first = flap[0]
    fine = first * (1 + 0.004 * np.sinh(np.linspace(-2.6, 2.2, n_points)))

    def balance(x: FloatArray, omega: float) -> tuple[FloatArray, HarmonicForce, FloatArray, FloatArray]:
        coefficients = (pairs.operator @ x).reshape(pairs.n_pairs, 3, n_col)
        contact = harmonic_force(coefficients, pairs, samples)
        linear = _dynamic_stiffness(mass, damping, stiffness, omega, harmonics)
        residual = (linear @ x.ravel()).reshape(x.shape) - force
        residual += pairs.operator.T @ contact.force.reshape(-1, n_col)
        return coefficients, contact, linear, residual

    x = _linear(mass, damping, stuck, force, fine[:1], harmonics)[0]
    rows_out: dict[str, list[Any]] = {
        name: []
        for name in ("x", "state", "energy", "closure", "residual", "iterations", "input", "viscous", "kinetic")
    }
    for frequency in fine:
        omega = 2 * np.pi * frequency
        for iteration in range(30):  # noqa: B007
            coefficients, contact, linear, residual = balance(x, omega)
            error = np.linalg.norm(residual) / np.linalg.norm(force)
            if error < 1e-10:
                break
            tangent = harmonic_tangent(coefficients, pairs, samples, np.arange(pairs.n_pairs))
            arms = pairs.operator.reshape(pairs.n_pairs, 3, N_UNKNOWNS)
            # (i, u, p, b, q) of matrix products, then the sum over i and b; einsum took ten times as long.
            moved = np.matmul(arms.transpose(0, 2, 1), tangent.reshape(pairs.n_pairs, 3, -1))
            moved = moved.reshape(pairs.n_pairs, N_UNKNOWNS, *tangent.shape[2:])
            joint = np.tensordot(moved, arms, axes=([0, 3], [0, 1])).transpose(0, 1, 3, 2)
            x = x - np.linalg.solve(linear + joint.reshape(size, size), residual.ravel()).reshape(x.shape)
        else:
            raise AssertionError(f"the synthetic case did not converge at {frequency:.3f} Hz: {error:.1e}")
        order = np.arange(1, harmonics + 1)
        energy = _work(contact.force, coefficients, order)
        cosine, sine = x[:, 1::2], x[:, 2::2]
        viscous = np.pi * omega * (order**2 * ((damping @ cosine) * cosine + (damping @ sine) * sine)).sum()
        work = _work(force, x, order).sum()
        kinetic = 0.5 * omega**2 * sum(x[:, part] @ mass @ x[:, part] for part in (1, 2))
        for name, value in zip(
            rows_out,
            (x, contact.state, energy, contact.closure, error, iteration, work, viscous, kinetic),
            strict=True,
        ):
            rows_out[name].append(value)
    free_modes = np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True).clip(0)) / (2 * np.pi)
    released = free_modes[free_modes > 400.0]
    wide = np.unique(np.concatenate([np.linspace(405.0, 1.04 * first, 500), 418 + np.linspace(-2, 2, 81), fine]))
    free_damping = np.pad(
        np.diag(2 * DAMPING_RATIO * MODAL_MASS * np.array([FLAP, FLAP, EDGE, EDGE])), ((0, 6), (0, 6))
    )
    return ForcedResponse(
        frequency_hz=fine,
        displacement=np.array(rows_out["x"]),
        contact_state=np.array(rows_out["state"]),
        dissipated_energy=np.array(rows_out["energy"]),
        normal_work=np.zeros_like(rows_out["energy"]),
        closure=np.array(rows_out["closure"]),
        residual=np.array(rows_out["residual"]),
        iterations=np.array(rows_out["iterations"]),
        input_energy=np.array(rows_out["input"]),
        viscous_energy=np.array(rows_out["viscous"]),
        kinetic_energy=np.array(rows_out["kinetic"]),
        converged=True,
        message=f"{n_points} points from {fine[0]:.1f} to {fine[-1]:.1f} Hz.",
        warnings=(),
        harmonics=harmonics,
        samples=samples,
        pairs=pairs,
        linear=LinearCurves(
            wide,
            _linear(mass, damping, stuck, force, wide, harmonics),
            _linear(mass, free_damping, stiffness, force, wide, harmonics),
            flap,
            released,
        ),
        force=force,
        settings={"update": "tractrix", "tolerance": 1e-10, "harmonics": harmonics, "samples": samples},
        provenance={"stickslip": "synthetic", "date": "2026-11-21T00:00:00+00:00"},
    )


def _work(force: np.ndarray, displacement: np.ndarray, order: np.ndarray) -> np.ndarray:
    """(m,) J per cycle that a force (m, ..., 2H+1) does on a displacement, over harmonics and directions."""
    product = displacement[..., 2::2] * force[..., 1::2] - displacement[..., 1::2] * force[..., 2::2]
    return np.asarray(np.pi * (order * product).reshape(len(force), -1).sum(axis=1))


def _linear(
    mass: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    force: FloatArray,
    frequency_hz: FloatArray,
    harmonics: int,
) -> FloatArray:
    """(q, n, 2H+1) of a linear structure under the first harmonic."""
    answer = np.zeros((len(frequency_hz), *force.shape))
    for i, frequency in enumerate(frequency_hz):
        w = 2 * np.pi * frequency
        amplitude = np.linalg.solve(stiffness - w**2 * mass + 1j * w * damping, force[:, 1] - 1j * force[:, 2])
        answer[i, :, 1], answer[i, :, 2] = amplitude.real, -amplitude.imag
    return answer


def synthetic_patch() -> RoughPatch:
    """A wavy face of the size and the number of heights that a run gives its page."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 140), np.linspace(0.0, 1.0, 40))
    height = 50e-6 * np.sin(23.0 * x + 3.0 * y) + 8e-6 * np.sin(150.0 * x - 40.0 * y) + 1e-3
    return RoughPatch(0.028, 0.0065, height, sq=54.0e-6, sdq=0.82)


@cache
def synthetic_study(columns: int = 11, rows: int = 5) -> StudyRecord:
    """The record that goes with :func:`synthetic_response` of the same grid."""
    position, area = face_grid(columns, rows)
    outputs = {
        "A, tip of the left blade, flap": np.eye(N_UNKNOWNS)[0],
        "B, tip of the right blade": np.eye(N_UNKNOWNS)[1],
    }
    groups = {}
    for side, name in ((-1, "left"), (1, "right")):
        rows_of_side = -_kinematics(np.array([side * 0.0033, 0.0, 0.0]), side)
        rows_of_side[:, :4] = 0.0
        names = tuple(f"damper {name} {axis}" for axis in "xyz")
        outputs.update(zip(names, -rows_of_side, strict=True))
        groups[f"Damper, {name} side"] = names
    reference = (506.83, 526.37, 1230.7, 1325.7, 2567.1, 3206.6, 3559.8, 3575.5, 4802.1, 5449.5)
    full = (507.29, 526.67, 1231.24, 1325.43, 2565.49, 3197.74, 3534.42, 3556.06, 4800.13, 5454.99)
    difference = (1.3e-4, 1.46e-4, 6.44e-4, 4.01e-4, 1.09e-2, 4.22e-3, 1.72e-4, 3.58e-4, 1.24e-1, 8.49e-2)
    words = ("1st flap", "1st edgewise", "2nd flap", "1st torsion")
    description = [f"{word}, {phase}" for word in words for phase in ("in phase", "out of phase")]
    description += ["3rd flap (shank and platform), in phase", "2nd edgewise, in phase"]
    return StudyRecord(
        title="Two blades with an under-platform damper (synthetic)",
        description="A ten-unknown stand-in with the faces and pairs of the real case. Excitation at N1 of the left "
        "blade, response at its tip A.",
        inputs='[structure]\nmodel = "synthetic"\n\n[contact]\nfriction_coefficient = 0.3\n'
        'fractal_dimension = 2.4\nfractal_roughness = "1e-8 m"\n\n[load]\ncentrifugal_force = "78 N"\n',
        outputs=outputs,
        signal_groups=groups,
        face_names=("Left face", "Right face"),
        pair_face=np.repeat([0, 1], len(area)),
        pair_position=np.tile(position, (2, 1)),
        pair_area=np.tile(area, 2),
        mode_table=tuple(
            {
                "mode": i + 1,
                "description": description[i],
                "full_hz": full[i],
                "reduced_hz": full[i] * (1 + difference[i] / 100),
                "difference_percent": difference[i],
                "mac": 1.0 - difference[i] * 4e-4,
                "reference_hz": reference[i],
            }
            for i in range(10)
        ),
        mode_reference="modal test of the two blades",
        derived=(
            ("Sq", 54.0e-6, "m", "rms height of a face over its length"),
            ("Normal stiffness of a face", 2.0e7, "N/m", "all 55 pairs together"),
            ("Tangential stiffness of a face", 1.6e7, "N/m", "all 55 pairs together"),
            ("Preload of a face", 77.0, "N", "higher in the middle of the length"),
            ("Reduced model", 10, "unknowns", "boundary and modal unknowns"),
        ),
        warnings=(),
        rough_patch=synthetic_patch(),
    )
