"""The benchmarks run: a row of the table, and the agreement that it prints."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from helpers import benchmark_module
from stickslip.model.kinds.two_blade_geometry import BladePairElements
from stickslip.model.model import set_up
from stickslip.structure.model_facts import body_volumes

pytestmark = pytest.mark.slow

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import bench

    return bench  # type: ignore[no-any-return]


@pytest.mark.long
def test_a_row_has_all_cells_and_agrees_with_the_dense_newton(
    bench: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "pyharm_seconds", lambda problem: None)  # minutes, and an extra
    cells = bench.blade_row(10, quick=True)
    assert len(cells) == 10
    assert cells[1] == "9 / 2"
    assert float(cells[-1]) < 1e-8


def test_the_reference_finds_the_known_peak(bench: ModuleType) -> None:
    """198.44 um of first harmonic at 686.8 Hz, as in benchmarks/README.md, from a program that shares no code."""
    problem = bench.load_blade_problem(10)
    dense = sys.modules["dense_newton"]
    points = dense.DenseBalance(problem, harmonics=3, samples=128).sweep(*problem.window_hz)
    peak = max(dense.first_harmonic(point, problem.output) for point in points)
    assert 1e6 * peak == pytest.approx(198.44, abs=0.1)


def test_bricks_cut_into_tetrahedra_fill_the_same_space(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file of benchmarks/tetrahedral_mesh.py, read as any other: volumes of bodies, sides and pairs of faces."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import tetrahedral_mesh

    coarse = BladePairElements(
        shank_rows=3, platform_rows=2, airfoil_rows=5, contact_columns=2, chordwise=4, damper_columns=2
    )
    monkeypatch.setattr(tetrahedral_mesh, "ELEMENTS", coarse)
    path = tmp_path / "coarse.msh"
    tetrahedral_mesh.write_model(path)
    setup = set_up(tetrahedral_mesh.study(path))
    assert 1e9 * body_volumes(setup.mesh) == pytest.approx([38962.7, 38962.7, 1461.34], rel=1e-5)  # type: ignore[attr-defined]
    for name in tetrahedral_mesh.FACES:
        (sides,) = setup.mesh.sides(name)  # type: ignore[attr-defined]
        assert sides.shape == (2 * 2 * 4, 6)
    assert setup.layout.face_pairs.is_matching
    assert setup.layout.face_pairs.n_pairs == 2 * 5 * 9


def test_a_row_of_the_table_of_batches() -> None:
    """The row itself asserts that the peaks agree."""
    cells = benchmark_module("batch_of_curves").row(1, (1, 16))
    assert len(cells) == 6
    assert cells[-1] == "0"  # no curve was solved alone


@pytest.mark.long
def test_verdicts_on_stability_agree_with_time_integration(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two points of benchmarks/stability_check.py, one on each side of a fold, in each of two problems."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import stability_check

    for name, first in (("separating pair, more force", 2), ("blade", 1)):
        problem = stability_check.PROBLEMS[name](name)
        points = stability_check.chosen_points(stability_check.solve(problem))[first : first + 2]
        checked = list(stability_check.check(problem, points))
        assert [each.stable for each in checked] == [True, False]
        assert [each for each in checked if each.contradicts] == []


def test_a_motion_that_leaves_slowly_is_not_taken_for_one_that_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    """Entry 0 of the changes compares with rest and is 1: a growth over it would never be seen."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import stability_check

    leaving = np.append(1.0, 1e-4 * 1.05 ** np.arange(80))
    settling = np.append(1.0, leaving[:0:-1])
    assert stability_check.has_left(leaving)
    assert stability_check.has_left(np.append(leaving, settling[1:]))  # on another motion at the end
    assert stability_check.has_left(np.append(settling, leaving[1:60]))  # an error of the start that decays before
    quick = np.append(1.0, np.append(1e-4 * 2.0 ** np.arange(8), 1e-2 * 0.5 ** np.arange(72)))
    assert stability_check.has_left(quick)  # within a tenth of the time
    walking = np.full(100, 0.03)
    assert stability_check.has_left(walking)  # never repeats
    assert not stability_check.has_left(walking, walks=True)
    assert not stability_check.has_left(settling)
    assert not stability_check.has_left(np.append(leaving[:40], settling[40:]))  # 5 times as large for a while
    assert not stability_check.has_left(np.array([1.0, 1e-8, 1e-9, 5e-8]))
    rattling = np.append(1.0, 0.008 + 0.001 * np.sin(np.arange(400)))
    assert stability_check.has_left(rattling)  # it never repeats
    assert not stability_check.has_left(0.5 * rattling)


def test_the_time_of_the_comparison_follows_from_the_multiplier_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disturbance of narrow 6 with the multiplier 1.0001 needs 80,000 periods: 400 of them show nothing."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import stability_check

    required = stability_check.periods_required
    assert required(1.05) == required(1.0 / 1.05) == required(-1.05) == required(1.05j)
    assert 1.05 ** required(1.05) == pytest.approx(stability_check.GROWTH, rel=0.05)
    assert required(3.0) == required(0.0) == stability_check.LEAST_PERIODS
    assert required(1.0) > required(1.0001) > stability_check.MOST_PERIODS

    slow = stability_check.Checked("", "", 226.607, 1.0001, False, False, apart=1e-4, away=0.01, leaves=False)
    assert (slow.outcome, slow.contradicts) == ("cannot tell", False)
    assert replace(slow, leaves=True).outcome == "leaves"
    assert replace(slow, stable=True, leaves=True).contradicts
    assert replace(slow, away=0.2).outcome == "another motion"
    quick = replace(slow, multiplier=1.05)
    assert (quick.outcome, quick.contradicts) == ("dies out", True)
    assert replace(quick, apart=0.01).outcome == "unclear"


