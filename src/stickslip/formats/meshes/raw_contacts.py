"""Contact pairs of a model file, which a study may take over as joints."""

from __future__ import annotations

from dataclasses import dataclass

GROUND = "ground"


@dataclass(frozen=True)
class RawContact:
    """Two face sets that the file declares to be in contact.

    Parameters
    ----------
    name:
        that of the file, or of the number of the pair.
    first:
        the face whose nodes the other program prevents from penetration: secondary (slave) surface, contact elements.
    second:
        the other face, or ``ground`` for a rigid one.
    friction:
        friction coefficient; None where the file has none.
    is_bonded:
        whether the faces neither slide nor separate, which is a tie and no joint.
    notes:
        properties of the pair that a joint of a study does not have, as half sentences.
    """

    name: str
    first: str
    second: str
    friction: float | None
    line: int
    is_bonded: bool = False
    notes: tuple[str, ...] = ()

    def words(self) -> str:
        """The pair in one sentence."""
        friction = "no friction coefficient" if self.friction is None else f"friction {self.friction:g}"
        kind = "bonded" if self.is_bonded else friction
        notes = "".join(f"; {note}" for note in self.notes)
        return f"contact pair '{self.name}': {self.first} against {self.second}, {kind}{notes}."
