"""Line contact by Hertz against boundary elements, a formula of roller bearings, and half-planes of finite elements."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.sparse.linalg

from sentences import printed_sentence, rejects
from stickslip.contact.stiffness.hertz_line import (
    NODE_RADIUS,
    HertzLine,
    HertzLineStiffness,
    LineBody,
    depth_below_node,
    node_radius,
)
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Element, Material, assemble
from stickslip.structure.mesh import Mesh

STEEL = LineBody(210e9, 0.3, 1e-3)
SOFT = LineBody(70e9, 0.34, 2e-3)


def pressed_half_planes(line: HertzLine, force: float) -> tuple[float, float, float]:
    """Boundary elements: half width, largest pressure, and approach of the reference points.

    Uniform strips of pressure on two half-planes under a parabola of radius R; strips with tension are left out. Only
    Flamant's displacements of a line force are used.
    """
    half = 1.6 * line.half_width(force)
    edges = np.linspace(-half, half, 402)
    x, width = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0]

    def of_strip(offset: FloatArray) -> FloatArray:
        """Integral of ln |t| over a strip."""
        ends = np.stack([offset + 0.5 * width, offset - 0.5 * width])
        upper, lower = ends * (np.log(np.abs(ends)) - 1.0)
        return np.asarray(upper - lower)

    compliance = sum(2.0 * (1.0 - b.poisson_ratio**2) / (math.pi * b.young_modulus) for b in line.bodies)
    members = np.arange(x.size)
    while True:
        size = members.size
        matrix = np.zeros((size + 1, size + 1))
        matrix[:-1, :-1] = -compliance * of_strip(x[members, None] - x[members])
        matrix[:-1, -1] = -1.0  # both surfaces move together by a constant less the parabola
        matrix[-1, :-1] = width
        right = np.append(-(x[members] ** 2) / (2.0 * line.radius), force)
        pressure = np.linalg.solve(matrix, right)[:-1]
        if (pressure >= 0.0).all():
            break
        members = members[pressure >= 0.0]
    approach = 0.0  # of the surface in the middle against the point at the depth below, of each body
    for body in line.bodies:
        nu, factor = body.poisson_ratio, (1.0 + body.poisson_ratio) / (math.pi * body.young_modulus)
        squared = x[members] ** 2 + body.depth**2
        below = width * (-(1.0 - nu) * np.log(squared) + body.depth**2 / squared)
        approach += factor * float(pressure @ (-2.0 * (1.0 - nu) * of_strip(x[members]) - below))
    return 0.5 * width * size, float(pressure.max()), approach


FORCE = 2e4  # N/m


@pytest.mark.parametrize("bodies", [(STEEL, STEEL), (STEEL, SOFT)])
def test_closed_form_against_boundary_elements(bodies: tuple[LineBody, LineBody]) -> None:
    line = HertzLine(6.6e-3, *bodies)
    b = line.half_width(FORCE)
    half, pressure, approach = pressed_half_planes(line, FORCE)
    assert half == pytest.approx(b, rel=0.01)
    assert pressure == pytest.approx(line.largest_pressure(FORCE), rel=2e-3)
    assert approach == pytest.approx(float(line.approach(np.array([FORCE]))[0]), rel=1e-3)


def test_against_the_formula_of_roller_bearings() -> None:
    """Palmgren's 3.84e-5 Q^0.9 / L^0.8 mm (N, mm), a fit to steel rollers on raceways that contains no radius: the
    approach of the axis of a roller and the raceway below. With depths of one radius it is within a fifth."""
    radius, length = 5e-3, 10e-3
    line = HertzLine(radius, *(LineBody(206e9, 0.3, radius),) * 2)
    for load in (300.0, 1e3, 3e3):
        palmgren = 3.84e-8 * load**0.9 / (1e3 * length) ** 0.8
        assert float(line.approach(np.array([load / length]))[0]) == pytest.approx(palmgren, rel=0.2)


def test_stiffness_is_the_slope_and_force_the_inverse() -> None:
    line = HertzLine(6.6e-3, STEEL, SOFT)
    force = np.array([1e-2, 1.0, 1e3, 5e4])
    step = 1e-4 * force
    slope = 2.0 * step / (line.approach(force + step) - line.approach(force - step))
    np.testing.assert_allclose(line.stiffness(force), slope, rtol=1e-6)
    np.testing.assert_allclose(line.force(line.approach(force)), force, rtol=1e-9)
    np.testing.assert_array_equal(line.force(np.array([0.0, -1e-6])), 0.0)
    assert line.stiffness(np.array([1.01 * line.largest_force]))[0] == 0.0
    with rejects(InputError, "approach"):
        line.force(2.0 * line.approach(np.array([line.largest_force])))


def test_tangential_is_the_mean_compliance_across_and_along_the_axis() -> None:
    """Across the axis the compliance is that of the normal, along it 1 / (1 - nu) times as large."""
    law = HertzLineStiffness(HertzLine(6.6e-3, STEEL, STEEL), 1e-4)
    pressure = np.array([1e8])
    normal = law.normal(pressure)
    mean = 0.5 * (1.0 / normal + 1.0 / (normal * (1.0 - STEEL.poisson_ratio)))
    np.testing.assert_allclose(law.tangential(pressure), 1.0 / mean, rtol=1e-12)
    np.testing.assert_allclose(normal * law.width, law.line.stiffness(pressure * law.width))


def test_a_contact_wider_than_the_elements_is_announced() -> None:
    law = HertzLineStiffness(HertzLine(6.6e-3, *(LineBody(210e9, 0.3, 2e-5),) * 2), 1e-4)
    assert law.valid(np.array([1.0])) == ()
    sentences = law.valid(np.array([1e9]))
    assert len(sentences) == 1
    assert law.normal(np.array([1e9]))[0] == 0.0
    printed_sentence(sentences[0])


def graded(count: int, side: float, far: float) -> FloatArray:
    """Coordinates with ``count`` equal sides and growing ones beyond."""
    found, step = [side * at for at in range(count + 1)], side
    while found[-1] < far:
        step *= 1.8
        found.append(found[-1] + step)
    return np.array(found)


def displacement_of_a_loaded_node(element: Element, along: float, deep: float, poisson_ratio: float) -> float:
    """Radius of the node of a half-plane of elements under a line force: its displacement against a node below."""
    right, down = graded(5, along, 200.0), graded(12, deep, 200.0)
    x, z = np.concatenate([-right[:0:-1], right]), -down[::-1]
    points = np.array([[a, y, b] for y in (0.0, 1.0) for b in z for a in x])
    grid = np.arange(x.size * z.size).reshape(z.size, x.size)
    sides = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(-1, 4)
    column = grid[:, right.size - 1]
    layer = x.size * z.size
    fixed = np.unique(np.concatenate([grid[0], grid[:, 0], grid[:, -1]]))
    sets = {"fixed": np.concatenate([fixed, fixed + layer]), "load": np.array([column[-1], column[-1] + layer])}
    mesh = Mesh(points, np.hstack([sides + layer, sides]), node_sets=sets)
    mesh = mesh.quadratic() if element == "serendipity" else mesh
    modulus = 1e3
    structure = assemble(mesh, Material(modulus, poisson_ratio, 1.0), element=element)
    in_plane = structure.free_unknowns % 3 != 1
    loaded = mesh.node_set("load")
    weights = np.array([0.5, 0.5]) if loaded.size == 2 else np.array([1.0, 1.0, 4.0]) / 6.0
    force = np.zeros(3 * mesh.n_nodes)
    force[3 * loaded + 2] = -weights
    free = structure.free_unknowns[in_plane]
    found = np.zeros(3 * mesh.n_nodes)
    found[free] = scipy.sparse.linalg.spsolve(structure.stiffness[in_plane][:, in_plane].tocsc(), force[free])
    below = int(column[-13])
    difference = -float(weights @ found[3 * loaded + 2]) + float(found[3 * below + 2])
    # Flamant: u(radius on the surface) - u(depth z below) = 2 (1 - nu^2) / (pi E) (ln(z / radius) - 1 / (2 (1 - nu)))
    scaled = difference * math.pi * modulus / (2.0 * (1.0 - poisson_ratio**2))
    return float(-mesh.points[below, 2] * math.exp(-scaled - 0.5 / (1.0 - poisson_ratio)))


@pytest.mark.slow
@pytest.mark.parametrize("element", list(NODE_RADIUS))
def test_radius_of_a_loaded_node(element: Element) -> None:
    for along, deep, allowed in ((1.0, 1.0, 0.02), (2.0, 1.0, 0.1)):
        found = displacement_of_a_loaded_node(element, along, deep, 0.3)
        assert node_radius(element, along, deep) == pytest.approx(found, rel=allowed)


def test_elements_and_contact_together_do_not_depend_on_the_mesh() -> None:
    """Displacement of a node against a far point, plus the spring: that of the half-plane under Hertz, whatever h."""
    force, far, modulus, nu = FORCE, 50e-3, 210e9, 0.3
    sums = []
    for side in (2e-3, 1e-3, 0.5e-3):
        radius = node_radius("incompatible", side, side)
        one = LineBody(modulus, nu, depth_below_node(radius, nu))
        spring = 0.5 / float(HertzLine(6.6e-3, one, one).stiffness(np.array([force]))[0])
        elements = 2.0 * one.compliance * (math.log(far / radius) - 0.5 / (1.0 - nu))
        sums.append(spring + elements)
    whole = LineBody(modulus, nu, far)
    expected = 0.5 / float(HertzLine(6.6e-3, whole, whole).stiffness(np.array([force]))[0])
    np.testing.assert_allclose(sums, expected, rtol=1e-12)


@pytest.mark.parametrize(("key", "value"), [("young_modulus", 0.0), ("poisson_ratio", 0.7), ("depth", -1.0)])
def test_bodies_that_cannot_be_used(key: str, value: float) -> None:
    with rejects(InputError, key):
        LineBody(**{"young_modulus": 2e11, "poisson_ratio": 0.3, "depth": 1e-3, key: value})


def test_radius_and_width_are_above_zero() -> None:
    with rejects(InputError, "radius"):
        HertzLine(0.0, STEEL, STEEL)
    with rejects(InputError, "width"):
        HertzLineStiffness(HertzLine(1e-3, STEEL, STEEL), 0.0)
