"""The same mesh in CalculiX and here: frequencies, matrices entry by entry, and its stored matrices solved by us."""

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.sparse.linalg

from calculix import COARSE, ELEMENTS, blades, frequencies, our_structure, run_calculix, tied
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.formats.matrices.read import read_matrices
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh
from stickslip.structure.shapes import jacobians, shape_functions, stiffness_rule, strain_matrix

# Largest relative difference of ten frequencies on the coarse blades, printed by CalculiX with seven digits. C3D8I is
# another formulation; CalculiX integrates the mass of tetrahedra and wedges, and the stiffness of C3D6, with fewer
# points: see the test on their quadrature.
FREQUENCY = {"C3D8I": 2e-2, "C3D8": 1e-6, "C3D20": 1e-6, "C3D10": 1e-4, "C3D4": 3e-2, "C3D15": 2e-4, "C3D6": 0.1}
STIFFNESS = {"C3D8I": 0.15, "C3D8": 1e-12, "C3D20": 1e-12, "C3D10": 1e-12, "C3D4": 1e-12, "C3D15": 1e-12, "C3D6": 0.3}
MASS = {"C3D8I": 1e-12, "C3D8": 1e-12, "C3D20": 1e-12, "C3D10": 0.4, "C3D4": 0.4, "C3D15": 0.4, "C3D6": 0.4}


@pytest.fixture(scope="module", params=ELEMENTS)
def compared(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """One element in both programs."""
    kind, ours = ELEMENTS[request.param]
    mesh, pairs = blades(kind)
    folder = tmp_path_factory.mktemp("calculix")
    printed = run_calculix(folder, mesh, request.param, pairs, 10)
    stiffness, mass, retained = tied(our_structure(mesh, ours), pairs)
    model = read_matrices(folder / "matrices.sti", folder / "matrices.mas")
    return SimpleNamespace(
        element=request.param,
        mesh=mesh,
        pairs=pairs,
        printed=printed,
        ours=(stiffness, mass),
        kept=retained,
        model=model,
    )


@pytest.mark.long
def test_frequencies(compared: SimpleNamespace) -> None:
    own = frequencies(*compared.ours, 10)  # type: ignore[call-arg]
    np.testing.assert_allclose(own, compared.printed, rtol=FREQUENCY[compared.element])


@pytest.mark.long
def test_stored_matrices_give_the_frequencies_that_calculix_prints(compared: SimpleNamespace) -> None:
    actual = frequencies(compared.model.stiffness, compared.model.mass, 10)
    np.testing.assert_allclose(actual, compared.printed, rtol=1e-6)


@pytest.mark.slow
def test_stored_matrices_entry_by_entry(compared: SimpleNamespace) -> None:
    model = compared.model
    order = np.argsort(3 * (model.node - 1) + model.direction)
    outer, inner = np.split(order, [len(compared.kept)])
    # CalculiX keeps the incompatible modes of C3D8I as unknowns of nodes beyond those of the mesh: nine for each brick.
    assert len(inner) == (9 * len(compared.mesh.cells) if compared.element == "C3D8I" else 0)
    np.testing.assert_array_equal((3 * (model.node - 1) + model.direction)[outer], compared.kept)
    stiffness, mass = model.stiffness[outer][:, outer], model.mass[outer][:, outer]
    if len(inner):
        coupling = model.stiffness[inner][:, outer].tocsc()
        stiffness = stiffness - coupling.T @ scipy.sparse.linalg.spsolve(
            model.stiffness[inner][:, inner].tocsc(), coupling
        )
    for own, actual, limit in (
        (compared.ours[0], stiffness, STIFFNESS[compared.element]),
        (compared.ours[1], mass, MASS[compared.element]),
    ):
        assert abs(own - actual).max() <= limit * abs(own).max()


@pytest.mark.long
@pytest.mark.parametrize("compared", ["C3D4", "C3D10", "C3D15", "C3D6"], indirect=True)
def test_tetrahedra_and_wedges_differ_by_the_points_of_their_quadrature(compared: SimpleNamespace) -> None:
    """Stiffness and mass of the hexahedra are the same entry by entry: nothing is left to explain there."""
    points, weights = {
        "C3D4": (np.full((1, 3), 0.25), np.array([1 / 6])),
        "C3D10": four_points(),
        "C3D15": stiffness_rule(15),
        "C3D6": two_points(),
    }[compared.element]
    cells = compared.mesh.cell_arrays()[0][1]
    values, gradients = shape_functions(cells.shape[1], points)
    local = np.zeros((len(cells), cells.shape[1], cells.shape[1]))
    stiff = np.zeros((len(cells), 3 * cells.shape[1], 3 * cells.shape[1]))
    for value, gradient, weight in zip(values, gradients, weights, strict=True):
        jacobian, determinant = jacobians(compared.mesh.points[cells], gradient)
        local += (Material().density * weight * determinant)[:, None, None] * np.outer(value, value)
        strain = strain_matrix(gradient @ np.linalg.inv(jacobian).swapaxes(1, 2))
        stiff += (weight * determinant)[:, None, None] * (strain.transpose(0, 2, 1) @ elastic_matrix() @ strain)
    structure = our_structure(compared.mesh, "")
    free = structure.free_unknowns
    nodal = scattered(cells, local, compared.mesh.n_nodes)
    whole = scipy.sparse.kron(nodal, scipy.sparse.identity(3), format="csr")[free][:, free]
    unknowns = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), -1)
    own = scattered(unknowns, stiff, 3 * compared.mesh.n_nodes)[free][:, free]
    if compared.element != "C3D6":
        assert abs(own - structure.stiffness).max() <= 1e-12 * abs(own).max()
    scattered_structure: Any = SimpleNamespace(
        full_size=3 * compared.mesh.n_nodes, free_unknowns=free, stiffness=own, mass=whole
    )
    stiffness, mass, _ = tied(scattered_structure, compared.pairs)
    order = np.argsort(3 * (compared.model.node - 1) + compared.model.direction)
    assert abs(stiffness - compared.model.stiffness[order][:, order]).max() <= 1e-12 * abs(stiffness).max()
    assert abs(mass - compared.model.mass[order][:, order]).max() <= 1e-12 * abs(mass).max()
    np.testing.assert_allclose(frequencies(stiffness, mass, 10), compared.printed, rtol=1e-6)


