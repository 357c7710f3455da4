"""The sections [interfaces.NAME] of a study file: the joints between faces of a mesh or nodes of matrices."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from stickslip.case.law_keys import ContactLawKeys, StiffnessLawKeys
from stickslip.case.quantities import (
    Area,
    Coordinate,
    Direction,
    Distance,
    FileName,
    ForceOrNone,
    FrictionCoefficient,
    Stiffness,
)
from stickslip.case.section import Required, Section, chosen_by, has_value
from stickslip.contact.constants import STIFFNESSES

GROUND = "ground"
OF_MESH = "belongs to faces of a mesh. Remove it."
OF_MATRICES = "belongs to matrices; the faces of a mesh define their own. Remove it."
_SIDE = 'is missing. Give the name of a set; second may be "ground".'


class _JointKeys(Section):
    """The keys of a joint of any kind: its load, its friction and its stiffness."""

    tangent: Direction | None = Field(
        default=None,
        description="first direction of sliding; default: z, or x on a face across z",
        examples=[[0.0, 0.0, 1.0]],
    )
    normal_load: ForceOrNone | None = Field(
        default=None, description="at rest, on the complete face with uniform pressure", examples=["289 N"]
    )
    friction: FrictionCoefficient | None = Field(
        default=None, description="friction coefficient of this face, instead of that of [friction]", examples=[0.3]
    )
    normal_stiffness: Stiffness | None = Field(
        default=None, description="of the complete face, instead of [roughness]", examples=["1.34e8 N/m"]
    )
    tangential_stiffness: Stiffness | None = Field(default=None, examples=["1.11e8 N/m"])


class InterfaceSection(ContactLawKeys, StiffnessLawKeys, _JointKeys):
    """A joint of any kind: its load, its friction, its stiffness and its laws."""

    @property
    def has_own_stiffness(self) -> bool:
        """Whether the section gives a stiffness, directly or by a law."""
        given = (self.normal_stiffness, self.tangential_stiffness, self.stiffness_law)
        return any(each is not None for each in given)

    @property
    def needs_stiffness(self) -> bool:
        """Whether the contact law must have a stiffness of the joint."""
        return any(map(self.requires, STIFFNESSES))

    def requires(self, constant: str) -> bool:
        """Whether the contact law must have a value of the joint."""
        return self.other_law is None or self.declaration.needs(constant)


# The keys that lead a section are on a class of their own: a file has them before those that all joints share.
class _Sides(Section):
    first: Annotated[str, Required(_SIDE)] = Field(
        description="face or node set that defines areas and normals: the finer mesh",
        examples=["upper_contact"],
    )
    second: Annotated[str, Required(_SIDE)] = Field(
        description="face or node set of the other side, or ground", examples=["lower_contact"]
    )
    search_distance: Distance | None = Field(
        default=None, description="along the normal; faces farther apart form no pairs", examples=["0.2 mm"]
    )


class _FacesOfMesh(_Sides):
    points: Literal["nodes", "quadrature"] | None = Field(
        default=None,
        description="positions of the pairs on the first face; default nodes",
        examples=["nodes"],
    )
    edge_tolerance: Distance | None = Field(
        default=None, description="largest distance of a point beyond the edge of the second face", examples=["0.05 mm"]
    )
    gap_tolerance: Distance | None = Field(
        default=None, description="gaps up to it are set to zero", examples=["0.001 mm"]
    )
    gap: Coordinate | None = Field(
        default=None, description="to the ground, along the normal; default 0", examples=["0 mm"]
    )
    adjust: Literal["measured", "closed"] | None = Field(
        default=None,
        description="initial gaps: those between the meshes, or all zero",
        examples=["closed"],
    )


class MeshInterfaceSection(InterfaceSection, _FacesOfMesh):
    """A joint between two faces, or a face and the rigid ground."""

    foreign: ClassVar[Mapping[str, str]] = dict.fromkeys(("normal", "area", "pairs"), OF_MATRICES)


class _FaceOfMatrices(Section):
    normal: Annotated[
        Direction, Required("is missing: matrices do not define it. Give it, such as [0, 0, 1], out of the first side.")
    ] = Field(description="out of the first side", examples=[[0.0, 0.0, 1.0]])
    area: Annotated[
        Area, Required('is missing: matrices do not define it. Give it, such as "180 mm^2", of the complete face.')
    ] = Field(description="of the complete face; pairs have equal parts", examples=["180 mm^2"])
    gap: Distance | None = Field(
        default=None, description="of each pair at rest, for a contact law with a gap", examples=["0.1 mm"]
    )


_MESH_KEYS = dict.fromkeys(("points", "edge_tolerance", "gap_tolerance", "adjust"), OF_MESH)


class SetInterfaceSection(InterfaceSection, _FaceOfMatrices, _Sides):
    """A joint between the nodes of two sets, or between one set and the rigid ground."""

    foreign: ClassVar[Mapping[str, str]] = _MESH_KEYS


class _ListedPairs(Section):
    pairs: FileName = Field(
        description="instead of first and second: lines first node, second node", examples=["lap_pairs.csv"]
    )


class PairsInterfaceSection(InterfaceSection, _FaceOfMatrices, _ListedPairs):
    """A joint between the nodes of a list."""

    foreign: ClassVar[Mapping[str, str]] = {
        **_MESH_KEYS,
        **dict.fromkeys(("first", "second", "search_distance"), "is not used if pairs names the nodes. Remove it."),
    }


MatrixInterface = Annotated[
    SetInterfaceSection | PairsInterfaceSection,
    chosen_by(lambda data: PairsInterfaceSection if has_value(data, "pairs") else SetInterfaceSection),
]
