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
FLUID_NETWORK = "D"  # an element between two nodes of a flow, of which one at an inlet or outlet may be 0
# Nodes of elements that have no volume, or no displacements, which are used only for sets.
NOT_SOLID = {
    **dict.fromkeys(("S3", "S3R", "S3RS", "DS3", "M3D3", "SFM3D3", "STRI3", "CPS3", "CPE3", "CAX3", "R3D3"), 3),
    **dict.fromkeys(("S4", "S4R", "S4RS", "S4R5", "DS4", "M3D4", "M3D4R", "SFM3D4", "SFM3D4R", "R3D4"), 4),
    **dict.fromkeys(("S6", "DS6", "M3D6", "SFM3D6", "STRI65"), 6),
    **dict.fromkeys(("S8", "S8R", "S8R5", "DS8", "M3D8", "M3D8R", "SFM3D8", "SFM3D8R"), 8),
    **dict.fromkeys((f"{plane}4{form}" for plane in ("CPS", "CPE", "CAX") for form in ("", "R", "I", "H", "P")), 4),
    **dict.fromkeys((f"{plane}6{form}" for plane in ("CPS", "CPE", "CAX") for form in ("", "M", "H")), 6),
    **dict.fromkeys((f"{plane}8{form}" for plane in ("CPS", "CPE", "CAX") for form in ("", "R", "H", "RH")), 8),
    **dict.fromkeys(("B31", "B31R", "B31H", "B31OS", "B33", "B33H", "B21", "B23", "PIPE31", "FRAME3D"), 2),
    **dict.fromkeys(("T3D2", "T2D2", "SPRINGA", "SPRING2", "DASHPOTA", "DASHPOT2", "GAPUNI", "GAPCYL", "CONN3D2"), 2),
    **dict.fromkeys(("B32", "B32R", "B32H", "B32OS", "PIPE32", "T3D3"), 3),
    **dict.fromkeys(("MASS", "ROTARYI", "SPRING1", "DASHPOT1", "HEATCAP", "DCOUP3D"), 1),
    # pipes with flow, fluids, heat and sound
    **{FLUID_NETWORK: 3, "F3D4": 4, "F3D6": 6, "F3D8": 8},
    **{f"{what}3D{count}": count for what in ("DC", "AC") for count in (4, 6, 8, 10, 15, 20)},
}
# These change the meaning of a deck's numbers; the model would be wrong without them.
REFUSED = {
    **dict.fromkeys(
        ("EMBEDDED ELEMENT", "SHELL TO SOLID COUPLING", "FASTENER", "NETWORK MPC"),
        "it connects nodes to each other in a way that is not read, and the model would be another one without it. "
        "Write it as *TIE, *COUPLING or *EQUATION, or remove it",
    ),
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
