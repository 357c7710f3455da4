"""Compiled functions where numba finds no place for their code: a read-only installation and home."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sentences import printed_sentence

CODE = """
import sys
from stickslip.contact.law import coulomb_kernel as friction_kernel
from stickslip.contact.stiffness import surface
import numba
print(numba.config.CACHE_DIR)
from stickslip.solve.transient.kernel import mean_inverse
"""
# numba takes only the folder that the user names then: the installation and the home are as if they were read-only
READ_ONLY = {"NUMBA_CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator"}


def run(temporary: Path, code: str = CODE, **more: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **READ_ONLY, "TMPDIR": str(temporary), **more}
    environment.pop("NUMBA_CACHE_DIR", None)
    return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "getuid"), reason="folders of Windows have no owner's number")
def test_code_is_kept_among_the_temporary_files_and_that_is_reported_once(tmp_path: Path) -> None:
    done = run(tmp_path)
    folder = tmp_path / f"stickslip-numba-{os.getuid()}"
    assert done.stdout.strip() == str(folder), done.stderr
    (warning,) = re.findall(r"StickslipWarning: (.*)", done.stderr)
    printed_sentence(warning, "NUMBA_CACHE_DIR", str(folder))
    assert folder.stat().st_mode & 0o777 == 0o700
    assert run(tmp_path).stdout == done.stdout  # the next run finds the code of the first


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "getuid"), reason="folders of Windows have no owner's number")
def test_a_folder_that_others_can_write_is_not_trusted(tmp_path: Path) -> None:
    folder = tmp_path / f"stickslip-numba-{os.getuid()}"
    folder.mkdir()
    folder.chmod(0o777)
    retained = Path(run(tmp_path).stdout.strip())
    assert retained.parent == tmp_path
    assert retained != folder
    assert retained.stat().st_mode & 0o077 == 0


@pytest.mark.slow
def test_without_any_folder_the_code_is_compiled_each_time(tmp_path: Path) -> None:
    code = "import tempfile; tempfile._candidate_tempdir_list = lambda: []\n" + CODE
    done = run(tmp_path, code)
    assert done.returncode == 0, done.stderr
    (warning,) = re.findall(r"StickslipWarning: (.*)", done.stderr)
    printed_sentence(warning, "NUMBA_CACHE_DIR")


@pytest.mark.slow
def test_a_number_of_threads_that_makes_no_sense_is_reported_before_numba_meets_it(tmp_path: Path) -> None:
    done = run(tmp_path, NUMBA_NUM_THREADS="0")
    (error,) = re.findall(r"InputError: (.*)", done.stderr)
    printed_sentence(error, "NUMBA_NUM_THREADS")
