"""Linear elasticity on meshes of solid cells: stiffness, consistent mass and natural frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np
import scipy.linalg
import scipy.sparse
from numpy.typing import ArrayLike

from stickslip.core.block_lanczos import lowest_modes
from stickslip.core.errors import InputError
from stickslip.core.validation import (
    FloatArray,
    argument_error,
    require_choice,
)
from stickslip.structure.constraints import Constraints
from stickslip.structure.factor import Factor, factorize
from stickslip.structure.incompatible_brick import incompatible_stiffness
from stickslip.structure.lanczos import eigenpairs_near
from stickslip.structure.material import Material as Material
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.shapes import compatible_stiffness, consistent_mass

Element = Literal["incompatible", "trilinear", "serendipity"]
Hexahedron = Literal["incompatible", "trilinear"]

# Cells are processed in groups, so that the temporary arrays of fine 20-node meshes stay below about 100 MB.
_CELLS_AT_ONCE = 2000
# chosen: over the mean ratio of the diagonals of stiffness and mass, a shift that makes the stiffness of a free body
# regular, and the round-off of its zero eigenvalues.
ROUND_OFF_SHIFT = 1e-8
_EQUAL = 1e-6  # relative difference of components of a mode that are equal by symmetry


@dataclass(frozen=True)
class Structure:
    """Sparse matrices of ``M u'' + K u = p`` in the independent unknowns; contact is not in them.

    Parameters
    ----------
    mesh:
        the mesh of the unknowns; for the serendipity element that with midside nodes.
    stiffness, mass:
        (n_free, n_free) csr, N/m and kg.
    fixed_nodes:
        nodes whose three displacements are zero.
    element:
        name of the element.
    fixed_unknowns:
        all indices among the 3 * n_nodes displacements (node, then x, y, z) that are zero: those of ``fixed_nodes``,
        which may be omitted, and single directions of other nodes.
    materials:
        material of each body of the mesh, which only its stress requires; empty if unknown.
    constraints:
        the linear equations between displacements that are eliminated, fixed displacements included; None without any.
    """

    mesh: Mesh
    stiffness: Any
    mass: Any
    fixed_nodes: IntArray
    element: str
    fixed_unknowns: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    materials: tuple[Material, ...] = ()
    constraints: Constraints | None = None

    def __post_init__(self) -> None:
        whole = (3 * np.asarray(self.fixed_nodes, dtype=np.int64)[:, None] + np.arange(3)).ravel()
        object.__setattr__(self, "fixed_unknowns", np.union1d(whole, self.fixed_unknowns).astype(np.int64))

    def __repr__(self) -> str:
        fixed = f"{len(self.fixed_nodes)} of them fixed"
        unknowns = self.stiffness.shape[0]
        return f"Structure({unknowns} unknowns of {self.mesh.n_nodes} nodes, {fixed}; element {self.element})"

    @property
    def free_unknowns(self) -> IntArray:
        """(n_free,) index of each unknown among the 3 * n_nodes displacements (node, then x, y, z)."""
        if self.constraints is not None:
            return self.constraints.free_unknowns
        free = np.ones(3 * self.mesh.n_nodes, dtype=bool)
        free[self.fixed_unknowns] = False
        return np.flatnonzero(free)

    @property
    def full_size(self) -> int:
        """Number of displacements of the mesh, fixed ones included."""
        return 3 * self.mesh.n_nodes

    @property
    def node(self) -> IntArray:
        """(n_free,) node of each unknown."""
        return self.free_unknowns // 3

    def unknowns_of(self, nodes: ArrayLike) -> IntArray:
        """(k, 3) unknowns x, y, z of free nodes (k,).

        Raises InputError for a node that does not exist, or is fixed in any direction.
        """
        wanted = np.asarray(nodes, dtype=np.int64)
        if wanted.size and (wanted.min() < 0 or wanted.max() >= self.mesh.n_nodes):
            raise InputError(
                f"nodes contains {wanted.min()} to {wanted.max()}, but the mesh has nodes 0 to "
                f"{self.mesh.n_nodes - 1}.",
                arguments=["nodes"],
            )
        hits = np.intersect1d(wanted, self.fixed_nodes)
        if hits.size:
            raise InputError(
                f"node {hits[0]} is fixed, so it has no unknowns ({hits.size} of {wanted.size} are).",
                arguments=["nodes"],
            )
        hits = np.intersect1d(wanted, self.fixed_unknowns // 3)
        if hits.size:
            axes = ", ".join("xyz"[unknown % 3] for unknown in self.fixed_unknowns if unknown // 3 == hits[0])
            raise InputError(
                f"node {hits[0]} is constrained along {axes}, so it does not have three unknowns ({hits.size} of "
                f"{wanted.size} nodes are partly constrained); contact, force and output nodes must be free. Remove "
                "such nodes from the constraint, or from the set.",
                arguments=["nodes"],
            )
        position = np.full(3 * self.mesh.n_nodes, -1, dtype=np.int64)
        position[self.free_unknowns] = np.arange(len(self.free_unknowns))
        chosen = np.asarray(position.reshape(-1, 3)[wanted])
        follows = np.flatnonzero((chosen < 0).any(axis=-1))
        if follows.size:
            raise InputError(
                f"node {wanted[follows[0]]} follows other nodes by a tie, a rigid body or an equation, so it does not "
                f"have three unknowns ({follows.size} of {wanted.size} nodes follow); contact nodes must be "
                "independent. Make the other side of the tie the dependent one, or remove such nodes.",
                arguments=["nodes"],
            )
        return chosen

    def gather(self, load: FloatArray) -> FloatArray:
        """``T^T f``: forces (n_free, ...) on the unknowns from those (3 * n_nodes, ...) on the full mesh."""
        if self.constraints is not None:
            return np.asarray(self.constraints.transformation.T @ load)
        return np.asarray(load[self.free_unknowns])

    def of_unknowns(self, operator: Any) -> Any:
        """``B T``: csr rows (m, n_free) on the unknowns from rows (m, 3 * n_nodes) on the full mesh."""
        if self.constraints is not None:
            return operator @ self.constraints.transformation
        return operator[:, self.free_unknowns]

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Displacements (3 * n_nodes, ...) of the full mesh, fixed ones zero, from free unknowns (n_free, ...)."""
        if self.constraints is not None:
            return np.asarray(self.constraints.transformation @ vectors)
        full = np.zeros((3 * self.mesh.n_nodes, *vectors.shape[1:]))
        full[self.free_unknowns] = vectors
        return full


