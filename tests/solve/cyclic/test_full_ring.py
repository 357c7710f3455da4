"""The full ring of a sector against rings that were assembled without it, and blades that differ."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from sectors import SmallDisk, annulus
from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.jenkins import JenkinsElement
from stickslip.core.errors import InputError
from stickslip.solve.cyclic.full_ring import FullRing, full_ring
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import forced_response
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.blade_modes import blade_alone
from stickslip.structure.cyclic_sector import CyclicSector, Direction
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Material, Structure, assemble, assemble_bodies, natural_frequencies
from stickslip.structure.mesh import Mesh
from stickslip.structure.ring import Ring
from stickslip.structure.sector_boundaries import cyclic_symmetry
from stickslip.structure.sector_reduction import cyclic_sector, sector_frequencies

SECTORS = 6
DISK = SmallDisk.of(SECTORS)
MODULUS = 2.1e11


@pytest.mark.parametrize("sectors", [5, 6])
def test_matrices_are_those_of_the_ring(sectors: int) -> None:
    disk = SmallDisk.of(sectors, whirls=True)
    ring, expected = full_ring(disk.sector).superelement, disk.ring
    for name in ("mass", "stiffness", "damping", "gyroscopic"):
        wanted = getattr(expected, name)
        np.testing.assert_allclose(getattr(ring, name), wanted, rtol=0.0, atol=1e-13 * np.abs(wanted).max())


def test_a_sector_without_damping_has_a_ring_without_it() -> None:
    ring = full_ring(SmallDisk.of(5, damped=False).sector).superelement
    assert ring.damping is None
    assert ring.gyroscopic is None


def test_pairs_are_those_of_the_ring() -> None:
    pairs, expected = full_ring(DISK.sector).joint(DISK.pairs), DISK.ring_pairs
    np.testing.assert_allclose(pairs.operator, expected.operator, atol=1e-15)
    assert len(pairs.laws) == 1
    for name in ("normal_stiffness", "tangential_springs", "friction_coefficient", "normal_load", "gap"):
        np.testing.assert_array_equal(getattr(pairs, name), getattr(expected, name))
    assert pairs.released


def test_each_sector_may_have_its_own_pairs() -> None:
    loads = np.arange(1.0, 13.0).reshape(SECTORS, 2)
    each = [DISK.pairs.with_constants(normal_load=load) for load in loads]
    np.testing.assert_array_equal(full_ring(DISK.sector).joint(each).normal_load, loads.ravel())
    retained = [pairs.with_constants(residual_traction=np.full((2, 2), 0.1)) for pairs in each]
    np.testing.assert_array_equal(full_ring(DISK.sector).joint(retained).resting_traction, np.full((12, 2), 0.1))


def test_pairs_of_other_laws_keep_them() -> None:
    jenkins = JenkinsElement(np.array([1e5]), np.array([3.0]))
    of_pairs = DISK.pairs.coulomb
    names = ("normal_stiffness", "tangential_stiffness", "friction_coefficient", "normal_load", "gap")
    coulomb = replace(of_pairs, **{name: getattr(of_pairs, name)[:1] for name in names})
    pairs = ContactPairs.with_laws(DISK.operator, [coulomb, jenkins])
    joint = full_ring(DISK.sector).joint(pairs)
    assert [law.name for law in joint.laws] == ["coulomb", "jenkins"] * SECTORS
    assert [group.tolist() for group in joint.members[:4]] == [[0], [1], [2], [3]]


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_a_travelling_wave_on_the_ring(direction: Direction) -> None:
    wave = Excitation.travelling_wave(2, DISK.force_cos, DISK.force_sin, direction)
    ring = full_ring(DISK.sector)
    found = ring.excitation(wave).on(ring.superelement, 2).coefficients(1.0)
    expected = Excitation.force(*DISK.ring_force(2, direction)).on(DISK.ring, 2).coefficients(1.0)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_force_on_the_next_sector_is_there() -> None:
    here = np.zeros(2 * DISK.sector.size)
    here[DISK.sector.size + 4] = 1.0
    ring = full_ring(DISK.sector)
    force = ring.excitation(Excitation.travelling_wave(0, here)).on(ring.superelement, 1).coefficients(1.0)[1]
    np.testing.assert_allclose(force.reshape(SECTORS, -1)[:, 4], 1.0)
    assert np.count_nonzero(force) == SECTORS


def test_rows_of_a_sector_and_of_the_next_one() -> None:
    size = DISK.sector.size
    row = full_ring(DISK.sector).row(np.arange(1.0, 2 * size + 1), sector=SECTORS - 1).reshape(SECTORS, size)
    np.testing.assert_array_equal(row[SECTORS - 1], np.arange(1.0, size + 1))
    np.testing.assert_array_equal(row[0], np.arange(size + 1.0, 2 * size + 1))
    assert not row[1:-1].any()


@pytest.mark.slow
def test_the_ring_with_friction_and_separation_moves_as_the_sector() -> None:
    ring = full_ring(DISK.sector)
    wave = Excitation.travelling_wave(1, DISK.force_cos, DISK.force_sin)
    options: dict[str, Any] = {"frequency_hz": (88.0, 82.0), "harmonics": 3, "samples": 96}
    tip = np.zeros(DISK.sector.size)
    tip[3] = 1.0
    of_both = np.eye(2 * tip.size)[[3, tip.size + 3]]  # this sector and the next one
    of_sector = forced_response(DISK.sector, DISK.pairs, wave, outputs=of_both, **options)
    assert str(of_sector.settings["maxima_between_points"]).startswith(
        "outputs: 2; points added between points of the curve: 0;"
    )
    of_ring = forced_response(ring.superelement, ring.joint(DISK.pairs), ring.excitation(wave), checks=False, **options)
    assert of_ring.converged
    amplitudes = [of_ring.amplitude(ring.row(tip, sector)).max() for sector in range(SECTORS)]
    peak = of_sector.amplitude(np.concatenate([tip, np.zeros_like(tip)])).max()
    np.testing.assert_allclose(amplitudes, peak, rtol=1e-4)  # points of the two curves differ
    assert of_ring.contact_state.max() == 2


def bladed(sectors: int = SECTORS) -> Mesh:
    """A sector of an annulus whose outer part is a blade, the middle third of its angle; sets blade, left, right."""
    whole = annulus(sectors, (0.05, 0.2), 0.006, (6, 3, 1))
    cells = whole.cells[0] if isinstance(whole.cells, tuple) else whole.cells
    radial, around = (part.ravel() for part in np.meshgrid(np.arange(6), np.arange(3), indexing="ij"))
    in_blade = radial >= 3
    kept = cells[~in_blade | (around == 1)]
    body = in_blade[~in_blade | (around == 1)].astype(int)
    used, numbers = np.unique(kept, return_inverse=True)
    new = np.full(whole.n_nodes, -1)
    new[used] = np.arange(used.size)
    sets = {name: new[nodes][new[nodes] >= 0] for name, nodes in whole.node_sets.items()}
    numbers = numbers.reshape(kept.shape)
    root = np.unique(numbers[body == 0])
    sets["blade"] = np.setdiff1d(np.unique(numbers[body == 1]), root)
    return Mesh(whole.points[used], numbers, body, sets, ("disk", "blade"))


@cache
def reduced() -> tuple[Structure, CyclicSymmetry, CyclicSector, int]:
    """The sector, unreduced and reduced, and the number of the node at the tip of its blade."""
    mesh = bladed()
    symmetry = cyclic_symmetry(mesh.points, mesh.node_set("left"), mesh.node_set("right"))
    structure = assemble(mesh, Material(young_modulus=MODULUS), fixed_nodes=mesh.node_set("inner"))
    tip = int(np.linalg.norm(mesh.points[:, :2], axis=1).argmax())
    return structure, symmetry, cyclic_sector(structure, symmetry, [tip], n_modes=25), tip


@cache
def blades(n_modes: int = 8) -> BladeAlone:
    structure, _, sector, _ = reduced()
    return blade_alone(structure, sector, structure.mesh.node_set("blade"), n_modes)


def frequencies(ring: FullRing, count: int) -> np.ndarray:
    return natural_frequencies(ring.superelement.stiffness, ring.superelement.mass, count)[0]


@pytest.mark.slow
def test_the_tuned_ring_has_the_frequencies_of_the_sector() -> None:
    structure, symmetry, sector, _ = reduced()
    of_sector = sector_frequencies(structure, symmetry, range(4), 4)
    twice = np.sort(np.concatenate([of_sector[0], *[of_sector[d] for d in (1, 1, 2, 2)], of_sector[3]]))
    np.testing.assert_allclose(frequencies(full_ring(sector), 12), twice[:12], rtol=1e-5)  # by the reduction


def mesh_of_unequal_blades(factors: np.ndarray) -> np.ndarray:
    """Frequencies (18,) of a ring of bricks whose blades have other moduli, assembled by the ordinary path."""
    mesh = bladed()
    ring = Ring.of(mesh, reduced()[1]).mesh
    is_blade = np.tile(mesh.body == 1, SECTORS)
    sector = np.repeat(np.arange(SECTORS), mesh.body.size)
    names = ("disk", *(f"blade {each}" for each in range(SECTORS)))
    body = np.where(is_blade, 1 + sector, 0)
    unequal = Mesh(ring.points, ring.cells, body, ring.node_sets, names)
    materials = tuple(Material(young_modulus=MODULUS * factor) for factor in (1.0, *factors))
    whole = assemble_bodies(unequal, materials, fixed_nodes=unequal.node_set("inner"))
    return natural_frequencies(whole.stiffness, whole.mass, 18)[0]


@pytest.mark.slow
@pytest.mark.parametrize("size", [0.01, 0.05])
def test_blades_that_differ_against_a_mesh_of_such_blades(size: float) -> None:
    """The part of a blade that the motion of its root deforms keeps its modulus, which is the error that remains."""
    deviations = size * np.array([1.0, -0.4, 0.7, -1.0, 0.2, -0.6])
    expected = mesh_of_unequal_blades((1.0 + deviations) ** 2)
    ring = full_ring(reduced()[2])
    found = frequencies(ring.mistuned(blades(), deviations), 18)
    shift = np.abs(expected / frequencies(ring, 18) - 1.0).max()
    assert shift > 0.1 * size
    np.testing.assert_allclose(found, expected, rtol=0.02 * size)


def test_each_mode_of_the_blade_may_have_its_own_deviation() -> None:
    ring, blade = full_ring(reduced()[2]), blades(2)
    same = ring.mistuned(blade, np.full(SECTORS, 0.02)).superelement.stiffness
    both = ring.mistuned(blade, np.full((SECTORS, 2), 0.02)).superelement.stiffness
    np.testing.assert_array_equal(same, both)
    first = np.zeros((SECTORS, 2))
    first[:, 0] = 0.02
    # The lowest six are bending of the blades.
    tuned = frequencies(ring, SECTORS)
    of_first, of_both = (frequencies(ring.mistuned(blade, each), SECTORS) - tuned for each in (first, first * 0 + 0.02))
    np.testing.assert_allclose(of_first, of_both, rtol=1e-3)
    assert (of_both - of_first).max() > 0.0


def test_equal_deviations_of_all_blades_keep_the_ring_tuned() -> None:
    found = frequencies(full_ring(reduced()[2]).mistuned(blades(), np.full(SECTORS, 0.03)), 6)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)  # forward and backward wave of one nodal diameter


def test_a_disk_that_is_not_reduced_for_all_diameters_is_rejected() -> None:
    sector = replace(DISK.sector, diameters={0: DISK.sector.diameters[0]})
    with rejects(InputError, "sector"):
        full_ring(sector)


def test_input_that_does_not_fit_is_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    ring = full_ring(reduced()[2])
    with rejects(InputError, "deviations"):
        ring.mistuned(blades(), np.zeros(SECTORS + 1))
    with rejects(InputError, "deviations"):
        ring.mistuned(blades(), np.full(SECTORS, 2.0))
    with rejects(InputError, "row"):
        ring.row(np.zeros(3))
    with rejects(InputError, "sector"):
        ring.row(np.zeros(ring.sector.size), SECTORS)
    with rejects(InputError, "pairs"):
        full_ring(DISK.sector).joint([DISK.pairs])
    with rejects(InputError, "wave"):
        ring.excitation(Excitation.force(np.ones(ring.sector.size)))
    monkeypatch.setattr("stickslip.solve.cyclic.full_ring.MOST_UNKNOWNS", 10)
    with rejects(InputError, "sector"):
        full_ring(DISK.sector)


def test_blades_that_do_not_fit_are_rejected() -> None:
    structure, _, sector, _ = reduced()
    blade = structure.mesh.node_set("blade")
    with rejects(InputError, "nodes"):
        blade_alone(structure, sector, structure.mesh.node_set("left"))
    with rejects(InputError, "sector"):
        blade_alone(structure, sector.without_recovery(), blade)
    with rejects(InputError, "nodes"):
        blade_alone(structure, sector, np.setdiff1d(structure.mesh.node_set("inner"), [0, 1, 6, 7]))
    with rejects(InputError, "n_modes"):
        blade_alone(structure, sector, blade, 0)
    assert repr(blades(2)).startswith("BladeAlone(")
    assert repr(full_ring(DISK.sector)) == "FullRing(6 sectors of 9 unknowns)"
