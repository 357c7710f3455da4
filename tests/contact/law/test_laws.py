"""Every law at the seam: exact tangent, the springs of small motions, mixed joints, the registry, other packages."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.contact.law.law import ContactLaw
from stickslip.contact.law.registry import contact_law, contact_law_names, law_constants
from stickslip.results.storage import load_results, save_results

RNG = np.random.default_rng(11)
# The laws accept numbers and lists as constants; the annotations of their fields are those of the stored arrays.
CoulombLaw: Callable[..., ContactLaw] = ss.CoulombLaw
CubicSpring: Callable[..., ContactLaw] = ss.CubicSpring
ElasticStop: Callable[..., ContactLaw] = ss.ElasticStop
JenkinsElement: Callable[..., ContactLaw] = ss.JenkinsElement
IwanJoint: Callable[..., ContactLaw] = ss.IwanJoint
ExponentialContact: Callable[..., ContactLaw] = ss.ExponentialContact
LAWS: dict[str, ContactLaw] = {
    "coulomb": CoulombLaw([2e6, 1e6], [1e6, 3e6], [0.3, 0.4], [20.0, 0.0], [0.0, 2e-6]),
    "cubic": CubicSpring([[1e6, 0.0, 2e6], [1e6, 1e6, 1e6]], [[1e17, 2e17, -1e16], [0.0, 0.0, 0.0]]),
    "elastic-stop": ElasticStop([5e6, 5e6], [3e-6, 1.0], [1e6, 0.0]),
    "jenkins": JenkinsElement([[1e6, 2e6], [1e6, 0.0]], [[4.0, 1e9], [3.0, 1.0]], 5e5),
    "iwan": IwanJoint([[1e6, 2e6], [1e6, 3e6]], [[10.0, 20.0], [1e3, 30.0]], [-0.5, 0.0], [0.3, 0.0], 5e5),
    "exponential": ExponentialContact([2e6, 1e6], [1e6, 3e6], [0.3, 0.8], [20.0, 20.0]),
}
HARMONICS, SAMPLES = 3, 200
# Where a static load has left the two pairs, m; the stop of the first is closed there.
REST = np.array([[2e-6, -1e-6, 5e-6], [-1.5e-6, 3e-6, 1e-6]])


def at(law: ContactLaw, *displacements: np.ndarray) -> object:
    """The memory of a law after steps from its rest."""
    memory = law.memory_at_rest()
    for displacement in displacements:
        memory = law.step(displacement, memory).memory
    return memory


# The same laws about a loaded state, to which a path with a turning point led.
LOADED = {f"{name} about a load": law.about(REST, at(law, 1.6 * REST, REST)) for name, law in LAWS.items()}
ALL = LAWS | LOADED


def motion(size: float = 1e-5) -> np.ndarray:
    """(2, 3, 7) coefficients of two pairs."""
    scale = size / np.array([1, 1, 1, 2, 2, 5, 5])
    return np.random.default_rng(4).normal(size=(2, 3, 2 * HARMONICS + 1)) * scale


@pytest.mark.parametrize("name", ALL)
def test_it_is_a_law_that_its_name_finds_and_its_constants_make_again(name: str) -> None:
    law = ALL[name]
    assert isinstance(law, ss.ContactLaw)
    assert name.removesuffix(" about a load") == law.name
    assert law.name in contact_law_names()
    again = contact_law(law.name)(**law_constants(law))
    coefficients = motion()
    assert np.array_equal(again.period(coefficients, SAMPLES).force, law.period(coefficients, SAMPLES).force)
    assert set(law.period(coefficients, SAMPLES).state) <= set(law.states)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("size", [1e-6, 1e-5])
def test_the_tangent_is_the_derivative_of_the_force(name: str, size: float) -> None:
    law, coefficients = ALL[name], motion(size)
    period = law.period(coefficients, SAMPLES)
    tangent = law.tangent(coefficients, SAMPLES, np.array([0, 1]), period)
    for direction in np.random.default_rng(7).normal(size=(3, *coefficients.shape)):
        # A pair that shakes down: its cycles multiply round-off, so its difference is over a longer way.
        step = (1e-4 if name == "exponential about a load" else 1e-8) * size
        ahead, behind = (law.period(coefficients + sign * step * direction, SAMPLES).force for sign in (1.0, -1.0))
        difference = (ahead - behind) / (2.0 * step)
        assert np.einsum("kapbq,kbq->kap", tangent, direction) == pytest.approx(
            difference, abs=3e-5 * np.abs(difference).max()
        )
    assert np.array_equal(law.tangent(coefficients, SAMPLES, np.array([1]), period)[0], tangent[1])


@pytest.mark.parametrize("name", sorted({*ALL} - {"iwan about a load"}))  # its mean goes on along the backbone
def test_small_motions_feel_the_resting_springs(name: str) -> None:
    law, coefficients = ALL[name], motion(1e-12)
    period = law.period(coefficients, SAMPLES)
    expected = law.resting_springs()[:, :, None] * coefficients
    expected[law.undetermined(), 0] = 0.0
    size = np.abs(expected).max()
    assert period.force == pytest.approx(expected, abs=1e-3 * size)
    still = ~period.moves
    assert period.force[still] == pytest.approx(expected[still], abs=1e-12 * size)


@pytest.mark.parametrize("name", ALL)
def test_what_is_undetermined_changes_no_force(name: str) -> None:
    law, coefficients = ALL[name], motion()
    shifted = coefficients.copy()
    shifted[law.undetermined(), 0] += 1e-4
    first, second = (law.period(each, SAMPLES).force for each in (coefficients, shifted))
    assert second == pytest.approx(first, abs=1e-7 * np.abs(first).max())


@pytest.mark.parametrize("name", ALL)
def test_the_energy_of_a_cycle_is_the_work_of_the_force(name: str) -> None:
    """Against the trapezoidal rule over many samples of the path."""
    law, samples = ALL[name], 20_000
    angle = 2 * np.pi * np.arange(samples) / samples
    waves = np.array([np.ones_like(angle), *(f(h * angle) for h in (1, 2, 3) for f in (np.cos, np.sin))])
    displacement = np.moveaxis(motion() @ waves, 2, 0)
    cycle = law.cycle(displacement)
    middle = 0.5 * (cycle.force + np.roll(cycle.force, -1, axis=0))[:, :, :2]
    work = (middle * (np.roll(displacement, -1, axis=0) - displacement)[:, :, :2]).sum(axis=(0, 2))
    exchanged = np.abs(middle * (np.roll(displacement, -1, axis=0) - displacement)[:, :, :2]).sum(axis=(0, 2)).max()
    assert cycle.dissipated_energy == pytest.approx(work, abs=1e-4 * exchanged)
    assert (cycle.dissipated_energy >= 0.0).all()


def mixed() -> tuple[ss.ContactPairs, list[np.ndarray]]:
    """All laws in one joint, their pairs interleaved."""
    laws = list(LAWS.values())
    groups = [np.array([i, i + len(laws)]) for i in range(len(laws))]
    return ss.ContactPairs.with_laws(np.eye(6 * len(laws)), laws, groups), groups


def test_a_joint_of_several_laws_is_each_law_on_its_pairs() -> None:
    pairs, groups = mixed()
    coefficients = np.empty((pairs.n_pairs, 3, 2 * HARMONICS + 1))
    for group in groups:
        coefficients[group] = motion()
    period = pairs.period(coefficients, SAMPLES)
    select = np.array([1, 3, 9])
    tangent = pairs.tangent(coefficients, SAMPLES, select, period)
    for law, group in zip(pairs.laws, groups, strict=True):
        own = law.period(motion(), SAMPLES)
        assert np.array_equal(period.force[group], own.force)
        assert np.array_equal(period.moves[group], own.moves)
        assert np.array_equal(pairs.hidden_springs(period)[group], law.hidden_springs(own))
        assert np.array_equal(pairs.resting_stiffness().reshape(-1, 3)[group], law.resting_springs())
        for position, pair in enumerate(select):
            if pair in group:
                inside = np.flatnonzero(group == pair)
                assert np.array_equal(tangent[position], law.tangent(motion(), SAMPLES, inside, own)[0])
    assert repr(pairs) == (
        "ContactPairs(2 coulomb + 2 cubic + 2 elastic-stop + 2 jenkins + 2 iwan + 2 exponential pairs on 36 unknowns)"
    )
    displacement = np.random.default_rng(2).normal(size=(64, pairs.n_pairs, 3)) * 1e-5
    cycle = pairs.cycle(displacement)
    for law, group in zip(pairs.laws, groups, strict=True):
        assert np.array_equal(cycle.force[:, group], law.cycle(displacement[:, group]).force)


@pytest.mark.parametrize("name", LAWS)
def test_each_pair_has_one_largest_slip_force_so_laws_mix(name: str) -> None:
    """The warning of a drifting body adds it over all pairs; Iwan joints have a force of their own along t1 and t2."""
    law = LAWS[name]
    assert law.largest_slip_force.shape == (2,)
    pairs = ss.ContactPairs.with_laws(np.eye(12), [law, LAWS["coulomb"]])
    coulomb = np.array([0.3 * 20.0, 0.0])
    assert pairs.largest_slip_force == pytest.approx(np.append(law.largest_slip_force, coulomb))


def test_the_largest_slip_force_of_an_iwan_joint_is_that_of_its_stronger_direction() -> None:
    assert LAWS["iwan"].largest_slip_force == pytest.approx([20.0, 1e3])


def test_each_pair_has_exactly_one_law() -> None:
    law = LAWS["cubic"]
    with rejects(ss.InputError):
        ss.ContactPairs.with_laws(np.eye(9), [law])
    with rejects(ss.InputError):
        ss.ContactPairs.with_laws(np.eye(12), [law, law], [[0, 1], [1, 2]])
    with rejects(ss.InputError):
        ss.ContactPairs.with_laws(np.eye(6), [law], [[1, 0]])
    with rejects(ss.InputError):
        _ = ss.ContactPairs.with_laws(np.eye(6), [law]).tangential_stiffness


def test_a_name_is_given_once() -> None:
    with rejects(ss.InputError):
        ss.register_contact_law("iwan", ss.CubicSpring)
    with rejects(ss.InputError):
        contact_law("glue")


def test_a_law_is_registered_by_a_text_and_a_maker() -> None:
    """A number as a name ended each later study with a TypeError: names are sorted for messages."""
    with rejects(ss.InputError, "name"):
        ss.register_stiffness_law(7, ss.MeasuredStiffness)  # type: ignore[arg-type]
    with rejects(ss.InputError, "law"):
        ss.register_contact_law("mine", 3)  # type: ignore[arg-type]


PACKAGE = """
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
import stickslip as ss

