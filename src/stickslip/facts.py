"""What follows from a case before anything is solved, in words and numbers: for `check` and for the report."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from stickslip.model import FACE_NAMES, Joint, boundary_nodes
from stickslip.results.response import ForcedResponse
from stickslip.structure.elasticity import Structure

if TYPE_CHECKING:
    from stickslip.case import Case

Derived = tuple[str, str | float | int, str, str]


def derived_quantities(case: Case, joint: Joint) -> tuple[Derived, ...]:
    """(name, value, unit, explanation) of preload, stiffness and roughness of each face."""
    return tuple(_faces(joint)) + tuple(_roughness(case, joint))


def _faces(joint: Joint) -> Iterator[Derived]:
    area = joint.face_sum(joint.face_pairs.area)
    load = joint.face_sum(joint.preload)
    normal, tangential = joint.face_sum(joint.normal_stiffness), joint.face_sum(joint.tangential_stiffness)
    for face, name in enumerate(FACE_NAMES):
        pressure = load[face] / area[face]
        yield f"Normal load, {name}", float(load[face]), "N", "sum of the preload of its pairs"
        yield f"Mean pressure, {name}", float(1e-6 * pressure), "MPa", "normal load over nominal area"
        yield f"Normal stiffness, {name}", float(normal[face]), "N/m", "all pairs of the face, closed"
        yield f"Tangential stiffness, {name}", float(tangential[face]), "N/m", "all pairs of the face, stuck"
        yield (
            f"Normal stiffness per unit area, {name}",
            float(1e-9 * normal[face] / area[face]),
            "N/mm³",
            "as contact stiffness is often given",
        )


def _roughness(case: Case, joint: Joint) -> Iterator[Derived]:
    if not joint.rough_faces or case.roughness is None:
        return
    given, first = case.roughness, joint.rough_faces[0]
    yield "Fractal dimension D", given.fractal_dimension, "-", "of the surface; share of fine-scale content"
    yield "Fractal roughness G", given.fractal_roughness, "m", "scale of the heights"
    yield "Sq", float(1e6 * first.statistics.sq), "µm", "root mean square height between the longest and shortest wave"
    yield "Sdq", float(first.statistics.sdq), "-", "root mean square slope"
    yield (
        "Critical spot area",
        float(1e6 * first.stiffness.critical_area),
        "mm²",
        "smaller spots are plastic, larger ones elastic",
    )
    yield "Largest spot area", float(1e6 * first.stiffness.largest_area), "mm²", "of one face under its preload"
    nominal = joint.face_sum(joint.face_pairs.area)[0]
    yield "Real over nominal area", float(first.stiffness.real_area / nominal), "-", "of one face"
    yield "Load on plastic spots", float(100.0 * first.stiffness.plastic_load_share), "%", "share of the preload"


def natural_frequencies_found(response: ForcedResponse, count: int = 4) -> tuple[Derived, ...]:
    """The first natural frequencies of the two linear limits of this study, as the curves show them."""
    limits = {
        "all contacts closed and stuck": ("stuck", response.linear.stuck_frequency_hz),
        "no contact; rigid-body motion of the damper left out": ("free", response.linear.free_frequency_hz),
    }
    return tuple(
        (f"Natural frequencies, {name}", ", ".join(f"{f:.2f}" for f in values[:count]), "Hz", words)
        for words, (name, values) in limits.items()
    )


def study_warnings(joint: Joint) -> tuple[str, ...]:
    """What the roughness law says against its own use here, each sentence once."""
    sentences = dict.fromkeys(message for face in joint.rough_faces for message in face.stiffness.messages)
    return tuple(sentences)


def sizes(case: Case, structure: Structure, joint: Joint) -> tuple[tuple[str, str], ...]:
    """What would run: elements, nodes, unknowns before and after reduction, pairs, and unknowns of the balance."""
    mesh, pairs = structure.mesh, joint.face_pairs
    boundary = boundary_nodes(structure.mesh, joint.face_pairs).size
    reduced = 3 * boundary + case.reduction.modes
    columns = 2 * case.solver.harmonics + 1
    return (
        ("elements", f"{mesh.n_cells} ({case.mesh.element})"),
        ("nodes", f"{mesh.n_nodes}"),
        ("unknowns of the full model", f"{structure.stiffness.shape[0]} free of {3 * mesh.n_nodes}"),
        ("unknowns after reduction", f"{reduced} ({3 * boundary} of boundary nodes, {case.reduction.modes} modes)"),
        ("contact pairs", f"{pairs.area.size} on {len(FACE_NAMES)} faces"),
        ("unknowns of the balance", f"up to {3 * pairs.area.size * columns} ({case.solver.harmonics} harmonics)"),
    )
