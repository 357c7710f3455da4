"""Fixtures that all tests share."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from helpers import Blade

pytest_plugins = ("pytester", "sentences", "structure_fixtures")


@pytest.fixture(scope="session", autouse=True)
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Tests keep reduced structures in a folder of their own; commands that they start inherit it."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STICKSLIP_CACHE", str(folder))
        yield folder


@pytest.fixture(scope="session")
def blade() -> Blade:
    """The bench problem with ten contacts."""
    return Blade()
