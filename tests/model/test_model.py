"""From a case to the solver's input: sizes, loads, stiffness, forces and outputs of the two-blade model."""

from __future__ import annotations

import numpy as np
import pytest

from castings import ROUGH_CASTING, casting_case
from sentences import rejects
from stickslip.case.case import Case
from stickslip.contact.stiffness.fractal import fractal_contact
from stickslip.core.errors import InputError
from stickslip.model.model import Model, build_joint, build_model, build_structure
from stickslip.model.rough_face import case_roughness
from stickslip.structure.elasticity import Structure
from stickslip.study.facts import derived_quantities

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def structure() -> Structure:
    return build_structure(casting_case())  # type: ignore[return-value]


@pytest.fixture(scope="module")
def model(structure: Structure) -> Model:
    case = casting_case()
    return build_model(case, structure, build_joint(case, structure))


def test_default_sizes(model: Model) -> None:
    assert isinstance(model.structure, Structure)
    assert model.structure.mesh.n_nodes == 5005
    assert model.superelement.size == 699
    assert model.pairs.n_pairs == 110
    assert model.pairs.operator.shape == (330, 699)


def test_a_study_file_with_the_earlier_name_of_a_mode_gives_the_same_springs(structure: Structure) -> None:
    """K_n along the family of spots is 2 (3-d) / (3 (2-d)) times that at fixed curvature, d = 1.4 at D = 2.4."""
    plain, earlier, today = (
        build_joint(
            Case.from_text(f'[roughness]\nmode = "{mode}"\nfractal_dimension = 2.4\nfractal_roughness = "1e-8 m"\n'),
            structure,
        )
        for mode in ("consistent", "paper", "varying-curvature")
    )
    assert np.array_equal(earlier.normal_stiffness, today.normal_stiffness)
    assert np.array_equal(earlier.tangential_stiffness, plain.tangential_stiffness)
    assert earlier.normal_stiffness == pytest.approx(plain.normal_stiffness * 3.2 / 1.8, rel=1e-12)


def test_both_faces_carry_the_centrifugal_force(structure: Structure) -> None:
    """Equilibrium of the damper: the vertical parts of both normal forces add up to F_N."""
    joint = build_joint(casting_case(), structure)
    upward = (joint.preload[:, None] * joint.face_pairs.normal).sum(axis=0)
    assert upward[2] == pytest.approx(500.0, rel=1e-12)
    assert abs(upward[0]) < 1e-9
    assert joint.face_sum(joint.preload) == pytest.approx([250.0 / np.cos(np.pi / 6)] * 2)


def test_both_allocations_agree_under_uniform_pressure(structure: Structure) -> None:
    by_area = build_joint(casting_case(), structure)
    by_pressure = build_joint(casting_case().replace({"roughness.allocation": "pressure"}), structure)
    assert np.allclose(by_area.normal_stiffness, by_pressure.normal_stiffness, rtol=1e-9)
    assert np.allclose(by_area.tangential_stiffness, by_pressure.tangential_stiffness, rtol=1e-9)


@pytest.mark.parametrize("reference", [50e-6, 364e-6])
def test_pairs_follow_one_law_of_a_reference_area(structure: Structure, reference: float) -> None:
    """k_i = A_i kappa(p_i), kappa(p) = K(p A_ref) / A_ref, under a pressure that differs from pair to pair."""
    changes = {
        "roughness.allocation": "pressure",
        "roughness.reference_area": f"{1e6 * reference} mm^2",
        "preload.values": [3.0 + 0.02 * number for number in range(110)],
    }
    joint = build_joint(
        Case.from_mapping({"preload": {"values": changes.pop("preload.values")}}).replace(ROUGH_CASTING | changes),
        structure,
    )
    area, (face, _) = joint.face_pairs.area, joint.rough_faces
    material = joint.layout.face_materials[0]
    roughness = case_roughness(casting_case(), *material)
    law = [fractal_contact(roughness, load) for load in joint.preload / area * reference]
    np.testing.assert_allclose(joint.normal_stiffness, [k.normal / reference for k in law] * area, rtol=1e-12)
    np.testing.assert_allclose(joint.tangential_stiffness, [k.tangential / reference for k in law] * area, rtol=1e-12)
    assert face is not None
    load = joint.face_sum(joint.preload)[0] / joint.face_sum(area)[0] * reference
    assert face.stiffness.real_area == pytest.approx(fractal_contact(roughness, load).real_area)
    rows = {name: value for name, value, _, _ in derived_quantities(casting_case().replace(changes), joint)}
    assert rows["Reference area"] == pytest.approx(1e6 * reference)
    assert rows["Real over nominal area"] == pytest.approx(face.stiffness.real_area / reference)


