"""CalculiX' own test decks: how many stickslip reads or rejects with a sentence, and frequencies against `ccx`.

    python benchmarks/calculix_decks.py FOLDER [--frequencies]

FOLDER has the decks of the Debian package calculix-ccx-test (examples/test, also compressed). The deck for the
frequencies is that part of each deck which is above its first step, with the constraints of this step, 1 kg/m3 where a
material has no density, and the elements that both programs have (C3D8 for 8 nodes, C3D20 for 20). Contact, plasticity,
creep, initial stress and cyclic symmetry are left out of it. Decks with shells, springs, other materials or nonlinear
constraints are not compared. CalculiX integrates the mass of tetrahedra and wedges with fewer points than stickslip,
and the stiffness of C3D6 too; the second deviation is that of stickslip with these points.
"""

from __future__ import annotations

import argparse
import gzip
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NoReturn
from unittest.mock import patch

import numpy as np

from stickslip.core.errors import InputError, StickslipError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.structure import shapes
from stickslip.structure.constraints import eliminate
from stickslip.structure.elasticity import assemble_bodies, natural_frequencies
from stickslip.structure.shapes import Rule

LONGEST = 60  # s; a deck that takes longer counts as one that hangs
MOST_NODES = 6000  # of decks whose frequencies are compared
MODES = 10
_NOT_COMPARED = re.compile(
    r"^\*(GAP|SPRING|MPC|DISTRIBUTING|HYPER|USER MATERIAL|DASHPOT|DEFORMATION|MASS|INCLUDE|RIGID BODY, *ELSET)",
    re.IGNORECASE | re.MULTILINE,
)
# Neither program has these in the linear frequencies of an undeformed structure.
_LEFT_OUT = re.compile(
    r"\*(CONTACT|SURFACE (INTERACTION|BEHAVIOR)|FRICTION|GAP (CONDUCTANCE|HEAT)|CLEARANCE|PLASTIC|CREEP|CYCLIC|"
    r"INITIAL CONDITIONS(?!.*TEMPERATURE)|PRE-TENSION|TIE\b.*CYCLIC)",
    re.IGNORECASE,
)
_RIGID = 1e-5  # part of typical frequencies below which a motion is rigid, by round-off
OWN_RULE = shapes._rule
STIFFNESS_RULES = {n_nodes: shapes.stiffness_rule(n_nodes) for n_nodes in (4, 10, 15)}
_TYPES = {"C3D8I": "C3D8", "C3D8R": "C3D8", "C3D20R": "C3D20"}


