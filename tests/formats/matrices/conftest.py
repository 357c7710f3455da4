from collections.abc import Callable

import numpy as np
import pytest

from matrix_writers import small_model
from stickslip.structure.mesh import Mesh


@pytest.fixture(scope="session")
def small(make_block: Callable[..., Mesh]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, mass, positions of two free bricks."""
    return small_model(make_block)