def assemble(
    mesh: Mesh, material: Material, element: Element = "incompatible", fixed_nodes: ArrayLike | None = None
) -> Structure:
    """Stiffness ``integral of B^T D B`` and consistent mass ``integral of density N^T N`` of a mesh.

    Parameters
    ----------
    mesh:
        8-node bricks; for ``serendipity`` midside nodes are added when the mesh has none.
    element:
        ``incompatible``: 8 nodes with Taylor-Wilson modes, 2 x 2 x 2 points; ``trilinear``: 8 nodes, 2 x 2 x 2 points,
        too stiff in bending; ``serendipity``: 20 nodes, 3 x 3 x 3 points. The mass always takes 3 x 3 x 3 points.
    fixed_nodes:
        nodes to constrain; by default those of the node set ``fixed`` (none if the mesh has no such set).

    Raises
    ------
    InputError
        for an element that does not exist or does not fit the cells, for cells that are no bricks, and for a node
        number that does not exist.
    """
    require_choice("element", element, get_args(Element))
    if element == "serendipity":
        mesh = mesh.quadratic()
    elif mesh.bricks().shape[1] != 8:
        raise InputError(
            f"element {element!r} requires 8-node cells, but the mesh has 20-node cells; use 'serendipity'.",
            arguments=["element"],
        )
    if fixed_nodes is None:
        fixed_nodes = mesh.node_sets.get("fixed", np.empty(0, dtype=np.int64))
    incompatible = element == "incompatible"
    structure = _assembled(mesh, [(mesh.bricks(), material)], element, incompatible, fixed_nodes, ())
    return replace(structure, materials=(material,) * (int(mesh.body.max()) + 1))