def main() -> None:
    """Read every deck, and compare frequencies if asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--frequencies", action="store_true", help="also run ccx on decks of solids")
    arguments = parser.parse_args()
    files = sorted([*arguments.folder.glob("*.inp"), *arguments.folder.glob("*.inp.gz")])
    if not files:
        sys.exit(f"{arguments.folder} has no .inp or .inp.gz. Install or unpack the package calculix-ccx-test.")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        decks = [unpacked(each, folder) for each in files]
        models = read_all(decks)
        if arguments.frequencies:
            compare_all(models, folder)


def unpacked(file: Path, folder: Path) -> Path:
    """A copy of a deck, uncompressed."""
    path = folder / file.name.removesuffix(".gz")
    path.write_bytes(gzip.decompress(file.read_bytes()) if file.suffix == ".gz" else file.read_bytes())
    return path


def read_all(decks: list[Path]) -> dict[Path, ImportedModel]:
    """The decks that can be read; prints the numbers and the reasons of the others."""
    models, reasons, seconds = {}, Counter(), []
    signal.signal(signal.SIGALRM, _stop)
    for deck in decks:
        start = time.perf_counter()
        signal.alarm(LONGEST)
        try:
            models[deck] = read_model(deck, "m")
        except StickslipError as error:
            reasons[reason(str(error))] += 1
        except TimeoutError:
            reasons["HANGS"] += 1
            print(f"{deck.name} takes longer than {LONGEST} s")
        signal.alarm(0)
        seconds.append(time.perf_counter() - start)
    tied = sum(model.equations is not None for model in models.values())
    print(f"{len(decks)} decks: {len(models)} read ({tied} with ties), {len(decks) - len(models)} rejected, "
          f"{reasons['HANGS']} hang; longest {max(seconds):.1f} s")  # fmt: skip
    for words, count in reasons.most_common():
        print(f"{count:5d}  {words}")
    return models


def _stop(*_: object) -> NoReturn:
    raise TimeoutError


def reason(sentence: str) -> str:
    """A sentence without its file, line, names and numbers."""
    words = re.sub(r"^.*?\.inp(, line \d+)?: ", "", sentence)
    return re.sub(r"'[^']*'|\b\d+\b", "..", words)[:110]


def compare_all(models: dict[Path, ImportedModel], folder: Path) -> None:
    """Frequencies of the decks of solids by both programs."""
    worst, skipped = [], Counter[str]()
    print("deck, element types, elements, unknowns, largest deviation (with the points of CalculiX), ties")
    for deck, model in models.items():
        text = frequency_deck(deck.read_text(encoding="latin-1"))
        why = obstacle(model, text)
        if not why:
            try:
                off, same_points, unknowns = deviation(text, folder / f"both_{deck.name}")
            except (InputError, subprocess.SubprocessError, IndexError) as error:
                why = f"{type(error).__name__}: {reason(str(error))[-90:]}"
        if why:
            skipped[why] += 1
            print(f"{deck.name:24s} not compared: {why}")
            continue
        types = sorted(set(re.findall(r"(?im)^\*ELEMENT\b.*?TYPE\s*=\s*(\w+)", text)))
        kinds = {name.split(" in ")[0] for name in model.equations.names} if model.equations else set()
        elements = sum(len(block.cells) for block in model.mesh.blocks)
        size = f"{' '.join(types):12s} {elements:5d} {unknowns:6d}"
        print(f"{deck.name:24s} {size}  {off:.1e} % ({same_points:.1e} %)  {', '.join(sorted(kinds))}", flush=True)
        worst.append((off, same_points))
    for words, column in (("", 0), (" with the points of CalculiX", 1)):
        print(f"{len(worst)} decks compared{words}; {sum(each[column] < 0.1 for each in worst)} within 0.1 %")
    for words, count in skipped.most_common():
        print(f"{count:5d}  {words}")


def obstacle(model: ImportedModel, text: str) -> str:
    """Why the frequencies of a deck cannot be compared; empty if they can."""
    if model.mesh.n_nodes > MOST_NODES:
        return "large"
    if "elements are solid" in str(model.doubts):
        return "other elements beside the solids"
    card = _NOT_COMPARED.search(text)
    return f"*{card[1].upper()}" if card else ""


def deviation(text: str, path: Path) -> tuple[float, float, int]:
    """Largest deviations of a frequency from CalculiX (%), with our points and its own, and the unknowns of the model.

    CalculiX gives no frequency if more than a fifth of the unknowns are asked for.
    """
    path.write_text(text, encoding="latin-1")
    temperature = re.search(r"(?im)^\*INITIAL CONDITIONS.*TEMPERATURE.*\n[^,]*,\s*([^,\s]+)", text)
    degrees = None if temperature is None else float(temperature[1])
    own, lowest, unknowns = own_frequencies(path, degrees)
    count = max(1, min(MODES, unknowns // 5))
    path.write_text(text.replace(f"*FREQUENCY\n{MODES}\n", f"*FREQUENCY\n{count}\n"), encoding="latin-1")
    other = other_frequencies(path)[: len(own)]
    own = own[: len(other)]
    elastic = (own > _RIGID * own.max(initial=0.0)) & (own.max(initial=0.0) > lowest)
    if not elastic.any() or not other.any():  # zeros, for the two unknowns of contact1.inp
        raise IndexError("none of the frequencies that ccx gives is one of deformation")
    with patch("stickslip.structure.shapes._rule", calculix_rule):
        same_points = own_frequencies(path, degrees)[0][: len(other)]
    offs = [100.0 * float(np.abs(each[elastic] / other[elastic] - 1.0).max()) for each in (own, same_points)]
    return offs[0], offs[1], unknowns


def calculix_rule(n_nodes: int, degree: int, order: int) -> Rule:
    """Its points, for stiffness and mass alike (tests/formats/test_calculix_deck.py compares the matrices)."""
    if n_nodes == 6:
        along = np.array([[1.0, 1.0, -np.sqrt(3.0)], [1.0, 1.0, np.sqrt(3.0)]]) / 3.0
        return along, np.full(2, 0.5)
    return STIFFNESS_RULES[n_nodes] if n_nodes in STIFFNESS_RULES else OWN_RULE(n_nodes, degree, order)


def frequency_deck(text: str) -> str:
    """The model of a deck with a step of frequencies."""
    text = text.replace("\r", "")
    parts = re.split(r"(?im)^\*STEP\b.*$", text, maxsplit=1)
    model = re.sub(
        r"(?im)(TYPE\s*=\s*)(C3D8R|C3D8I|C3D20R)\b", lambda each: each[1] + _TYPES[each[2].upper()], parts[0]
    )
    cards = re.split(r"(?m)^(?=\*[A-Z])", model, flags=re.IGNORECASE)
    model = "".join(card for card in cards if not _LEFT_OUT.match(card))
    if not re.search(r"(?im)^\*DENSITY", model):
        model = re.sub(r"(?im)^(\*MATERIAL\b.*)$", r"\1\n*DENSITY\n1.", model)
    if len(parts) > 1:
        first = re.split(r"(?im)^\*END STEP", parts[1])[0]
        model += "".join(re.findall(r"(?im)^\*BOUNDARY\b[^*]*", first))
    return f"{model.rstrip()}\n*STEP\n*FREQUENCY\n{MODES}\n*END STEP\n"


def own_frequencies(path: Path, temperature: float | None = None) -> tuple[np.ndarray, float, int]:
    """Hz, of stickslip, the frequency below which a motion is one without strain, and the unknowns."""
    model = read_model(path, "m", temperature=temperature)
    missing = [name for name in model.mesh.body_names if name not in model.materials]
    if missing:
        raise InputError(f"body {missing[0]} has no complete material.")
    fixed = model.fixed_unknowns
    constraints = None if model.equations is None else eliminate(model.equations, fixed)
    materials = [model.materials[name] for name in model.mesh.body_names]
    structure = assemble_bodies(model.mesh, materials, "trilinear", fixed_unknowns=fixed, constraints=constraints)
    count = min(MODES, structure.stiffness.shape[0] - 1)
    if count < 1:
        raise InputError("fewer than two displacements are free.")
    scale = structure.stiffness.diagonal().sum() / structure.mass.diagonal().sum()
    own = natural_frequencies(structure.stiffness, structure.mass, count)[0]
    return own, _RIGID * float(np.sqrt(scale)), structure.stiffness.shape[0]


def other_frequencies(path: Path) -> np.ndarray:
    """Hz, of CalculiX."""
    subprocess.run(
        ["ccx", "-i", path.stem],
        cwd=path.parent,
        check=True,
        capture_output=True,
        timeout=LONGEST,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    text = path.with_suffix(".dat").read_text(encoding="latin-1")
    table = re.findall(r"^\s+\d+" + 4 * r"\s+(\S+)" + r"\s*$", text, flags=re.MULTILINE)
    return np.array([float(row[2]) for row in table[:MODES]])


if __name__ == "__main__":
    main()
