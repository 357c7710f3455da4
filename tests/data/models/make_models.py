"""Makes the model files of this folder again: python tests/data/models/make_models.py (from the root of the project).

The files that Gmsh itself writes need its Python module, which is no dependency of this project; without it they are
left as they are. cubes.vtk was written by hand; gmsh_1.msh is gmsh_2.2_text.msh with
the lines of version 1.
"""

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1]))

from archive_writer import write_cdb  # noqa: E402
from model_writers import write_bdf, write_inp, write_meshio  # noqa: E402
from solid_cells import CORNERS  # noqa: E402
from stickslip.structure.mesh import Mesh  # noqa: E402
from universal_writer import write_unv  # noqa: E402


def two_cubes() -> Mesh:
    """Two cubes of 10 mm, one on the other, that touch with nodes of their own."""
    cube = 5e-3 * (CORNERS + 1)
    sets = {"base": np.arange(4), "contact": np.arange(4, 8), "opposite": np.arange(8, 12), "tip": np.array([15])}
    cells = np.array([np.arange(8), np.arange(8, 16)])
    return Mesh(np.vstack([cube, cube + np.array([0.0, 0.0, 0.01])]), cells, np.array([0, 1]), sets)


def from_gmsh() -> None:
    """Two boxes that touch, in quadratic tetrahedra, as Gmsh writes them in all versions."""
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addBox(0, 0, 0, 10, 10, 10)
    gmsh.model.occ.addBox(10, 0, 0, 5, 10, 10)
    gmsh.model.occ.synchronize()
    both = 0
    for dimension, entities, name in (
        (3, [1], "cube"),
        (3, [2], "plate"),
        (2, [1], "left face"),
        (2, [1, 2], "two faces"),
        (0, [1], "corner"),
    ):
        last = gmsh.model.addPhysicalGroup(dimension, entities, name=name)
        both = last if name == "two faces" else both
    gmsh.option.setNumber("Mesh.MeshSizeMin", 10)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 10)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    for version in (2.2, 4.1):
        for binary, kind in ((0, "text"), (1, "binary")):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            gmsh.write(str(HERE / f"gmsh_{version}_{kind}.msh"))
    # faces, edges and corners without a group too
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    for binary, kind in ((0, "text"), (1, "binary")):
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(HERE / f"gmsh_4.1_all_{kind}.msh"))
    # of version 4.0 only one group of an entity is read, so the face in two groups leaves one
    gmsh.model.removePhysicalGroups([group for group in gmsh.model.getPhysicalGroups(2) if group[1] == both])
    gmsh.option.setNumber("Mesh.SaveAll", 0)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.0)
    gmsh.write(str(HERE / "gmsh_4.0_text.msh"))
    gmsh.finalize()


if __name__ == "__main__":
    bodies, faces = ["lower", "upper"], ["contact", "opposite"]
    write_inp(HERE / "cubes.inp", two_cubes(), bodies, faces, "base")
    write_bdf(HERE / "cubes.bdf", two_cubes(), bodies, faces, "base", large=False)
    write_bdf(HERE / "cubes.nas", two_cubes(), bodies, faces, "base", large=True)
    write_cdb(HERE / "cubes.cdb", two_cubes(), faces, "base")
    write_unv(HERE / "cubes.unv", two_cubes(), bodies, faces)
    write_meshio(HERE / "cubes.vtu", two_cubes(), bodies, faces, "vtu")
    write_meshio(HERE / "cubes.med", two_cubes(), bodies, faces, "med")
    try:
        from_gmsh()
    except ImportError:
        print("gmsh is not installed: its files stay as they are")
