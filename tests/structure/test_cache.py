"""Reduced structures on disk: taken where nothing changed, computed where anything did."""

from __future__ import annotations

import os
import shutil
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from damage import damaged
from sentences import printed_sentence
from stickslip.core.errors import StickslipWarning
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.structure import cache
from stickslip.structure.cache import cache_folder, cached_superelement
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Material, Structure, assemble
from stickslip.structure.superelement import Superelement

COARSE = BladePairElements(
    shank_columns=1, shank_rows=2, platform_rows=1, airfoil_rows=2, inner_columns=1, contact_columns=1, chordwise=1,
    beyond_damper=1, damper_columns=2, damper_flank_rows=1,
)  # fmt: skip


class Counted:
    """A reduction that counts how often it is asked for."""

    def __init__(self, structure: Structure, nodes: np.ndarray, n_modes: int) -> None:
        self.structure, self.nodes, self.n_modes, self.calls = structure, nodes, n_modes, 0

    def __call__(self) -> Superelement:
        self.calls += 1
        return craig_bampton(self.structure, self.nodes, self.n_modes)

    def cached(self) -> Superelement:
        return cached_superelement(self.structure, self.nodes, self.n_modes, self)


@pytest.fixture
def reduction(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Counted:
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "kept"))
    structure = assemble(blade_pair_mesh(BladePairGeometry(), COARSE), Material(200e9, 0.3, 7800.0))
    damper = [structure.mesh.node_sets[name] for name in ("damper_left_face", "damper_right_face")]
    return Counted(structure, np.unique(np.concatenate(damper)), 4)


def test_second_call_reads_the_same_numbers(reduction: Counted) -> None:
    first, second = reduction.cached(), reduction.cached()
    assert reduction.calls == 1
    for name in ("mass", "stiffness", "boundary_nodes"):
        assert np.array_equal(getattr(first, name), getattr(second, name))
    motion = np.random.default_rng(0).normal(size=(first.size, 2))
    assert np.array_equal(first.recovery @ motion, second.recovery @ motion)


@pytest.mark.slow
def test_any_change_computes_again(reduction: Counted) -> None:
    reduction.cached()
    structure = reduction.structure
    heavier = Counted(replace(structure, mass=structure.mass * 1.001), reduction.nodes, 4)
    fewer_nodes = Counted(structure, reduction.nodes[:-1], 4)
    more_modes = Counted(structure, reduction.nodes, 5)
    for changed in (heavier, fewer_nodes, more_modes):
        changed.cached()
        assert changed.calls == 1


def test_changed_code_computes_again(reduction: Counted, monkeypatch: pytest.MonkeyPatch) -> None:
    reduction.cached()
    monkeypatch.setattr(cache, "_code", lambda: b"another version")
    reduction.cached()
    assert reduction.calls == 2


def test_changed_code_in_a_sub_folder_is_changed_code(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    shutil.copytree(Path(cache.__file__).parent, tmp_path / "structure")
    monkeypatch.setattr(cache, "__file__", str(tmp_path / "structure" / "cache.py"))
    code = cache._code.__wrapped__
    before = code()
    (tmp_path / "structure" / "inner").mkdir()
    (tmp_path / "structure" / "inner" / "elements.py").write_text("# new\n", encoding="utf-8")
    assert code() != before


def kept_file() -> Path:
    folder = cache_folder()
    assert folder is not None
    (file,) = folder.iterdir()
    return file


def test_damaged_file_is_named_and_made_again(reduction: Counted) -> None:
    first = reduction.cached()
    file = kept_file()
    whole = file.read_bytes()
    place = whole.index(first.stiffness.tobytes()[:64])
    file.write_bytes(whole[:place] + np.nextafter(first.stiffness[0, 0], 0.0).tobytes() + whole[place + 8 :])
    with pytest.warns(StickslipWarning) as reported:
        again = reduction.cached()
    printed_sentence("\n".join(str(each.message) for each in reported), str(file))
    assert reduction.calls == 2
    assert np.array_equal(again.stiffness, first.stiffness)
    reduction.cached()  # without a warning, which would be an error
    assert reduction.calls == 2


@pytest.mark.slow
def test_no_damage_gives_numbers_or_a_fault(reduction: Counted) -> None:
    reduction.cached()
    file = kept_file()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StickslipWarning)
        for what, content in damaged(file.read_bytes(), 150):
            file.write_bytes(content)
            assert cache._read(file) is None, what


@pytest.mark.slow
def test_a_file_under_the_name_of_another_is_not_taken(reduction: Counted) -> None:
    reduction.cached()
    first = kept_file()
    more_modes = Counted(reduction.structure, reduction.nodes, 5)
    more_modes.cached()
    folder = cache_folder()
    assert folder is not None
    (second,) = set(folder.iterdir()) - {first}
    shutil.copy(first, second)
    with pytest.warns(StickslipWarning) as caught:
        assert more_modes.cached().size == reduction.cached().size + 1
    printed_sentence("\n".join(str(each.message) for each in caught))
    assert (more_modes.calls, reduction.calls) == (2, 1)


@pytest.mark.slow
def test_a_file_that_cannot_be_read_is_reported(reduction: Counted) -> None:
    reduction.cached()
    file = kept_file()
    file.unlink()
    file.mkdir()
    with pytest.warns(StickslipWarning) as caught:
        reduction.cached()
    printed_sentence("\n".join(str(each.message) for each in caught))
    assert reduction.calls == 2


def test_off_keeps_nothing(reduction: Counted, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(cache.VARIABLE, "off")
    reduction.cached()
    reduction.cached()
    assert reduction.calls == 2
    assert not (tmp_path / "kept").exists()


def test_folder_that_cannot_be_made_is_no_error(
    reduction: Counted, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("not a folder", encoding="utf-8")
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "file"))
    reduction.cached()
    assert reduction.calls == 1


def test_oldest_files_give_way(reduction: Counted, monkeypatch: pytest.MonkeyPatch) -> None:
    reduction.cached()
    folder = cache_folder()
    assert folder is not None
    (old,) = folder.iterdir()
    os.utime(old, (1.0, 1.0))
    monkeypatch.setattr(cache, "LARGEST_FOLDER", int(1.5 * old.stat().st_size))
    Counted(reduction.structure, reduction.nodes, 3).cached()
    assert not old.exists()
    assert len(list(folder.iterdir())) == 1


def test_default_folder_is_the_users(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(cache.VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", "/somewhere")
    assert cache_folder() == Path("/somewhere/stickslip")


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="the path of other systems")
def test_what_earlier_versions_kept_on_linux_stays_in_use(monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in (cache.VARIABLE, "XDG_CACHE_HOME"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("HOME", "/home/user")
    assert cache_folder() == Path("/home/user/.cache/stickslip")
