"""Element types and keywords of Abaqus and CalculiX: supported, ignored, and rejected ones with the reason."""

from __future__ import annotations

# Node orders are those of VTK.
ELEMENT_TYPES = {
    "C3D4": "tetra",
    "C3D4H": "tetra",
    "C3D10": "tetra10",
    "C3D10M": "tetra10",
    "C3D10H": "tetra10",
    "C3D10HS": "tetra10",
    "C3D6": "wedge",
    "C3D15": "wedge15",
    "C3D8": "hexahedron",
    "C3D8I": "hexahedron",
    "C3D8R": "hexahedron",
    "C3D20": "hexahedron20",
    "C3D20R": "hexahedron20",
}
OTHER_FORMULATIONS = {"C3D4H", "C3D10M", "C3D10H", "C3D10HS", "C3D8", "C3D8R", "C3D20R"}
# Nodes of elements without volume, which are used only for sets.
NOT_SOLID = {
    **dict.fromkeys(("S3", "S3R", "M3D3", "SFM3D3", "STRI3", "CPS3", "CPE3", "CAX3"), 3),
    **dict.fromkeys(("S4", "S4R", "M3D4", "SFM3D4", "CPS4", "CPE4", "CPS4R", "CPE4R", "CAX4", "M3D4R", "R3D4"), 4),
    **dict.fromkeys(("S6", "M3D6", "SFM3D6", "STRI65", "CPS6", "CPE6", "CAX6"), 6),
    **dict.fromkeys(("S8", "S8R", "M3D8", "SFM3D8", "CPS8", "CPE8", "CAX8", "CPS8R", "CPE8R"), 8),
    **dict.fromkeys(("B31", "B31R", "T3D2", "SPRINGA", "DASHPOTA", "B21", "T2D2", "SPRING2", "GAPUNI", "CONN3D2"), 2),
    **dict.fromkeys(("B32", "B32R", "T3D3"), 3),
    **dict.fromkeys(("MASS", "ROTARYI", "SPRING1", "DCOUP3D"), 1),
    "R3D3": 3,
}
# These change the meaning of a deck's numbers; the model would be wrong without them.
REFUSED = {
    **dict.fromkeys(
        ("EMBEDDED ELEMENT", "SHELL TO SOLID COUPLING", "FASTENER", "NETWORK MPC"),
        "it connects nodes to each other in a way that is not read, and the model would be another one without it. "
        "Write it as *TIE, *COUPLING or *EQUATION, or remove it",
    ),
    "CYCLIC SYMMETRY MODEL": "a sector that repeats round an axis is not read. Write the complete model",
    "NONSTRUCTURAL MASS": "its mass would be missing. Remove it, or add its mass to the density of the solids",
    "PARAMETER": "parameters are not read. Write the numbers themselves",
    **dict.fromkeys(
        ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY"),
        "generated nodes and elements are not read. Write each of them into the deck",
    ),
}
# Supported, or without effect on mesh, mass and stiffness.
SILENT = {
    *(
        "HEADING",
        "PREPRINT",
        "END STEP",
        "STATIC",
        "FREQUENCY",
        "OUTPUT",
        "RESTART",
    ),
    *("NODE FILE", "EL FILE", "NODE PRINT", "EL PRINT", "NODE OUTPUT", "ELEMENT OUTPUT", "CONTACT FILE", "MONITOR"),
    *("ELASTIC", "DENSITY", "STEADY STATE DYNAMICS", "DYNAMIC", "MODAL DYNAMIC", "FILE FORMAT", "CONTACT PRINT"),
}
CONSTRAINED_DIRECTIONS = {
    **dict.fromkeys(("ENCASTRE", "PINNED"), (0, 1, 2)),
    **{"XSYMM": (0,), "YSYMM": (1,), "ZSYMM": (2,), "XASYMM": (1, 2), "YASYMM": (0, 2), "ZASYMM": (0, 1)},
}