def test_bolts_press_with_their_force_and_asperities_share_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """benchmarks/two_beam.py on a face of its own: each cone carries one bolt, the loads of a position are its load."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import two_beam

    side = np.linspace(-0.05, 0.05, 101)
    position = np.stack([*np.meshgrid(side, side), np.zeros((101, 101))], axis=-1).reshape(-1, 3)
    area = np.full(len(position), 1e-6)
    bolts = np.array([[-0.03, 0.0], [0.03, 0.0]])
    pressure = two_beam.bolt_pressure(position, area, bolts, 0.012)
    assert pressure @ area == pytest.approx(2.0 * two_beam.BOLT_FORCE_N)
    assert pressure[np.linalg.norm(position[:, :2] - bolts[0], axis=1) > 0.012].max() == pytest.approx(
        pressure.max(), rel=1e-9
    )
    loads = two_beam.exponential_loads(8)
    assert loads.mean() == pytest.approx(1.0)
    assert (np.diff(loads) > 0.0).all()
    assert two_beam.exponential_loads(2) == pytest.approx([1.0 - np.log(2.0), 1.0 + np.log(2.0)])


@pytest.mark.long
def test_patches_move_rigidly_and_their_slip_has_its_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    """benchmarks/lap_patches.py: rigid motions pass; little slip, and sliding, in closed form."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import lap_patches
    import two_beam

    x, y = np.meshgrid(np.linspace(-0.06, 0.06, 31), np.linspace(-0.0127, 0.0127, 5))
    position = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    area = np.random.default_rng(1).uniform(1e-6, 2e-6, x.size)
    patches = lap_patches.patch_motion(SimpleNamespace(position=position, area=area)).toarray()
    rigid = two_beam.rigid_rows(position).reshape(-1, 6)
    assert patches @ rigid == pytest.approx(rigid, abs=1e-12)
    assert patches @ patches == pytest.approx(patches, abs=1e-12)
    assert np.linalg.matrix_rank(patches) == 30

    motion, one, stiffness = np.array([[1.0, 0.0, 0.0]]), np.ones(1), 1e4
    energy = (2.0 * np.pi * 100.0) ** 2
    amplitude, spring = lap_patches.AMPLITUDES[1], stiffness * two_beam.TANGENTIAL_RATIO
    x = spring * amplitude / 50.0
    _, little = lap_patches.microslip(motion, one, 100.0 * one, stiffness, 0.5, 100.0)
    assert little == pytest.approx((-0.25 * spring * x / energy, spring * x / (3.0 * np.pi * energy)), rel=0.01)
    _, (shift, damping) = lap_patches.microslip(motion, one, 1e-6 * one, stiffness, 0.5, 100.0)
    assert shift == pytest.approx(-0.5 * spring / energy, rel=0.01)  # nothing is left
    assert damping == pytest.approx(4.0 * 0.5e-6 / (2.0 * np.pi * energy * amplitude), rel=0.01)


@pytest.mark.long
def test_the_force_of_an_iwan_joint_at_phase_resonance_is_the_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """F = a (2 zeta m + 2 R a / (3 pi w^4)): the loop of chi = 0 against the controlled response of half_brb.py."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import half_brb

    mode = half_brb.Mode(mass=2.0, frequency_hz=80.0, damping_ratio=1e-3, coefficient=5e7)
    acceleration = 40.0
    force, frequency = mode.response(acceleration)
    omega, stuck = 2.0 * np.pi * frequency, 2.0 * np.pi * 80.0
    closed = acceleration * (4e-3 * stuck / omega + 1e8 * acceleration / (3.0 * np.pi * omega**4))
    assert force == pytest.approx(closed, rel=4e-3)  # least force, not exactly at 90 degrees
    lowered = 0.5 * 5e7 * acceleration / omega**2 / 2.0  # R X / 2 over the mass
    assert 80.0 - frequency == pytest.approx(80.0 - np.sqrt(stuck**2 - lowered) / (2.0 * np.pi), rel=0.02)


@pytest.mark.long
def test_the_scan_finds_a_peak_that_a_curve_does_not_have() -> None:
    """benchmarks/peak_scan.py between the points of a complete curve, and of the same curve without its peak."""
    peak_scan, problems = benchmark_module("peak_scan"), benchmark_module("torture_problems")
    problem = problems.make("narrow", 201)
    response = problem.solve()
    assert peak_scan.scan(problem, response)[0] == []
    amplitude = response.amplitude(problem.structure.output)
    flat = np.flatnonzero(amplitude < 0.3 * amplitude.max())
    without_peak = SimpleNamespace(
        harmonics=response.harmonics,
        n_points=flat.size,
        frequency_hz=response.frequency_hz[flat],
        part=np.zeros(flat.size, dtype=int),
        warnings=(),
        amplitude=lambda row: response.amplitude(row)[flat],
        pair_coefficients=lambda point: response.pair_coefficients(int(flat[point])),
    )
    (found,) = peak_scan.scan(problem, without_peak)[0]
    assert found.frequency_hz == pytest.approx(response.frequency_hz[amplitude.argmax()], rel=1e-4)
    assert found.amplitude == pytest.approx(amplitude.max(), rel=0.01)
    assert not found.named
