"""Damage to the content of a file, the same at every run of the tests."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np


def damaged(content: bytes, flips: int, seed: int = 18) -> Iterator[tuple[str, bytes]]:
    """(what was done, damaged content): flipped bytes at places spread over the file, cuts, bytes too many, nothing."""
    random = np.random.default_rng(seed)
    ends = np.concatenate(
        [np.arange(60), len(content) - 1 - np.arange(200)]
    )  # head and tail are special in most formats
    places = np.unique(np.concatenate([ends, random.integers(len(content), size=flips)]).clip(0, len(content) - 1))
    for place, flip in zip(places, random.integers(1, 256, size=len(places)), strict=True):
        changed = bytearray(content)
        changed[place] ^= int(flip)
        yield f"byte {place} ^ {flip}", bytes(changed)
    for retained in (0, 1, len(content) // 3, len(content) - 1, *random.integers(len(content), size=10)):
        yield f"cut after {retained} bytes", content[: int(retained)]
    yield "one byte too many", content + b"\n"
    yield "twice", content + content
