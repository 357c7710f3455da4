"""The seal of a file: it opens for its subject and its content alone."""

from __future__ import annotations

import io

import numpy as np
import pytest

from damage import damaged
from sentences import rejects
from stickslip.core import seal as seal_module
from stickslip.core.errors import ResultsFileError
from stickslip.core.seal import require_seal, seal

CONTENT = b'{"peak_amplitude_m": 9.1e-06}\n' * 8


def sealed(content: bytes, subject: str) -> bytes:
    stream = io.BytesIO(content)
    seal(stream, subject)
    return stream.getvalue()


@pytest.mark.parametrize("content", [b"", CONTENT, bytes(range(256)) * 20])
def test_content_is_given_back(content: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(seal_module, "_CHUNK_BYTES", 64)  # several chunks
    stream = io.BytesIO(sealed(content, "case \N{GREEK SMALL LETTER ALPHA}"))
    assert stream.read(require_seal(stream, "case \N{GREEK SMALL LETTER ALPHA}")) == content


@pytest.mark.slow
def test_every_changed_byte_every_cut_and_every_addition_is_noticed() -> None:
    whole = sealed(CONTENT, "case 1")
    for place in range(len(whole)):
        for bit in range(8):
            changed = bytearray(whole)
            changed[place] ^= 1 << bit
            with rejects(ResultsFileError):
                require_seal(io.BytesIO(changed), "case 1")
        with rejects(ResultsFileError):
            require_seal(io.BytesIO(whole[:place]), "case 1")
    for _, content in damaged(whole, 0):
        with rejects(ResultsFileError):
            require_seal(io.BytesIO(content), "case 1")


def test_another_subject_and_a_file_without_seal_are_distinguished() -> None:
    for other in ("case 2", "case 10", ""):
        with rejects(ResultsFileError):
            require_seal(io.BytesIO(sealed(CONTENT, "case 1")), other)
    for content in (b"", CONTENT):
        with rejects(ResultsFileError):
            require_seal(io.BytesIO(content), "case 1")


def test_an_archive_of_arrays_still_opens_in_numpy() -> None:
    stream = io.BytesIO()
    np.savez(stream, numbers=np.arange(5))
    with np.load(io.BytesIO(sealed(stream.getvalue(), "case 1"))) as data:
        assert data["numbers"].tolist() == [0, 1, 2, 3, 4]
