"""Makes two_blades.msh again: python tests/data/two_blades/make_two_blades_msh.py [FILE]; needs the module gmsh.

The two blades and the damper of ``two_blade_mesh.py`` in quadratic tetrahedra, in mm. Everything is written out
here, so that the file needs nothing of this project. The meshes of damper and platforms do not match: the damper is
finer, and no body shares nodes with another.

Made with Gmsh 4.15; other versions may place other nodes.
"""

import math
import sys
from pathlib import Path

import gmsh

Corner = tuple[float, float, float]

WIDTH = 28.0
SLOPE = math.radians(30.0)
RUN, RISE = 6.5 * math.cos(SLOPE), 6.5 * math.sin(SLOPE)
GAP, OVERHANG, UNDERSIDE, EDGE, TIP = 1.0, 11.7, 36.7, 5.7, 145.0
SHANK_TOP, SHANK_BASE, AIRFOIL, FLANK = 13.9, 9.3, 7.0, 2.5
LOW, HIGH = -(0.5 * GAP + RUN), -0.5 * GAP  # x of the left contact face
INNER = LOW - OVERHANG
OUTER = INNER - SHANK_TOP
TOP = UNDERSIDE + RISE + EDGE
FORCE_HEIGHT = 3.67  # of N1 and N2, as in the model of hexahedra

# x, z of the left blade, counter-clockwise, with the size of the elements at each corner; the contact face is side 3.
BLADE = [
    (OUTER, 0.0, 8.0),
    (OUTER + SHANK_BASE, 0.0, 8.0),
    (INNER, UNDERSIDE, 6.0),
    (LOW, UNDERSIDE, 4.6),
    (HIGH, UNDERSIDE + RISE, 4.6),
    (HIGH, TOP, 4.5),
    (OUTER + AIRFOIL, TOP, 6.0),
    (OUTER + AIRFOIL, TIP, 9.0),
    (OUTER, TIP, 9.0),
    (OUTER, TOP, 7.0),
]
DAMPER_SIZE = 3.3
DAMPER = [
    (LOW, UNDERSIDE - FLANK, DAMPER_SIZE),
    (-LOW, UNDERSIDE - FLANK, DAMPER_SIZE),
    (-LOW, UNDERSIDE, DAMPER_SIZE),
    (-HIGH, UNDERSIDE + RISE, DAMPER_SIZE),
    (HIGH, UNDERSIDE + RISE, DAMPER_SIZE),
    (LOW, UNDERSIDE, DAMPER_SIZE),
]


def prism(corners: list[Corner], points: dict[str, tuple[float, float]], sides: dict[str, int], name: str) -> None:
    """A section at y = -14 mm drawn out to y = 14 mm, with groups: the volume, ``sides`` by number, ``points`` x, z."""
    occ = gmsh.model.occ  # unlike the built-in kernel it does not merge the faces of two bodies that touch
    marks = [(0, occ.addPoint(x, -0.5 * WIDTH, z)) for x, z, _ in corners]
    lines = [occ.addLine(mark, marks[(at + 1) % len(marks)][1]) for at, (_, mark) in enumerate(marks)]
    section = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    solid = next(each for each in occ.extrude([(2, section)], 0.0, WIDTH, 0.0) if each[0] == 3)
    places = [(0, occ.addPoint(x, 0.0, z)) for x, z in points.values()]
    if places:
        _, parts = occ.fragment([solid], places)  # puts the points on their face or edge
        (solid,), places = parts[0], [part[0] for part in parts[1:]]
    occ.synchronize()
    border = gmsh.model.getBoundary([solid], recursive=True, oriented=False)
    for entity in border:
        x, _, z = gmsh.model.getValue(*entity, [])
        gmsh.model.mesh.setSize([entity], min(corners, key=lambda each: math.hypot(each[0] - x, each[1] - z))[2])
    gmsh.model.addPhysicalGroup(3, [solid[1]], name=name)
    faces = gmsh.model.getBoundary([solid], oriented=False)
    for group, side in sides.items():
        ends = corners[side], corners[(side + 1) % len(corners)]
        middle = (0.5 * (ends[0][0] + ends[1][0]), 0.0, 0.5 * (ends[0][1] + ends[1][1]))
        face = min((tag for _, tag in faces), key=lambda tag: math.dist(occ.getCenterOfMass(2, tag), middle))
        gmsh.model.addPhysicalGroup(2, [face], name=group)
    for group, (_, tag) in zip(points, places, strict=True):
        gmsh.model.addPhysicalGroup(0, [tag], name=group)


def main(path: str) -> None:
    """Mesh and groups."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    left_points = {"N1": (OUTER, FORCE_HEIGHT), "A": (OUTER, TIP)}
    prism(BLADE, left_points, {"left_root": 0, "left_face": 3}, "left_blade")
    right = [(-x, z, size) for x, z, size in BLADE]
    prism(right, {"N2": (-OUTER, FORCE_HEIGHT)}, {"right_root": 0, "right_face": 3}, "right_blade")
    prism(DAMPER, {}, {"damper_bottom": 0, "damper_right": 2, "damper_left": 4}, "damper")
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(path)
    nodes = gmsh.model.mesh.getNodes()[0].size
    print(f"{path}: {nodes} nodes, {gmsh.model.mesh.getElementsByType(11)[0].size} tetrahedra, Gmsh {gmsh.__version__}")
    gmsh.finalize()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else str(Path(__file__).with_name("two_blades.msh")))