def assemble_bodies(
    mesh: Mesh,
    materials: Sequence[Material],
    hexahedron: Hexahedron = "incompatible",
    fixed_nodes: ArrayLike = (),
    fixed_unknowns: ArrayLike = (),
    constraints: Constraints | None = None,
) -> Structure:
    """Stiffness and consistent mass, as :func:`assemble`, of several kinds of cells and several materials.

    Parameters
    ----------
    materials:
        one for each body, in the order of ``mesh.body_names``.
    hexahedron:
        element of 8-node bricks: with Taylor-Wilson modes, or trilinear (too stiff in bending). Every other kind has
        its standard functions; points of the stiffness: 1 (tetra), 4 (tetra10), 6 (wedge), 9 (wedge15), 27
        (hexahedron20).
    fixed_nodes:
        nodes to clamp.
    fixed_unknowns:
        indices among the 3 * n_nodes displacements (node, then x, y, z) that are constrained to zero.
    constraints:
        eliminated equations (:func:`stickslip.structure.constraints.eliminate`), which must contain the fixed
        displacements: the matrices are ``T^T K T`` and ``T^T M T``.

    Raises
    ------
    InputError
        for a number of materials that is not that of the bodies, and for nodes or unknowns that do not exist.
    """
    require_choice("hexahedron", hexahedron, get_args(Hexahedron))
    if len(materials) != len(mesh.body_names):
        raise InputError(
            f"materials has {len(materials)} entries, but the mesh has {len(mesh.body_names)} bodies: "
            f"{', '.join(mesh.body_names)}. Give one material for each body, in this order.",
            arguments=["materials"],
        )
    groups = [
        (block.cells[block.body == body], materials[body]) for block in mesh.blocks for body in np.unique(block.body)
    ]
    kinds = ", ".join(dict.fromkeys(hexahedron if b.kind == "hexahedron" else b.kind for b in mesh.blocks))
    structure = _assembled(mesh, groups, kinds, hexahedron == "incompatible", fixed_nodes, fixed_unknowns, constraints)
    return replace(structure, materials=tuple(materials))


def _assembled(
    mesh: Mesh,
    groups: Sequence[tuple[IntArray, Material]],
    element: str,
    incompatible: bool,
    fixed_nodes: ArrayLike,
    fixed_unknowns: ArrayLike,
    constraints: Constraints | None = None,
) -> Structure:
    """Matrices of groups of cells (m, k) of one kind and one material; ``incompatible`` concerns 8-node bricks."""
    nodes = _existing("fixed_nodes", fixed_nodes, mesh.n_nodes)
    unknowns = _existing("fixed_unknowns", fixed_unknowns, 3 * mesh.n_nodes)
    stiffness = scipy.sparse.csr_matrix((3 * mesh.n_nodes, 3 * mesh.n_nodes))
    mass = scipy.sparse.csr_matrix((mesh.n_nodes, mesh.n_nodes))
    for cells, material in groups:
        elastic = material.elastic_matrix()
        cell_stiffness = incompatible_stiffness if incompatible and cells.shape[1] == 8 else compatible_stiffness
        for start in range(0, len(cells), _CELLS_AT_ONCE):
            part = cells[start : start + _CELLS_AT_ONCE]
            corners = mesh.points[part]
            rows = (3 * part[:, :, None] + np.arange(3)).reshape(len(part), -1)
            stiffness = stiffness + scattered(cell_stiffness(corners, elastic), rows, 3 * mesh.n_nodes)
            mass = mass + scattered(consistent_mass(corners, material.density), part, mesh.n_nodes)
    mass = scipy.sparse.kron(mass, scipy.sparse.eye(3), format="csr")
    whole = Structure(mesh, stiffness, mass, nodes, element, unknowns, constraints=constraints)
    if constraints is not None:
        _require_zero(whole, constraints)
        tie = constraints.transformation
        return replace(whole, stiffness=(tie.T @ stiffness @ tie).tocsr(), mass=(tie.T @ mass @ tie).tocsr())
    free = whole.free_unknowns
    return replace(whole, stiffness=stiffness[free][:, free], mass=mass[free][:, free])


def _require_zero(structure: Structure, constraints: Constraints) -> None:
    """Raise InputError for constraints of another mesh, or that leave a fixed displacement free."""
    size = structure.full_size
    if constraints.size != size or np.diff(constraints.transformation.indptr)[structure.fixed_unknowns].any():
        raise argument_error(
            "constraints",
            f"constraints are those of {constraints.size} displacements, or leave fixed ones free; the mesh has "
            f"{size}. Eliminate the equations of this mesh with the same fixed unknowns.",
        )


