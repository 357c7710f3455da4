"""The mesh of a whole disk from that of one sector."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.sector_boundaries import require_mesh_of

# What with_next_sector puts before the names of sets of the next sector.
NEXT = "next "


@dataclass(frozen=True)
class Ring:
    """A disk of all sectors: node ``number[s, i]`` of its mesh is node i of the sector that is s sectors ahead."""

    mesh: Mesh
    symmetry: CyclicSymmetry
    number: IntArray  # (sectors, n_nodes)

    @classmethod
    def of(cls, mesh: Mesh, symmetry: CyclicSymmetry) -> Ring:
        """The ring of a sector. Its bodies and sets are those of all sectors together. Raises InputError."""
        require_mesh_of(mesh, symmetry)
        sectors, n_nodes = symmetry.sectors, mesh.n_nodes
        own = np.ones(n_nodes, dtype=bool)
        own[symmetry.right] = symmetry.is_tied  # then both boundaries have their own nodes
        number = np.zeros((sectors, n_nodes), dtype=np.int64)
        number[:, own] = np.arange(sectors * int(own.sum())).reshape(sectors, -1)
        if not symmetry.is_tied:
            number[:, symmetry.right] = np.roll(number[:, symmetry.left], -1, axis=0)
        points = np.concatenate([symmetry.rotated(mesh.points[own], sector) for sector in range(sectors)])
        blocks = mesh.blocks
        return cls(
            Mesh(
                points,
                tuple(np.concatenate([each[block.cells] for each in number]) for block in blocks),
                np.concatenate([np.tile(block.body, sectors) for block in blocks]),
                {name: np.unique(number[:, nodes]) for name, nodes in mesh.node_sets.items()},
                mesh.body_names,
                {
                    name: tuple(np.concatenate([each[side] for each in number]) for side in sides)
                    for name, sides in mesh.face_sets.items()
                },
            ),
            symmetry,
            number,
        )

    def of_two(self, nodes: IntArray, sector: int) -> IntArray:
        """Nodes of the ring for nodes of the sector ``sector`` sectors ahead and of the one after it
        (:func:`with_next_sector`)."""
        size = self.symmetry.n_nodes
        return np.asarray(self.number[(sector + nodes // size) % self.symmetry.sectors, nodes % size])

    def set_name(self, name: str) -> str:
        """The set of the ring for a set of a sector and the next one."""
        return name if name in self.mesh.node_sets else name.removeprefix(NEXT)

    def motion(self, sectors: FloatArray) -> FloatArray:
        """Displacements (3 * n_ring, k) of the ring from those (sectors, 3 * n_nodes, k) of each sector.

        Those of a sector are in its own axes.
        """
        answer = np.zeros((self.mesh.n_nodes, 3, sectors.shape[2]))
        for sector, moved in enumerate(sectors):
            turned = np.einsum("ab,nbk->nak", self.symmetry.rotation(sector), moved.reshape(-1, 3, moved.shape[1]))
            answer[self.number[sector]] = turned
        return answer.reshape(-1, sectors.shape[2])