def test_given_stiffness_is_spread_by_area(structure: Structure) -> None:
    case = Case.from_mapping(
        {"contact_stiffness": {"normal_stiffness": "3e8 N/m", "tangential_stiffness": "2.5e8 N/m"}}
    )
    joint = build_joint(case, structure)
    assert joint.face_sum(joint.normal_stiffness) == pytest.approx([3e8, 3e8])
    assert joint.face_sum(joint.tangential_stiffness) == pytest.approx([2.5e8, 2.5e8])
    assert joint.rough_faces == (None, None)


def test_a_fully_plastic_face_has_the_least_stiffness_of_its_real_area_and_a_message(structure: Structure) -> None:
    joint = build_joint(casting_case().replace({"roughness.fractal_dimension": 2.2}), structure)
    load, face = joint.face_sum(joint.preload), joint.rough_faces[0]
    least = 2.0 * 108.2417582e9 * np.sqrt(load / (np.pi * 3e9))  # E* and hardness of the case
    assert joint.face_sum(joint.normal_stiffness) == pytest.approx(least, rel=1e-6)
    assert face is not None
    assert face.messages[0].startswith("Fully plastic")


def test_wrong_number_of_preloads_is_rejected(structure: Structure) -> None:
    case = Case.from_mapping({"preload": {"values": [2.5, 2.5, 2.5]}})
    with rejects(InputError, "preload.values"):
        build_joint(case, structure)


@pytest.mark.parametrize(("mode", "right"), [("single", 0.0), ("same", 300.0), ("opposite", -300.0)])
def test_excitation_modes(structure: Structure, model: Model, mode: str, right: float) -> None:
    case = casting_case().replace({"excitation.mode": mode})
    excitation = build_model(case, structure, model.joint).excitation
    force = excitation.on(model.superelement, 1).coefficients(0.0)[2]
    sets = structure.mesh.node_sets
    actual = [
        force[model.superelement.unknowns_of(int(sets[name][0]))] for name in ("excitation_left", "excitation_right")
    ]
    assert np.allclose(actual, [[300.0, 0, 0], [right, 0, 0]])
    assert np.count_nonzero(force) == (1 if mode == "single" else 2)


def test_outputs_read_the_full_mesh(model: Model) -> None:
    """A rigid shift of the boundary reads as itself, in each output's direction."""
    recovered = model.superelement.recovery
    assert isinstance(model.structure, Structure)
    node = int(model.structure.mesh.node_sets["response"][0])
    generator = np.random.default_rng(0)
    motion = generator.normal(size=model.superelement.size)
    assert model.outputs["blade tip A"] @ motion == pytest.approx((recovered @ motion)[3 * node])
    assert len(model.outputs) == 7


def test_rayleigh_damping_goes_into_the_superelement(structure: Structure, model: Model) -> None:
    case = Case.from_mapping({"damping": {"rayleigh_alpha": "3 1/s", "rayleigh_beta": "1e-7 s"}})
    damped = build_model(case, structure, model.joint).superelement
    assert damped.damping is not None
    assert np.allclose(damped.damping, 3.0 * damped.mass + 1e-7 * damped.stiffness, rtol=1e-9, atol=1e-9)
