"""Damaged model files give a sentence with the file's name or a sound model; never a traceback, and never a hang."""

import random
import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.read import read_model
from stickslip.structure.model_facts import body_volumes

MODELS = Path(__file__).parents[2] / "data" / "models"
FILES = sorted(path.name for path in MODELS.iterdir() if path.suffix not in (".py", ""))
LONGEST = 10.0  # s for one file of a few kB


class TooSlow(BaseException):
    """No Exception, so that no reader takes it for damage of the file."""


@contextmanager
def time_limit() -> Iterator[None]:
    def stop(*_: object) -> NoReturn:
        raise TooSlow(f"reading took longer than {LONGEST} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def require_sentence_or_model(path: Path, content: bytes, **included: bytes) -> None:
    """Write a file, and ``included`` ones by their stem, and read it; an error must name one of them."""
    path.write_bytes(content)
    files = [path]
    for stem, text in included.items():
        files.append(path.with_name(f"{stem}{path.suffix}"))
        files[-1].write_bytes(text)
    try:
        with time_limit(), warnings.catch_warnings():
            warnings.simplefilter("error")
            model = read_model(path, "mm")
    except ImportFileError as error:
        if not any(str(file) in str(error) for file in files):
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
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
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


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_the_sound_file_is_read(name: str) -> None:
    model = read_model(MODELS / name, "mm")
    volumes = 1e9 * body_volumes(model.mesh)
    np.testing.assert_allclose(volumes, [1000.0, 500.0] if "gmsh" in name else [1000.0, 1000.0], rtol=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("name", FILES)
@settings(max_examples=60, derandomize=True, deadline=None, database=None)
@given(seed=st.integers(0, 2**32))
def test_damaged_files(folder: Path, name: str, seed: int) -> None:
    content = (MODELS / name).read_bytes()
    require_sentence_or_model(folder / name, damaged(content, seed))


def deck_in_files() -> dict[str, bytes]:
    """The two cubes in a deck that includes its case control, grids in a cylinder by grids, and all else."""
    lines = (MODELS / "cubes.bdf").read_text(encoding="utf-8").splitlines()
    grids = [line for line in lines if line.startswith("GRID")]
    rest = [line for line in lines[lines.index("BEGIN BULK") + 1 :] if line not in grids]
    return {
        "deck": b"SOL 103\nINCLUDE 'control.bdf'\nBEGIN BULK\nINCLUDE bulk.bdf\nENDDATA\n",
        "control": b"CEND\nSPC = 1\n",
        "bulk": "\n".join(["INCLUDE 'gr\n ids.bdf'", "FORCE,3,16,5,2.,1.,3.,4.", *rest[:-1], ""]).encode(),
        "grids": "\n".join(
            [
                *grids[:2],
                "GRID,3,5,14.142135623730951,45.,0.",
                *grids[3:7],
                "GRID,8,6,14.142135623730951,45.,90.,7",
                *grids[8:],
                "CORD1C,5,1,5,2",
                "CORD2S,6,5,0.,0.,0.,0.,0.,1.,+",
                "+,1.,0.,0.",
                "CORD2R,7,6,0.,0.,0.,1.,90.,0.,+",
                "+,1.,90.,90.",
                "GRDSET,,,,,,7",
                "",
            ]
        ).encode(),
    }


def write_deck(folder: Path, files: dict[str, bytes]) -> Path:
    for stem, content in files.items():
        (folder / f"{stem}.bdf").write_bytes(content)
    return folder / "deck.bdf"


def test_the_sound_deck_in_files_is_read(folder: Path) -> None:
    model = read_model(write_deck(folder, deck_in_files()), "mm")
    np.testing.assert_allclose(1e9 * body_volumes(model.mesh), [1000.0, 1000.0], rtol=1e-9)
    np.testing.assert_allclose(model.node_forces[15], [-6.0, 2.0, 8.0], atol=1e-14)
    assert model.fixed_unknowns.tolist() == [*range(12)]


@pytest.mark.long
@pytest.mark.parametrize("stem", deck_in_files())
@settings(max_examples=100, derandomize=True, deadline=None, database=None)
@given(seed=st.integers(0, 2**32))
def test_damaged_decks_in_files(folder: Path, stem: str, seed: int) -> None:
    files = deck_in_files()
    files[stem] = damaged(files[stem], seed)
    require_sentence_or_model(folder / "deck.bdf", files.pop("deck"), **files)


@pytest.mark.slow
@pytest.mark.parametrize("stem", [name for name in deck_in_files() if name != "deck"])
def test_included_rubbish_is_reported_or_harmless(folder: Path, stem: str) -> None:
    sound = deck_in_files()
    whole = sound[stem]
    cuts = [whole[:length] for length in range(0, len(whole), 7)]
    rubbish = [b"\n\n", b"\0", b"hello\n", bytes(range(256)) * 20, random.Random(1).randbytes(3000)]
    for content in [*cuts, *rubbish]:
        files = {name: content if name == stem else text for name, text in sound.items()}
        top = files.pop("deck")
        require_sentence_or_model(folder / "deck.bdf", top, **files)
    for content in (b"", whole + b"\0"):  # empty, binary
        path = write_deck(folder, sound | {stem: content})
        with rejects(ImportFileError):
            read_model(path, "mm")


@pytest.mark.parametrize("suffix", sorted({Path(name).suffix for name in FILES}))
def test_rubbish(folder: Path, suffix: str) -> None:
    path = folder / f"rubbish{suffix}"
    for content in (b"", b"\n\n", b"\0", b"hello\n", bytes(range(256)) * 20, random.Random(1).randbytes(3000)):
        path.write_bytes(content)
        with time_limit(), rejects(ImportFileError):
            read_model(path, "mm")
