import pytest

from matrix_writers import small_model


@pytest.fixture(scope="session")
def small(make_block):
    """Stiffness, mass, positions of two free bricks."""
    return small_model(make_block)
