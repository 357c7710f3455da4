"""Fixtures that all tests share."""

from __future__ import annotations

import pytest

from helpers import Blade


@pytest.fixture(scope="session")
def blade() -> Blade:
    """The bench problem with ten contacts."""
    return Blade()
