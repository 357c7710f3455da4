"""The keys of a study file that choose a law: the contact law of an interface, the stiffness law of a face."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator

from stickslip.case.law_constants import (
    COULOMB,
    LawConstants,
    contact_law_declaration,
    read_constants,
    stiffness_law_declaration,
)
from stickslip.case.section import Section, chosen_by
from stickslip.case.sections import ContactStiffnessSection
from stickslip.contact.constants import FRICTION, GAP, NORMAL_LOAD, STIFFNESSES, Declaration
from stickslip.core.errors import InputError

# Keys that are sections of their own, with the constants of a law.
CONSTANT_TABLES = ("constants", "stiffness_constants")


class ContactLawKeys(Section):
    """The contact law of an interface."""

    law: str | None = Field(
        default=None,
        description="contact law, default coulomb; docs/studies.md lists the laws with their constants",
        examples=["iwan"],
    )
    constants: LawConstants | None = Field(
        default=None,
        validate_default=True,
        description="of law, also as a section [interfaces.NAME.constants]",
        examples=['{ slip_force = "120 N", exponent = -0.5, ratio = 0.1 }'],
    )

    @field_validator("law")
    @classmethod
    def _is_a_law(cls, value: str | None) -> str | None:
        if value not in (None, COULOMB):
            contact_law_declaration(value)
        return value

    @field_validator("constants", mode="plain")
    @classmethod
    def _constants_of_the_law(cls, value: Any, info: ValidationInfo) -> LawConstants | None:
        if "law" not in info.data:
            return None  # the law itself is wrong, and its error says so
        name = info.data["law"]
        if name in (None, COULOMB):
            if value:
                raise InputError(f'is for another law than "{COULOMB}", whose values are keys of the interface.')
            return None

        def try_law(**values: Any) -> None:
            """The law of one pair that is the whole face; 1 replaces constants that only the joint has."""
            import numpy as np

            from stickslip.contact.law.registry import contact_law
            from stickslip.contact.shared_constants import shared_constants

            given = {
                GAP: info.data.get("gap"),
                NORMAL_LOAD: info.data.get("normal_load"),
                FRICTION: info.data.get("friction"),
                **{key: info.data.get(key) for key in STIFFNESSES},
            }
            joint = {key: np.full(1, 1.0 if given[key] is None else given[key]) for key in declaration.of_joint}
            contact_law(name)(**shared_constants(declaration.constants, values, np.ones(1)), **joint)

        declaration = contact_law_declaration(name)
        return read_constants(value, name, declaration, try_law)

    @property
    def other_law(self) -> str | None:
        """The name of a law other than Coulomb's."""
        return None if self.law == COULOMB else self.law

    @property
    def declaration(self) -> Declaration:
        """The declarations of the law."""
        return contact_law_declaration(self.law or COULOMB)


class StiffnessLawKeys(Section):
    """The law of the stiffness of a face under its pressure, instead of [roughness]."""

    stiffness_law: str | None = Field(
        default=None,
        description="law of stiffness over pressure, instead of [roughness]",
        examples=["measured"],
    )
    allocation: Literal["area", "pressure"] | None = Field(
        default=None,
        description="of stiffness_law: mean pressure of the face (area, the default) or that of each pair",
        examples=["pressure"],
    )
    stiffness_constants: LawConstants | None = Field(
        default=None,
        validate_default=True,
        description="of stiffness_law, also as a separate section",
        examples=['{ file = "stiffness.csv" }'],
    )

    @field_validator("stiffness_law")
    @classmethod
    def _is_a_stiffness_law(cls, value: str | None) -> str | None:
        if value is not None:
            stiffness_law_declaration(value)
        return value

    @field_validator("allocation")
    @classmethod
    def _of_a_stiffness_law(cls, value: str | None, info: ValidationInfo) -> str | None:
        if value is not None and info.data.get("stiffness_law", "") is None:
            raise InputError("belongs to stiffness_law; for a rough face it is roughness.allocation. Remove it.")
        return value

    @field_validator("stiffness_constants", mode="plain")
    @classmethod
    def _constants_of_the_stiffness_law(cls, value: Any, info: ValidationInfo) -> LawConstants | None:
        if "stiffness_law" not in info.data:
            return None  # the law itself is wrong, and its error says so
        name = info.data["stiffness_law"]
        if name is None:
            if value:
                raise InputError("belongs to stiffness_law, which is not given. Give it, or remove the section.")
            return None

        def try_law(**values: Any) -> None:
            from stickslip.contact.stiffness.registry import stiffness_law

            stiffness_law(name)(**values)

        return read_constants(value, name, stiffness_law_declaration(name), try_law)


class StiffnessLawSection(StiffnessLawKeys):
    """Stiffness of the contact faces by a law over their pressure, instead of [roughness]."""

    foreign: ClassVar[dict[str, str]] = dict.fromkeys(STIFFNESSES, "and stiffness_law are both given. Remove one.")


FaceStiffness = Annotated[
    ContactStiffnessSection | StiffnessLawSection,
    chosen_by(
        lambda data: (
            StiffnessLawSection if isinstance(data, Mapping) and "stiffness_law" in data else ContactStiffnessSection
        )
    ),
]


def table_file(name: str, section: Any) -> dict[str, str]:
    """The file with stiffness over pressure that a section names."""
    constants = section.stiffness_constants if isinstance(section, StiffnessLawKeys) else None
    return {} if constants is None or constants.file is None else {f"{name}.stiffness": constants.file}
