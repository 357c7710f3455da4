"""Results with a file of their own, and those that the results file of a study has in a group."""

from __future__ import annotations

from os import PathLike
from typing import ClassVar, Self

from stickslip.core.errors import ResultsFileError
from stickslip.results.groups import read_groups, write_groups
from stickslip.results.stored import StoredGroup
from stickslip.results.variables import Labelled


class Saved(Labelled):
    """Base of results that write and read one file.

    ``STUDY_GROUP`` is the group in which the file of a study has such a result; "" for the response, in its root.
    """

    STUDY_GROUP: ClassVar[str] = ""

    def save(self, path: str | PathLike[str]) -> None:
        """Write one NetCDF-4 file, completely or not at all. Raises ResultsFileError if it cannot be written."""
        write_groups(path, self.to_groups())

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Read a file of :meth:`save`; the object is equal. A mode is read from the results file of its study too.

        Raises ResultsFileError for a file that cannot be read, and for one without such a result.
        """
        return read_groups(path, lambda root: cls.from_group(cls._group_in(root, path)))

    @classmethod
    def _group_in(cls, root: StoredGroup, path: str | PathLike[str]) -> StoredGroup:
        """The group of a file that has this result. Raises ResultsFileError."""
        if not cls.STUDY_GROUP or root.title in ("", cls.DATASET_TITLE):
            return root
        if cls.STUDY_GROUP not in root:
            raise ResultsFileError(
                f'the results file "{path}" has no {cls.STUDY_GROUP}: it contains "{root.title}". Give the '
                'results.nc of a study that computed it with [analysis] kind = "mode"; '
                "ss.ForcedResponse.load reads its response."
            )
        return root.subgroup(cls.STUDY_GROUP)
