"""meshio with every kind of cell and number that is used here."""

from __future__ import annotations

from typing import Any


def complete_meshio() -> Any:
    """The package meshio, with completed tables.

    Its table of dimensions lacks the 15-node wedge, which it otherwise reads and writes. Of its two tables of numbers
    in legacy VTK files, each lacks some; in that of version 5.1, "int" has 64 bits, but VTK writes 32.
    """
    import meshio
    from meshio._mesh import topological_dimension
    from meshio.vtk import _vtk_42, _vtk_51

    topological_dimension.setdefault("wedge15", 3)
    numbers = _vtk_51.vtk_to_numpy_dtype_name | _vtk_42.vtk_to_numpy_dtype_name | {"vtkidtype": "int32"}
    for module in (_vtk_42, _vtk_51):
        module.vtk_to_numpy_dtype_name.update(numbers)
    return meshio
