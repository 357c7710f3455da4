"""The contact stiffness of a rough face by any law that follows from its roughness."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, get_args, overload

import numpy as np

from stickslip.contact.stiffness.asperities import Roughness
from stickslip.contact.stiffness.fractal import (
    ContactStiffness,
    FaceStiffness,
    StiffnessMode,
    fractal_contact,
)
from stickslip.contact.stiffness.fractal_law import FractalStiffness
from stickslip.contact.stiffness.height_spectrum import HeightSpectrum
from stickslip.contact.stiffness.persson import PerssonStiffness
from stickslip.contact.stiffness.stiffness_law import StiffnessLaw
from stickslip.contact.stiffness.summits import BushGibsonThomasStiffness, GreenwoodWilliamsonStiffness
from stickslip.contact.stiffness.tangential import TangentialRatio
from stickslip.core.errors import InputError
from stickslip.core.validation import positive_number, real_number, require_choice

RoughnessLaw = Literal["fractal", "persson", "greenwood-williamson", "bush-gibson-thomas"]
DEFAULT_LAW: RoughnessLaw = "persson"
FIRST_MODE: StiffnessMode = "consistent"


@overload
def contact_stiffness(
    roughness: Roughness,
    load: float,
    mode: StiffnessMode,
    area: float | None = None,
    law: Literal["fractal"] | None = None,
) -> ContactStiffness: ...
@overload
def contact_stiffness(
    roughness: Roughness,
    load: float,
    mode: None = None,
    area: float | None = None,
    *,
    law: Literal["fractal"],
) -> ContactStiffness: ...
@overload
def contact_stiffness(
    roughness: Roughness,
    load: float,
    mode: StiffnessMode | None = None,
    area: float | None = None,
    law: RoughnessLaw | None = None,
    tangential_law: TangentialRatio = "mindlin",
    form_length: float | None = None,
) -> FaceStiffness: ...
def contact_stiffness(
    roughness: Roughness,
    load: float,
    mode: StiffnessMode | None = None,
    area: float | None = None,
    law: RoughnessLaw | None = None,
    tangential_law: TangentialRatio = "mindlin",
    form_length: float | None = None,
) -> FaceStiffness:
    """Normal and tangential stiffness (N/m) of a face of ``area`` (m2) under ``load`` (N); zero for a load <= 0.

    persson, greenwood-williamson, bush-gibson-thomas: docs/theory_stiffness_laws.md; they require ``area``, and
        ``sample_length`` and ``shortest_length`` of the roughness.
    fractal: the spots of the fractal law, in one of three ``mode`` s (docs/theory_roughness.md); ``area`` is optional.

    Without ``law`` it is persson, the one that agrees best with boundary elements; with a ``mode`` alone it is fractal.
    A fully plastic face has the stiffness of one round spot of its real area, unless the mode is unloading.

    Parameters
    ----------
    roughness:
        of both faces together.
    load, area:
        N on the face, and its nominal area in m2.
    mode:
        of the fractal law: "consistent" (its default), "varying-curvature" or "unloading".
    law, tangential_law, form_length:
        the law; the last two belong to the first three laws, as in :func:`law_of_roughness`.

    Returns
    -------
    FaceStiffness
        ``normal`` and ``tangential`` in N/m; of the fractal law with its status and its spots.

    Raises
    ------
    InputError
        for values that are not usable.

    Sources: B. N. J. Persson, Phys. Rev. Lett. 99 (2007) 125502; those of the other laws are in
    docs/theory_stiffness_laws.md.
    """
    law = _chosen(law, mode)
    if law == "fractal":
        for name, value, default in (("tangential_law", tangential_law, "mindlin"), ("form_length", form_length, None)):
            if value != default:
                raise InputError(
                    f'{name} is {value!r}, but the law "fractal" has none. Choose another law, or omit it.',
                    arguments=[name],
                )
        return fractal_contact(roughness, load, mode or FIRST_MODE, area)
    if area is None:
        raise InputError(
            f'the law "{law}" requires the area of the face in m2. Give area; only law = "fractal" does without.',
            arguments=["area"],
        )
    load, face = real_number("load", load), positive_number("area", area, "m2")
    chosen = law_of_roughness(roughness, face, law, tangential_law=tangential_law, form_length=form_length)
    if load <= 0.0:
        message = f"The load is {load:g} N: the face is not pressed, so it has no contact stiffness."
        return FaceStiffness(0.0, 0.0, (message,))
    pressure = np.array([load / face])
    normal, tangential = (face * float(each[0]) for each in (chosen.normal(pressure), chosen.tangential(pressure)))
    return FaceStiffness(normal, tangential, chosen.valid(pressure))


def _chosen(law: RoughnessLaw | None, mode: StiffnessMode | None) -> RoughnessLaw:
    """The law: the default, or fractal where only a mode is given. Raises InputError for a mode of another law."""
    if law is None:
        return DEFAULT_LAW if mode is None else "fractal"
    require_choice("law", law, get_args(RoughnessLaw))
    if law != "fractal" and mode is not None:
        raise InputError(
            f'mode is "{mode}", but only the law "fractal" has modes, and law is "{law}". Omit one of the two.',
            arguments=["mode"],
        )
    return law


def law_of_roughness(
    roughness: Roughness,
    area: float,
    law: RoughnessLaw | None = None,
    mode: StiffnessMode | None = None,
    tangential_law: TangentialRatio = "mindlin",
    form_length: float | None = None,
) -> StiffnessLaw:
    """The law of a rough face of ``area`` (m2): its stiffness per area over the pressure.

    ``law`` and ``mode`` as in :func:`contact_stiffness`; ``form_length`` in m: longer waves are form, which the mesh
    has as gaps between the faces, and not roughness; None for all waves. Raises InputError for values that are not
    usable.
    """
    law = _chosen(law, mode)
    if law == "fractal":
        return FractalStiffness(roughness, area, mode or FIRST_MODE)
    if law == "persson":
        return persson_law(roughness, area, form_length, tangential_law)
    summits = GreenwoodWilliamsonStiffness if law == "greenwood-williamson" else BushGibsonThomasStiffness
    spectrum = _spectrum(roughness, form_length)
    return summits(spectrum, roughness.reduced_modulus, roughness.poisson_ratio, tangential_law)


def persson_law(
    roughness: Roughness, area: float, form_length: float | None = None, tangential_law: TangentialRatio = "mindlin"
) -> PerssonStiffness:
    """Persson's law of a rough face, as :func:`law_of_roughness` gives it."""
    modulus, ratio = roughness.reduced_modulus, roughness.poisson_ratio
    return PerssonStiffness(_spectrum(roughness, form_length), modulus, ratio, area, roughness.hardness, tangential_law)


@lru_cache(maxsize=64)  # of the rough faces of a ridge or a sweep, whose loads alone differ
def _spectrum(roughness: Roughness, form_length: float | None) -> HeightSpectrum:
    spectrum = HeightSpectrum.of_fractal(roughness)
    return spectrum if form_length is None else spectrum.up_to(form_length)
