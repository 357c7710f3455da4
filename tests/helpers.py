"""Shared by the tests: the bench problem with ten contacts, and skipping for absent tools (which CI forbids)."""

from __future__ import annotations

import importlib
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.structure.superelement import Superelement

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
BROWSER_ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
EXAMPLE_DATA = Path(__file__).parents[1] / "examples" / "data"
BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


class Blade:
    """The bench problem with ten contacts: a reduced, pre-twisted blade with a platform on friction contacts."""

    def __init__(self) -> None:
        with np.load(EXAMPLE_DATA / "blade_10_contacts.npz") as data:
            arrays = {name: data[name] for name in data.files}
        self.n_pairs = int(arrays["Nc"])
        size = arrays["M"].shape[0]
        self.superelement = Superelement(arrays["M"], arrays["K"], arrays["C"])
        self.operator = np.eye(size)[: 3 * self.n_pairs]
        self._constants = [float(arrays[name]) for name in ("kn", "kt", "mu")]
        self.pairs = self.pairs_with(arrays["N0"])
        self.force_cos, self.force_sin = arrays["F1c"], arrays["F1s"]
        self.tip = arrays["resp"]
        self.window_hz = (float(arrays["w_lo"]) / (2 * np.pi), float(arrays["w_hi"]) / (2 * np.pi))
        self.free_hz, self.stuck_hz = float(arrays["f_free"]), float(arrays["f_stuck"])

    def response(self, **options: Any) -> ForcedResponse:
        """Its forced response under the reference force."""
        return forced_response(self.superelement, self.pairs, self.force_cos, self.force_sin, **options)

    def pairs_with(self, preload: np.ndarray) -> ContactPairs:
        """The contacts with another preload."""
        return ContactPairs(self.operator, *self._constants, preload)  # type: ignore[call-arg]


def benchmark_module(name: str) -> Any:
    """A module of benchmarks/, which is no package."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(BENCHMARKS))
        return importlib.import_module(name)


def unmeasured() -> dict[str, str]:
    """Environment for a process that a test kills, or whose files it limits. Without the variables it records no
    coverage: half a record would be a damaged file, about which the report of the coverage warns."""
    return {name: value for name, value in os.environ.items() if not name.startswith("COVERAGE_PROCESS_")}


def matched(pattern: str, text: str, flags: int = 0) -> re.Match[str]:
    """The first match of a pattern in a text; the test fails if there is none."""
    match = re.search(pattern, text, flags)
    assert match is not None, f"{pattern} is not in {text[:200]}"
    return match


def absent_tool(name: str, advice: str) -> NoReturn:
    """Skip the test because ``name`` is not installed; in CI (STICKSLIP_REQUIRE_TOOLS) fail instead."""
    sentence = f"{name} is not installed: {advice}"
    if os.environ.get("STICKSLIP_REQUIRE_TOOLS"):
        pytest.fail(sentence)
    pytest.skip(sentence)


@contextmanager
def opened_browser() -> Iterator[Any]:
    """A Chromium without network; skips the test where none is installed."""
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        absent_tool("chromium", "none of " + ", ".join(BROWSERS) + " is on the path (apt-get install chromium).")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=program, args=BROWSER_ARGUMENTS)
        yield opened
        opened.close()
