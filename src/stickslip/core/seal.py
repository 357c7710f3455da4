"""A digest at the end of files that only stickslip writes and reads, so that damage cannot cause a wrong number.

The seal is the last line of a file: the subject of the file (such as the hash of the inputs) and a digest of subject
and content. It shows that a file was changed, cut, or renamed to that of another subject. It follows the content
because NumPy and unzip still open an .npz file with extra bytes at its end. It protects against damage, not against
forgery: whoever changes a file on purpose can compute the digest too.
"""

from __future__ import annotations

import hashlib
import json
import os
from typing import BinaryIO

from stickslip.core.errors import ResultsFileError

_DIGEST_BYTES = 32  # blake2b with 256 bits
_CHUNK_BYTES = 1 << 20  # read at a time; chosen to bound the memory
_LONGEST_SEAL = 1000  # bytes, for the message about the seal of another subject
_FIRST_WORDS = b'\n{"sealed by stickslip": '


def seal(stream: BinaryIO, subject: str) -> None:
    """Append the seal to a stream that contains the content; it must be readable and writable."""
    size = stream.seek(0, os.SEEK_END)
    line = _seal(stream, size, subject)
    stream.seek(size)
    stream.write(line)


def require_seal(stream: BinaryIO, subject: str) -> int:
    """Size in bytes of the content before the seal; the stream is then at its start.

    Raises ResultsFileError, with a message that names no file, unless the content was sealed as ``subject``.
    """
    length = len(_line(subject, ""))
    end = stream.seek(0, os.SEEK_END)
    size = max(0, end - length)
    expected = _seal(stream, size, subject)
    stream.seek(max(0, end - length - _LONGEST_SEAL))
    last = stream.read()
    stream.seek(0)
    if end >= length and last.endswith(expected):
        return size
    if _FIRST_WORDS not in last:
        raise ResultsFileError("it has no digest: it is damaged or truncated, or an older version wrote it.")
    raise ResultsFileError("its digest does not match: it is damaged, or belongs to other inputs or another version.")


def _seal(stream: BinaryIO, size: int, subject: str) -> bytes:
    """The seal of the first ``size`` bytes; they are read in parts, because a cached structure may be large."""
    digest = hashlib.blake2b(subject.encode() + b"\n", digest_size=_DIGEST_BYTES)
    stream.seek(0)
    while size > 0 and (chunk := stream.read(min(size, _CHUNK_BYTES))):
        digest.update(chunk)
        size -= len(chunk)
    return _line(subject, digest.hexdigest())


def _line(subject: str, digest: str) -> bytes:
    return _FIRST_WORDS + f'{json.dumps(subject)}, "blake2b": "{digest:0>{2 * _DIGEST_BYTES}}"}}\n'.encode()