def _existing(name: str, value: ArrayLike, size: int) -> IntArray:
    """``value`` as sorted integers from 0 to ``size - 1``, each once; raises InputError for others."""
    numbers = np.unique(np.asarray(value, dtype=np.int64))
    if numbers.size and (numbers[0] < 0 or numbers[-1] >= size):
        raise argument_error(
            name, f"{name} must be between 0 and {size - 1}, but contains {numbers[0]} to {numbers[-1]}."
        )
    return numbers


def scattered(local: FloatArray, unknowns: IntArray, size: int) -> Any:
    """csr matrix (size, size) that sums cell matrices (m, k, k) at the unknowns (m, k) of each cell."""
    width = unknowns.shape[1]
    rows = np.repeat(unknowns, width, axis=1).ravel()
    columns = np.tile(unknowns, (1, width)).ravel()
    return scipy.sparse.csr_matrix((local.ravel(), (rows, columns)), shape=(size, size))


def mean_ratio(stiffness: Any, mass: Any) -> float:
    """(rad/s)^2, mean diagonal of the stiffness over that of the mass."""
    return float(stiffness.diagonal().real.sum() / mass.diagonal().real.sum())


def natural_frequencies(
    stiffness: Any,
    mass: Any,
    count: int,
    shift: float | None = None,
    factor: Factor | None = None,
    by_blocks: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Lowest solutions of ``K v = (2 pi f)^2 M v``: frequencies (count,) in Hz and mass-normalised modes (n, count).

    Sparse matrices are solved by shift-invert Lanczos about ``shift`` ((rad/s)^2), dense ones directly. The default
    shift is small and negative (1e-8 of the mean ratio of the diagonals), which also suits free structures: their
    rigid-body modes are at 0 Hz. ``factor`` is that of ``stiffness - shift * mass`` if it already exists; one of a real
    matrix that solves a block of columns in little more time than one is used ``by_blocks``, see
    :mod:`stickslip.core.block_lanczos`. The largest
    component of each mode is positive, the first one of those that are equal within 1e-6: symmetric structures have
    pairs of them with opposite signs. Matrices may be complex and Hermitian; the modes are complex then.

    Raises
    ------
    InputError
        for a count outside 1 to n - 1, and for a stiffness with a clearly negative eigenvalue.
    ConvergenceError
        when the Lanczos iteration does not converge.
    """
    size = stiffness.shape[0]
    if not 1 <= count < size:
        raise InputError(
            f"count is {count}; with {size} unknowns it must be between 1 and {size - 1}.", arguments=["count"]
        )
    scale = mean_ratio(stiffness, mass)
    if scipy.sparse.issparse(stiffness):
        centre = -ROUND_OFF_SHIFT * scale if shift is None else shift
        factor = factor or factorize(stiffness - centre * mass)
        if by_blocks:
            eigenvalues, modes = lowest_modes(factor.solve, lambda block: mass @ block, size, count=count, shift=centre)
        else:
            eigenvalues, modes = eigenpairs_near(stiffness, count, centre, factor, mass)
    else:
        eigenvalues, modes = scipy.linalg.eigh(stiffness, mass, subset_by_index=(0, count - 1))
    order = np.argsort(eigenvalues)
    eigenvalues, modes = eigenvalues[order], modes[:, order]
    # By round-off rigid-body modes are at about 1e-12 of the largest eigenvalue, on either side of zero.
    if eigenvalues[0] < -ROUND_OFF_SHIFT * scale:
        raise InputError(
            f"the stiffness has the negative eigenvalue {eigenvalues[0]:.3g} (rad/s)^2: it is not that of an elastic "
            "structure. Check the signs of the springs that were added."
        )
    size_of = np.abs(modes)
    first = (size_of >= (1.0 - _EQUAL) * size_of.max(axis=0)).argmax(axis=0)
    largest = modes[first, np.arange(count)]
    modes = modes / (np.sign(largest) * np.sqrt(np.einsum("ij,ij->j", modes.conj(), mass @ modes).real))
    return np.sqrt(np.maximum(eigenvalues, 0.0)) / (2.0 * np.pi), modes
