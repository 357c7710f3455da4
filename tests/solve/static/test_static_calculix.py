"""The preload of the two blades beside contact of CalculiX on the same mesh with the same stiffness per area."""

from pathlib import Path

import numpy as np
import pytest

from calculix_contact import (
    NODE,
    SURFACE,
    PressedBlades,
    calculix_contact,
    closed_areas,
    differs_beyond_one_row,
    node_fields,
    our_contact,
)
from stickslip.model.kinds.two_blade_geometry import BladePairElements

FORCE, ANGLE = 500.0, np.pi / 6  # N on the damper; slope of the platforms
HALF_LENGTH = 14e-3  # m, of the damper
ELEMENTS = BladePairElements(
    shank_columns=2, shank_rows=3, platform_rows=2, airfoil_rows=4, inner_columns=1, contact_columns=4, chordwise=6,
    damper_columns=2, damper_flank_rows=1,
)  # fmt: skip
# Stiffness per area in N/m3, friction coefficient, contact formulation of CalculiX, gap in m at the damper's ends: its
# faces are crowned along y.
CASES = [
    (1e12, 0.0, SURFACE, 0.0),
    (1e13, 0.3, SURFACE, 0.0),
    (1e12, 0.3, NODE, 0.0),
    (1e12, 0.3, SURFACE, 8e-6),
]
FURTHER_CASES = [(1e12, 0.3, SURFACE, 0.0), (1e13, 0.0, SURFACE, 0.0), (1e13, 0.3, NODE, 0.0)]  # 6 s together


@pytest.fixture(scope="module")
def blades() -> PressedBlades:
    return PressedBlades.build(ELEMENTS, FORCE)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "friction", "kind", "crown"),
    [*CASES, *(pytest.param(*case, marks=pytest.mark.long) for case in FURTHER_CASES)],
)
def test_forces_open_area_and_peak_pressure(
    blades: PressedBlades, tmp_path: Path, stiffness: float, friction: float, kind: str, crown: float
) -> None:
    gap = crown * (blades.mesh.points[blades.pairs.first_node, 1] / HALF_LENGTH) ** 2
    actual = calculix_contact(tmp_path, blades, stiffness, friction, kind, gap)
    own = our_contact(blades, stiffness, friction, gap)
    np.testing.assert_allclose(own.normal, actual.normal, rtol=1e-2)
    np.testing.assert_allclose(own.shear, actual.shear, rtol=1e-2, atol=1e-3 * FORCE)
    assert own.pressure.max() == pytest.approx(actual.pressure.max(), rel=0.1)
    assert (own.closure < 0.0).any()  # so that there is an open area to compare
    assert not differs_beyond_one_row(blades.pairs, own.closure > 0.0, actual.closure > 0.0)
    if kind == SURFACE:
        row = blades.face_areas / min(ELEMENTS.contact_columns, ELEMENTS.chordwise)
        assert own.closed_area is not None
        assert (np.abs(own.closed_area - actual.closed_area) < row).all()


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_each_face_takes_the_force_of_the_wedge(blades: PressedBlades, friction: float) -> None:
    """F_N / (2 (cos theta + mu sin theta)), although the blades bend, pressure varies and pairs open."""
    own = our_contact(blades, 1e12, friction)
    wedge = FORCE / (2.0 * (np.cos(ANGLE) + friction * np.sin(ANGLE)))
    np.testing.assert_allclose(own.normal, wedge, rtol=1e-3)
    np.testing.assert_allclose(own.shear, friction * wedge, rtol=2e-3, atol=1e-9)


def test_a_row_further_is_a_difference(blades: PressedBlades) -> None:
    """The comparison itself: a border that moves by one row passes, one that moves by two does not."""
    across = blades.pairs.face_position[:, 1]
    levels = np.unique(np.round(across, 9))
    closed = {count: across < levels[count] - 1e-6 for count in (2, 3, 4)}
    assert not differs_beyond_one_row(blades.pairs, closed[2], closed[3])
    assert differs_beyond_one_row(blades.pairs, closed[2], closed[4])


def test_results_are_read_from_the_last_increment(tmp_path: Path) -> None:
    statistics = """
 statistics for slave set SURFACE_DAMPER_{}, master set SURFACE_X and time  0.1E+01

   area,  normal force (+ = tension) and shear force (size)

    {} -2.461361E+02  7.372083E+01
"""
    rows = [("LEFT", "1.0E-04"), ("RIGHT", "2.0E-04"), ("LEFT", "3.0E-04"), ("RIGHT", "4.0E-04")]
    assert closed_areas("".join(statistics.format(*row) for row in rows)).tolist() == [3e-4, 4e-4]
    blocks = [
        f" -4  CONTACT     6    1\n -5  COPEN       1    4    1    1\n -5  CPRESS      1    4    1    2\n"
        f" -1         2 1.00000E+00 {value:.5E}\n -3\n"
        for value in (5.0, 7.0)
    ]
    (tmp_path / "result.frd").write_text("".join(blocks))
    fields = node_fields(tmp_path / "result.frd", ("CPRESS",), 3)
    np.testing.assert_array_equal(fields[:, 0], [np.nan, 7.0, np.nan])
