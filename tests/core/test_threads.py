"""How many threads: given, from the environment, or the usable cores; and work shared among them."""

from __future__ import annotations

import threading

import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.thread_variables import require_thread_variables
from stickslip.core.threads import (
    FEWEST_ROWS,
    MOST_BY_DEFAULT,
    blas_threads,
    in_threads,
    thread_count,
    usable_cores,
)


def test_the_argument_wins_over_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STICKSLIP_THREADS", "3")
    assert thread_count() == 3
    assert thread_count(2) == 2
    monkeypatch.delenv("STICKSLIP_THREADS")
    assert thread_count() == min(MOST_BY_DEFAULT, usable_cores())


@pytest.mark.parametrize("text", ["0", "-1", "two", "1.5"])
def test_an_environment_that_makes_no_sense_is_rejected(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STICKSLIP_THREADS", text)
    with rejects(InputError):
        thread_count()


@pytest.mark.parametrize("variable", ["STICKSLIP_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS"])
@pytest.mark.parametrize("text", ["0", "-1", "two", "1.5", "1025", "9" * 5000, "1,2,0"])
def test_every_variable_of_threads_is_checked(variable: str, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(variable, text)
    with rejects(InputError) as error:
        require_thread_variables()
    assert len(str(error.value)) < 250


def test_usual_variables_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", "64")
    monkeypatch.setenv("OMP_NUM_THREADS", "4, 2")  # for work inside work
    monkeypatch.setenv("STICKSLIP_THREADS", "")
    require_thread_variables()


@pytest.mark.parametrize("threads", [0, -2, 1.5, True, 1025, 10**9])
def test_a_count_that_makes_no_sense_is_rejected(threads: int) -> None:
    with rejects(InputError, "threads"):
        thread_count(threads)


@pytest.mark.parametrize("threads", [1, 3])
def test_every_item_is_worked_on_once(threads: int) -> None:
    done: list[int] = []
    names: set[str] = set()

    def work(item: int) -> None:
        done.append(item)
        names.add(threading.current_thread().name)

    in_threads(work, range(40), threads)
    assert sorted(done) == list(range(40))
    assert all(name.startswith("stickslip") for name in names) == (threads > 1)


def test_an_error_in_a_thread_is_raised() -> None:
    with pytest.raises(ZeroDivisionError):
        in_threads(lambda item: item // 0, [1, 2], 2)


def test_small_products_get_one_thread() -> None:
    assert blas_threads(FEWEST_ROWS - 1, 4) == 1
    assert blas_threads(FEWEST_ROWS, 4) == 4
