"""The section of a study file with natural frequencies from elsewhere, which its mode table is compared with."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, field_validator

from stickslip.case.section import Section
from stickslip.core.errors import InputError
from stickslip.core.units import Quantity

# Rows of the mode table: a choice, for joints and dampers act on the lowest modes.
MODE_COUNT = 10
ReferenceFrequency = Annotated[float, Quantity("frequency", at_least=0.0, at_most=1e12)]


class ReferenceSection(Section):
    """Natural frequencies from another source (modal test, another program, publication). The mode table of the report
    shows them with the deviation of the model; they change no result."""

    mode_frequencies: tuple[ReferenceFrequency, ...] = Field(
        description=f"of modes 1, 2, ... of that table, at most {MODE_COUNT}; 0 for a mode without one",
        examples=[["412 Hz", "530 Hz"]],
    )
    source: str = Field(description="their origin", examples=["modal test, March 2024"])

    @field_validator("mode_frequencies")
    @classmethod
    def _some_and_no_more_than_the_table_has(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if len(value) > MODE_COUNT:
            raise InputError(
                f"has {len(value)} frequencies, but the mode table has {MODE_COUNT} modes. Give those of the first "
                f"{MODE_COUNT} modes."
            )
        if not any(value):
            raise InputError('has no frequency above 0. Give those of the first modes, for example ["412 Hz"].')
        return value

    @field_validator("source")
    @classmethod
    def _says_something(cls, value: str) -> str:
        if not value.strip():
            raise InputError('is empty. Give the origin of the frequencies, for example "modal test, March 2024".')
        return value
