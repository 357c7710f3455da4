"""Stress of the full mesh over one period at the peak, with the state at rest."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.case.case import Case, CyclicCase, MatrixCase
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.model.layout import Layout
from stickslip.model.model import Model, kind_of, make_excitation, make_static_load
from stickslip.results.band import STRESS_MEASURES
from stickslip.results.peaks import Peak, peaks
from stickslip.results.response import ForcedResponse
from stickslip.results.stress import Region
from stickslip.structure.elasticity import Structure
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.recovery import Recovery
from stickslip.structure.stress import NodalStress, nodal_stress
from stickslip.structure.stress_cycle import StressCycle, largest_over_cycle, stress_cycle, von_mises
from stickslip.study.rest import displacement_at_rest


@dataclass(frozen=True, eq=False)
class StressAtPeak:
    """Stress of a mesh over the period of the highest point of the curve; p rows of nodes and bodies.

    mesh:
        the mesh of the stress.
    displacement:
        (3 * n_nodes, 2H+1) m, coefficients mean, cos 1, sin 1, ...; the mean contains the state at rest.
    nodal:
        node and body of each row, and coefficients (p, 6, 2H+1) Pa, mean, cos 1, sin 1, ...; the mean contains the
        static stress.
    cycle:
        its measures over the period.
    region:
        (p,) codes of :class:`stickslip.results.stress.Region`.
    safety:
        (p,) safety factor of the Goodman line; NaN in bodies without both strengths. None without a check.
    static:
        "solved": the stress at rest is that of the solved preload; "prescribed": that of the prescribed normal loads
        and constant loads, without tractions; "none": nothing loads the structure at rest.
    truncation:
        largest part of the vibration stress (von Mises, sum over the coefficients) by modes that the reduction omits,
        over the largest alternating stress, away from contacts and loads. The stress contains its static estimate.
    """

    mesh: Mesh
    displacement: FloatArray
    nodal: NodalStress
    cycle: StressCycle
    region: IntArray
    safety: FloatArray | None
    static: str
    truncation: float
    frequency_hz: float
    point: int


@dataclass(frozen=True, eq=False)
class _StressAtPoint:
    """Coefficients of the stress at the highest point of a curve: fields as those of :class:`StressAtPeak`.

    omitted:
        (3 * n_nodes, 2H+1) m, the part of the displacement by modes that the reduction omits.
    """

    structure: Structure
    displacement: FloatArray
    omitted: FloatArray
    nodal: NodalStress
    region: IntArray
    static: str
    peak: Peak

    @property
    def is_ordinary(self) -> NDArray[np.bool_]:
        """(p,) whether a row is away from contacts and loads."""
        return np.isin(self.region, (Region.ORDINARY, Region.CONSTRAINED))


def stress_at_peak(case: Case, model: Model, response: ForcedResponse) -> StressAtPeak | None:
    """The stress at the highest point of the curve of the first response.

    None for matrices without a mesh, a sector of a disk, and for a case with ``output.stress = false``.
    """
    found = _stress_at_point(case, model, response) if case.output.stress else None
    if found is None:
        return None
    structure, nodal = found.structure, found.nodal
    omitted = nodal_stress(structure, found.omitted).stress
    cycle = stress_cycle(nodal.stress)
    ordinary = found.is_ordinary
    chosen = ordinary if ordinary.any() else np.ones_like(ordinary)
    largest = float(cycle.alternating[chosen].max())
    return StressAtPeak(
        structure.mesh,
        found.displacement,
        nodal,
        cycle,
        found.region,
        _goodman(structure, nodal, cycle),
        found.static,
        float(von_mises(omitted.swapaxes(1, 2)).sum(axis=1)[chosen].max()) / largest if largest else 0.0,
        float(response.frequency_hz[found.peak.point]),
        found.peak.point,
    )


def largest_stresses_at_peak(case: Case, model: Model, response: ForcedResponse) -> dict[str, float]:
    """Measure of ``results.band.STRESS_MEASURES`` -> Pa at the highest peak, away from contacts and loads.

    The vibration is scaled from the highest computed point of the curve to the peak between points. ``output.stress``
    has no influence. Raises InputError for a structure without stress (:func:`require_stress`), and where each cell
    touches a contact or a load.
    """
    found = _stress_at_point(case, model, response)
    if found is None:
        raise InputError(f"{' and '.join(STRESS_MEASURES)} require the full mesh of bodies, which this model lacks.")
    if not found.is_ordinary.any():
        raise InputError(
            "each cell of the mesh is at a contact or at a load, so there is no stress away from them. Use a finer "
            "mesh."
        )
    coefficients = found.nodal.stress[found.is_ordinary]
    at_point = float(response.amplitude(_first_output(model))[found.peak.point])
    coefficients[..., 1:] *= found.peak.amplitude / at_point
    return dict(zip(STRESS_MEASURES, largest_over_cycle(coefficients), strict=True))


def require_stress(case: Case, of: str) -> None:
    """Raise InputError for a structure without stress, for which ``of`` (a band, a design) cannot have its measures."""
    reasons = {
        MatrixCase: 'requires a mesh, but structure.kind is "matrices"',
        CyclicCase: 'requires the mesh of all bodies, but structure.kind is "cyclic" (a sector of a disk)',
    }
    for kind, reason in reasons.items():
        if isinstance(case, kind):
            raise InputError(
                f"{of} with {' or '.join(STRESS_MEASURES)} {reason}, so no stress is computed. Limit the peak instead.",
                ("structure.kind",),
            )


def _first_output(model: Model) -> FloatArray:
    """(n,) row of the response whose peak counts."""
    return next(iter(model.outputs.values()))


def _stress_at_point(case: Case, model: Model, response: ForcedResponse) -> _StressAtPoint | None:
    """The stress at the highest point, with the state at rest; None without the full mesh of bodies."""
    structure = model.in_study.full_model
    if structure is None:
        return None
    recovery = model.superelement.recovery
    if not isinstance(recovery, Recovery):
        return None
    peak = peaks(response.frequency_hz, response.amplitude(_first_output(model)), response.part)[0]
    point = peak.point
    loads = _FullLoads(case, model.joint.layout, structure.full_size)
    omega = 2.0 * np.pi * float(response.frequency_hz[point])
    load = response.load_factor[point] * loads.harmonic(omega, response.harmonics)
    reduced = response.displacement[point]
    displacement = recovery.with_omitted_modes(reduced, load, omega)
    omitted = displacement - recovery @ reduced
    static, rest = displacement_at_rest(model, structure, recovery, loads.static())
    displacement[:, :1] += rest
    nodal = nodal_stress(structure, displacement)
    region = _regions(case, model.joint.layout, structure)[nodal.node]
    return _StressAtPoint(structure, displacement, omitted, nodal, region, static, peak)


def goodman_factor(
    alternating: FloatArray, mean: FloatArray, fatigue_limit: float, tensile_strength: float
) -> FloatArray:
    """Safety factor S of the Goodman line, ``1 / S = alternating / fatigue_limit + mean / tensile_strength``; Pa.

    The factor multiplies alternating and mean stress alike until the line is reached; infinite without stress.

    Source: J. Goodman, Mechanics Applied to Engineering (1899).
    """
    used = np.asarray(alternating) / fatigue_limit + np.asarray(mean) / tensile_strength
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / used)


def _goodman(structure: Structure, nodal: NodalStress, cycle: StressCycle) -> FloatArray | None:
    """(p,) safety factor, NaN in bodies without both strengths; None if no body has them."""
    factor = np.full(len(nodal.node), np.nan)
    for body, material in enumerate(structure.materials):
        if material.fatigue_limit is not None and material.tensile_strength is not None:
            here = nodal.body == body
            factor[here] = goodman_factor(
                cycle.alternating[here], cycle.mean[here], material.fatigue_limit, material.tensile_strength
            )
    return None if np.isnan(factor).all() else factor


@dataclass(frozen=True)
class _FullUnknowns:
    """All displacements of a mesh, as an excitation requires them."""

    size: int
    mass: FloatArray = field(default_factory=lambda: np.empty((0, 0)))


@dataclass(frozen=True)
class _FullLoads:
    """Loads of a case on all displacements (size,) of its mesh."""

    case: Case
    layout: Layout
    size: int

    def harmonic(self, omega: float, harmonics: int) -> FloatArray:
        """(size, 2H+1) N of the excitation, mean, cos 1, sin 1, ..."""
        excitation = make_excitation(self.case, self._rows(), self.layout.base_inertia)
        return excitation.on(_FullUnknowns(self.size), harmonics).coefficients(omega).T

    def static(self) -> FloatArray:
        """(size,) N of the constant forces and distributed loads."""
        return make_static_load(self.case, self._rows(), self.layout.unit_loads)

    def _rows(self) -> dict[str, FloatArray]:
        """Name -> (3, size) rows of the mean displacement of a node group."""
        return {name: group.unit_loads(self.size).T for name, group in self.layout.node_groups.items()}


def _regions(case: Case, layout: Layout, structure: Structure) -> IntArray:
    """(n_nodes,) codes of :class:`Region`; contact before loads before constraints."""
    kind, mesh = kind_of(case), structure.mesh
    loaded = {each.node_group for each in (*kind.forces(case), *kind.static_forces(case))}
    loaded |= {each.node_group for each in kind.unbalances(case)}
    load_nodes = [layout.node_groups[name].nodes for name in sorted(loaded)]
    region = np.full(mesh.n_nodes, Region.ORDINARY, dtype=np.int64)
    region[structure.fixed_unknowns // 3] = Region.CONSTRAINED
    if load_nodes:
        region[_cells_around(mesh, np.concatenate(load_nodes))] = Region.LOAD
    region[_cells_around(mesh, layout.face_pairs.nodes)] = Region.CONTACT
    return region


def _cells_around(mesh: Mesh, nodes: IntArray) -> IntArray:
    """Nodes of all cells that have one of the given nodes."""
    touched = np.concatenate([np.isin(cells, nodes).any(axis=1) for _, cells in mesh.cell_arrays()])
    return mesh.nodes_of_cells(np.flatnonzero(touched))