def scattered(members: np.ndarray, local: FloatArray, size: int) -> Any:
    """Sum of the matrices of cells at their members."""
    width = members.shape[1]
    rows, columns = np.repeat(members, width, axis=1).ravel(), np.tile(members, (1, width)).ravel()
    return scipy.sparse.csr_matrix((local.ravel(), (rows, columns)), shape=(size, size))


def elastic_matrix() -> FloatArray:
    """Stress from the strains xx, yy, zz and the three shear angles."""
    material = Material()
    shear = material.young_modulus / (2.0 * (1.0 + material.poisson_ratio))
    first = 2.0 * shear * material.poisson_ratio / (1.0 - 2.0 * material.poisson_ratio)
    return np.diag([2.0 * shear] * 3 + [shear] * 3) + first * np.outer([1, 1, 1, 0, 0, 0], [1, 1, 1, 0, 0, 0])


def two_points() -> tuple[FloatArray, FloatArray]:
    """The rule of a 6-node wedge with the centre of the triangle alone, two along its axis."""
    points, weights = stiffness_rule(6)
    along = np.unique(points[:, 2].round(12))
    return np.column_stack([np.full((2, 2), 1 / 3), along]), np.full(2, weights.sum() / 2)


def four_points() -> tuple[FloatArray, FloatArray]:
    """The four-point rule of a tetrahedron."""
    a, b = (5 - np.sqrt(5)) / 20, (5 + 3 * np.sqrt(5)) / 20
    return np.array([[a, a, a], [b, a, a], [a, b, a], [a, a, b]]), np.full(4, 1 / 24)


def test_deck_names_sets_supports_ties_and_step(tmp_path: Path) -> None:
    mesh, pairs = blades("hexahedron")
    steel, other = Material(), Material(young_modulus=7e10)
    path = write_calculix_deck(
        tmp_path / "deck.inp", mesh, [steel, steel, other], element="C3D8", pairs=pairs, step="matrices", count=7
    )
    text = path.read_text()
    assert text.count("*ELEMENT, TYPE=C3D8, ELSET=body_") == 3
    assert text.count("*EQUATION") == 3 * len(pairs.first_node)
    assert re.search(r"\*FREQUENCY, SOLVER=MATRIXSTORAGE\n7\n\*END STEP\n$", text)
    assert "*NSET, NSET=set_response\n" in text
    assert "70000000000.0, 0.3" in text
    assert max(len(line.split(",")) for line in text.splitlines()) <= 17


@pytest.mark.parametrize(
    ("options", "keys"),
    [
        ({"element": "C3D20"}, ("element",)),
        ({"step": "static"}, ("step",)),
        ({"materials": [Material()]}, ("materials",)),
        ({"path": "deck.txt"}, ()),
    ],
)
def test_bad_options(tmp_path: Path, options: dict[str, Any], keys: tuple[str, ...]) -> None:
    mesh, _ = blades("hexahedron", COARSE)
    arguments: dict[str, Any] = {"path": "deck.inp", "mesh": mesh, "materials": Material()} | options
    arguments["path"] = tmp_path / arguments["path"]
    with rejects(InputError, *keys):
        write_calculix_deck(**arguments)


def test_every_kind_of_cell_has_an_element() -> None:
    from stickslip.formats.calculix_deck import ELEMENT_TYPES

    assert {*ELEMENT_TYPES, "hexahedron"} == set(CELL_KINDS)


def test_calculix_reads_the_exponent_of_every_coordinate(tmp_path: Path, make_block: Callable[..., Mesh]) -> None:
    """It truncates numbers after 20 characters; 1.2345678901234567e-05 has 22."""
    mesh = make_block((1, 1, 1), (1.0, 1.0, 1.0), 0.1)
    small = Mesh(-1.2345678901234567e-5 * mesh.points[:, [1, 0, 2]], mesh.cells)
    text = write_calculix_deck(tmp_path / "small.inp", small, Material()).read_text()
    rows = [line.split(", ")[1:] for line in text.partition("*ELEMENT")[0].splitlines()[1:]]
    assert max(len(number) for row in rows for number in row) <= 20
    np.testing.assert_allclose(np.array(rows, dtype=float), small.points, rtol=1e-13)
