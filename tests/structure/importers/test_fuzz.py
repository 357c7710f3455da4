"""Damaged model files give a sentence with the file's name or a sound model; never a traceback, and never a hang."""

import random
import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stickslip.errors import ImportFileError
from stickslip.structure.importers.read import read_model
from stickslip.structure.model_facts import body_volumes

MODELS = Path(__file__).parents[2] / "data" / "models"
FILES = sorted(path.name for path in MODELS.iterdir() if path.suffix not in (".py", ""))
LONGEST = 10.0  # s for one file of a few kB


class TooSlow(BaseException):
    """No Exception, so that no reader takes it for damage of the file."""


@contextmanager
def time_limit() -> Iterator[None]:
    def stop(*_):
        raise TooSlow(f"reading took longer than {LONGEST} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def require_sentence_or_model(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    try:
        with time_limit(), warnings.catch_warnings():
            warnings.simplefilter("error")
            model = read_model(path, "mm")
    except ImportFileError as error:
        if str(path) not in str(error):
            raise
        return
    # A wrong model would be one whose parts do not fit together.
    mesh = model.mesh
    assert (body_volumes(mesh) > 0.0).all()
    assert model.node_labels.shape == (mesh.n_nodes,)
    assert model.element_labels.shape == (mesh.n_cells,)
    assert np.isfinite(model.node_forces).all()
    for name, sides in mesh.face_sets.items():
        np.testing.assert_array_equal(mesh.node_set(name), np.unique(np.concatenate([s.ravel() for s in sides])))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("damaged")


def damaged(content: bytes, seed: int) -> bytes:
    """One of: cut off, lines shuffled, a line left out or doubled, bytes changed, binary rubbish inside."""
    chance = random.Random(seed)
    how = chance.randrange(6)
    if how == 0:
        return content[: chance.randrange(len(content))]
    if how in (1, 2, 3):
        lines = content.splitlines(keepends=True)
        at, other = chance.randrange(len(lines)), chance.randrange(len(lines))
        if how == 1:
            chance.shuffle(lines)
        elif how == 2:
            del lines[at]
        else:
            lines.insert(other, lines[at])
        return b"".join(lines)
    changed = bytearray(content)
    if how == 4:
        for _ in range(chance.randint(1, 4)):
            changed[chance.randrange(len(changed))] = chance.choice([*b"0123456789 ,.-+*$<>\n", chance.randrange(256)])
        return bytes(changed)
    at = chance.randrange(len(changed))
    changed[at : at + chance.randint(0, 200)] = chance.randbytes(chance.randint(1, 300))
    return bytes(changed)


@pytest.mark.parametrize("name", FILES)
def test_the_sound_file_is_read(name):
    model = read_model(MODELS / name, "mm")
    volumes = 1e9 * body_volumes(model.mesh)
    np.testing.assert_allclose(volumes, [1000.0, 500.0] if "gmsh" in name else [1000.0, 1000.0], rtol=1e-9)


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=60, derandomize=True, deadline=None, database=None)
@given(seed=st.integers(0, 2**32))
def test_damaged_files(folder, name, seed):
    content = (MODELS / name).read_bytes()
    require_sentence_or_model(folder / name, damaged(content, seed))


@pytest.mark.parametrize("suffix", sorted({Path(name).suffix for name in FILES}))
def test_rubbish(folder, suffix):
    path = folder / f"rubbish{suffix}"
    for content in (b"", b"\n\n", b"\0", b"hello\n", bytes(range(256)) * 20, random.Random(1).randbytes(3000)):
        path.write_bytes(content)
        with time_limit(), pytest.raises(ImportFileError, match=f"rubbish{suffix}"):
            read_model(path, "mm")