@dataclass(frozen=True)
class Glue(ss.CubicSpring):
    name: ClassVar[str] = "glue"
"""


@pytest.mark.slow
def test_a_law_of_another_package_is_found(tmp_path: Path) -> None:
    """A package that is only on the path: its entry point names the law."""
    (tmp_path / "gluepackage.py").write_text(PACKAGE, encoding="utf-8")
    information = tmp_path / "gluepackage-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: gluepackage\nVersion: 1.0\n", encoding="utf-8")
    (information / "entry_points.txt").write_text(
        "[stickslip.contact_laws]\nglue = gluepackage:Glue\n", encoding="utf-8"
    )
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n"
        "from stickslip.contact.law.registry import contact_law, contact_law_names\n"
        "assert 'glue' in contact_law_names()\n"
        "print(contact_law('glue')(1e6, 1e15).name)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout == "glue\n", done.stderr


@pytest.mark.long
def test_a_curve_with_all_laws_balances_its_energy_and_comes_back_from_its_file(tmp_path: Path) -> None:
    pairs = ss.ContactPairs.with_laws(np.eye(36), list(LAWS.values()))
    chain = np.diag(np.full(36, 4e6)) - 6e5 * (np.eye(36, k=1) + np.eye(36, k=-1))
    force = np.zeros(36)
    force[[0, 12, 26, 32]] = 8.0, 6.0, 8.0, 8.0
    response = ss.forced_response(
        ss.Superelement(0.5 * np.eye(36), chain), pairs, force, frequency_hz=(430.0, 470.0), modal_damping_ratio=0.01
    )
    assert response.converged, response.message
    values = response.input_energy
    lost = response.friction_energy.sum(axis=1) + response.viscous_energy
    assert lost == pytest.approx(values, rel=1e-4)
    assert response.friction_energy[:, 6:].max() > 0.0  # Jenkins, Iwan and exponential
    assert not response.friction_energy[:, 2:6].any()  # elastic ones lose nothing
    save_results(tmp_path / "results.nc", response)
    again = load_results(tmp_path / "results.nc").response
    assert np.array_equal(again.displacement, response.displacement)
    assert repr(again.pairs) == repr(pairs)


def path(samples: int = 300) -> np.ndarray:
    """(n, 2, 3) m: a period of a motion with several turning points."""
    angle = 2 * np.pi * np.arange(samples) / samples
    waves = np.array([np.ones_like(angle), *(f(h * angle) for h in (1, 2, 3) for f in (np.cos, np.sin))])
    return np.moveaxis(motion() @ waves, 2, 0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_steps_along_a_period_end_in_the_periodic_state_of_the_cycle(name: str) -> None:
    """To round-off, Iwan too: its steps and its cycle are two programs of one continuous distribution.

    A cycle of pairs with Coulomb friction walks a millionth of the mean, which these steps reach at once.
    """
    law, displacement = ALL[name], path()
    origin = np.where(law.undetermined(), displacement.mean(axis=0), 0.0)  # a slider that is released starts there
    memory = at(law, *(displacement - origin))
    force = np.empty_like(displacement)
    for sample, each in enumerate(displacement - origin):
        step = law.step(each, memory)
        force[sample], memory = step.force, step.memory
    pairs = ss.ContactPairs.with_laws(np.eye(6), [law])
    whole = force + np.column_stack([pairs.resting_traction, law.normal_load])
    walk = np.abs(np.where(law.undetermined(), 0.0, law.resting_springs() * displacement.mean(axis=0))).max() / CYCLES
    allowed = 1e-10 * np.abs(whole).max() + (2.0 * walk if name.startswith(("coulomb", "exponential")) else 0.0)
    assert whole == pytest.approx(law.cycle(displacement).force, abs=allowed)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_the_derivative_of_a_step_is_that_of_its_force(name: str) -> None:
    law, rng = ALL[name], np.random.default_rng(3)
    memory = law.memory_at_rest()
    for _ in range(60):
        displacement = 1e-5 * rng.normal(size=(2, 3))
        step = law.step(displacement, memory)
        difference = np.empty((2, 3, 3))
        for axis in range(3):
            shift = 1e-11 * np.eye(3)[axis]
            ahead, behind = (law.step(displacement + sign * shift, memory).force for sign in (1.0, -1.0))
            difference[:, :, axis] = (ahead - behind) / 2e-11
        assert step.derivative == pytest.approx(difference, abs=2e-5 * np.abs(difference).max() + 1.0)
        assert np.array_equal(law.step(displacement, memory).force, step.force)  # the memory before stays as it was
        assert set(step.state) <= set(law.states)
        memory = step.memory


@pytest.mark.parametrize("name", ALL)
def test_a_law_about_a_state_continues_as_the_law_would(name: str) -> None:
    """Displacements and forces count from the new rest, memory comes along; twice is as once."""
    law = ALL[name]
    memory = at(law, -0.5 * REST, REST)
    rest = law.step(REST, memory)
    about = law.about(REST, memory)
    own = about.memory_at_rest()
    assert about.step(np.zeros((2, 3)), own).force == pytest.approx(np.zeros((2, 3)), abs=1e-9)
    for displacement in path(12):
        step, moved = law.step(REST + displacement, memory), about.step(displacement, own)
        assert moved.force == pytest.approx(step.force - rest.force, abs=1e-9 * np.abs(step.force).max())
        assert moved.derivative == pytest.approx(step.derivative, rel=1e-6)
        memory, own = step.memory, moved.memory


@pytest.mark.parametrize("name", LAWS)
def test_a_released_law_about_a_state_forgets_its_traction(name: str) -> None:
    law = LAWS[name]
    about = law.about(REST, None)
    assert np.array_equal(about.undetermined(), law.undetermined())
    pairs = ss.ContactPairs.with_laws(np.eye(6), [about])
    assert not pairs.resting_traction[law.frictional()[:, :2]].any()


def test_a_step_of_a_joint_of_several_laws_is_each_law_on_its_pairs() -> None:
    pairs, groups = mixed()
    memory, own = pairs.memory_at_rest(), [law.memory_at_rest() for law in pairs.laws]
    for displacement in 1e-5 * np.random.default_rng(8).normal(size=(3, pairs.n_pairs, 3)):
        step = pairs.step(displacement, memory)
        for number, (law, group) in enumerate(zip(pairs.laws, groups, strict=True)):
            alone = law.step(displacement[group], own[number])
            own[number] = alone.memory
            assert np.array_equal(step.force[group], alone.force)
            assert np.array_equal(step.derivative[group], alone.derivative)
            assert np.array_equal(step.state[group], alone.state)
        memory = step.memory


def test_what_lacks_a_member_is_no_law() -> None:
    class Half:
        name, n_pairs = "half", 1

    with rejects(ss.InputError):
        ss.ContactPairs.with_laws(np.eye(3), [Half()])  # type: ignore[list-item]


def test_a_law_with_springs_of_its_own_has_no_state_under_load() -> None:
    """Its springs would stay those of the unloaded pair: a curve about a load would be wrong without a word."""

    @dataclass(frozen=True)
    class Stubborn(ss.CubicSpring):
        def resting_springs(self) -> np.ndarray:
            return self.stiffness

    stubborn: Callable[..., ContactLaw] = Stubborn
    with rejects(ss.InputError):
        stubborn(1e6, 1e17).about(REST[:1], None)


def test_a_hysteretic_law_that_cannot_keep_its_traction_reports_it() -> None:
    law = LAWS["jenkins"]
    with rejects(ss.InputError):
        ss.HystereticLaw.keeping(law, law.memory_at_rest())  # type: ignore[type-var]


@pytest.mark.slow
def test_loaded_laws_come_back_from_their_file(tmp_path: Path) -> None:
    pairs = ss.ContactPairs.with_laws(np.eye(36), list(LOADED.values()))
    structure = ss.Superelement(0.5 * np.eye(36), 4e6 * np.eye(36))
    window = {"frequency_hz": (430.0, 431.0), "modal_damping_ratio": 0.01}
    save_results(tmp_path / "results.nc", ss.forced_response(structure, pairs, np.ones(36), **window))  # type: ignore[arg-type]
    again = load_results(tmp_path / "results.nc").response.pairs
    coefficients = 1e-6 * np.ones((12, 3, 3))
    assert np.array_equal(again.period(coefficients, 64).force, pairs.period(coefficients, 64).force)
