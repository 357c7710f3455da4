import pytest

import stickslip as ss
from sentences import rejects

TABLE = [(20.0, 210e9), (220.0, 200e9), (620.0, 160e9)]


def test_straight_between_rows() -> None:
    assert [ss.modulus_at(t, TABLE) for t in (20.0, 120.0, 420.0, 620.0)] == pytest.approx([210e9, 205e9, 180e9, 160e9])


def test_bad_tables_and_temperatures() -> None:
    for table in ([(20.0, 1e9)], TABLE[::-1], [(20.0, 210e9), (600.0, -1.0)]):
        with rejects(ss.InputError, "table"):
            ss.modulus_at(20.0, table)
    with rejects(ss.InputError, "temperature_c"):
        ss.modulus_at(700.0, TABLE)
