"""Form or roughness: which waves of a rough face its contact pairs could carry as gaps, and what they do in the law.

A wave in the mesh and in the stiffness law counts twice; a wave in neither is missing. docs/theory_stiffness_laws.md,
section 1, gives the reason why stickslip reports both numbers and decides nothing itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from stickslip.case.case import Case
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.stiffness.believable import BAND
from stickslip.contact.stiffness.height_spectrum import HeightSpectrum
from stickslip.model.joint import Joint
from stickslip.model.layout import Derived
from stickslip.model.rough_face import RoughFace

POINTS_OF_A_WAVE = 2  # the sampling theorem: fewer points cannot carry a wave
# Chosen: gaps with this fraction of the height of the long waves are no round-off of a mesh, and may be these waves.
SIMILAR_HEIGHT = 0.3


@dataclass(frozen=True)
class LongWaves:
    """Waves of a rough face that its pairs could carry: height (m), and Persson's law with and without them, N/m3."""

    shortest: float  # m, two spacings of the pairs
    sq: float  # m, of these waves
    sq_below: float  # m, of the shorter waves
    stiffness: float
    stiffness_below: float
    form_of_mesh: float  # m, root mean square of the gaps about their mean plane


def long_waves(joint: Joint, number: int, face: RoughFace) -> LongWaves | None:
    """The waves that the pairs of face ``number`` could carry; None if its roughness has only shorter or longer ones,
    or it has no load."""
    members = joint.face_pairs.face == number
    shortest = POINTS_OF_A_WAVE * sqrt(float(joint.face_pairs.area[members].mean()))
    spectrum = face.persson.spectrum
    below = spectrum.wavelength <= shortest
    if face.believable is None or below.all() or not below.any():
        return None
    return LongWaves(
        shortest,
        HeightSpectrum(spectrum.wavelength[~below], spectrum.variance[~below]).sq,
        spectrum.up_to(shortest).sq,
        face.believable.persson,
        float(replace(face.persson, spectrum=spectrum.up_to(shortest)).normal(np.array([face.pressure]))[0]),
        form_of_gaps(joint.face_pairs, number),
    )


def form_of_gaps(pairs: FacePairs, number: int) -> float:
    """Root mean square (m) of the gaps of face ``number`` before any load, about their mean plane."""
    members = pairs.face == number
    plane = np.column_stack([np.ones(int(members.sum())), pairs.face_position[members]])
    rest = pairs.gap[members] - plane @ np.linalg.lstsq(plane, pairs.gap[members], rcond=None)[0]
    return float(np.sqrt((rest**2).mean()))


def form_rows(case: Case, joint: Joint) -> Iterator[Derived]:
    """Rows of `check` and the page on the first rough face whose pairs could carry waves of the law."""
    found = next(_all_long_waves(case, joint), None)
    if found is None:
        return
    _, waves = found
    length = f"{1e3 * waves.shortest:.3g} mm"
    yield (
        "Sq of waves that the pairs could carry",
        float(1e6 * waves.sq),
        "µm",
        f"longer than {length}, two spacings of the pairs; the stiffness law contains them",
    )
    yield "Sq without these waves", float(1e6 * waves.sq_below), "µm", "of the shorter waves alone"
    yield (
        "Stiffness per unit area without these waves",
        float(1e-9 * waves.stiffness_below),
        "N/mm³",
        f'by Persson\'s law, {waves.stiffness_below / waves.stiffness:.3g} times; for form_length = "{length}", if the '
        "mesh has them as gaps",
    )


def form_warnings(case: Case, joint: Joint) -> Iterator[str]:
    """A warning for each face whose gaps are as high as waves that its stiffness law contains too, and for each face
    whose stiffness such waves decide although its mesh has none."""
    for name, waves in _all_long_waves(case, joint):
        ratio = waves.stiffness_below / waves.stiffness
        if waves.form_of_mesh > SIMILAR_HEIGHT * waves.sq:
            yield (
                f"Form or roughness: {name} has gaps with a root mean square of {1e6 * waves.form_of_mesh:.3g} um in "
                f"the mesh, and its stiffness law contains waves of {1e6 * waves.sq:.3g} um that are longer than "
                f"{1e3 * waves.shortest:.3g} mm, which the pairs could carry. If the gaps are these waves, they count "
                f'twice: set roughness.form_length = "{1e3 * waves.shortest:.3g} mm", with which the stiffness is '
                f"{ratio:.3g} times. If they are another form, nothing is to be done."
            )
        elif ratio > BAND:
            yield (
                f"Form or roughness: waves longer than {1e3 * waves.shortest:.3g} mm, two spacings of the pairs, "
                f"decide the stiffness of {name}: {1e-9 * waves.stiffness:.3g} N/mm3 with them, {ratio:.3g} times "
                "without. Such waves let the face touch in few places, but the law distributes their stiffness evenly "
                "over the pairs. If they are form, give them to the mesh as gaps, and set roughness.form_length = "
                f'"{1e3 * waves.shortest:.3g} mm"; if sq was measured behind a cut-off, set sample_length to it.'
            )


def _all_long_waves(case: Case, joint: Joint) -> Iterator[tuple[str, LongWaves]]:
    section = case.roughness
    if section is None or section.law == "fractal" or section.form_length is not None:
        return
    for number, (name, face) in enumerate(zip(joint.face_names, joint.rough_faces, strict=True)):
        waves = None if face is None else long_waves(joint, number, face)
        if waves is not None:
            yield name, waves
