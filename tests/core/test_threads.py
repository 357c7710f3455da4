"""How many threads: given, from the environment, or the usable cores; and work shared among them."""

from __future__ import annotations

import threading

import pytest
from threadpoolctl import threadpool_info

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.thread_variables import require_thread_variables
from stickslip.core.threads import (
    LARGE_MATRIX,
    MOST_BY_DEFAULT,
    in_shares,
    in_threads,
    library_threads,
    side_by_side,
    single_library_thread,
    solver_threads,
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
    def divide(item: int) -> None:
        _ = item // 0

    with pytest.raises(ZeroDivisionError):
        in_threads(divide, [1, 2], 2)


def threads_of_library() -> set[int]:
    """The numbers of threads of the linear algebra libraries."""
    return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}


def test_a_solver_has_one_thread_in_the_library_but_for_a_large_matrix() -> None:
    with solver_threads(2):
        assert threads_of_library() == {1}
        with library_threads(LARGE_MATRIX - 1):
            assert threads_of_library() == {1}
        with library_threads(LARGE_MATRIX):
            assert threads_of_library() == {2}
        assert threads_of_library() == {1}


def test_small_matrices_outside_of_a_solver_can_have_one_thread_in_the_library() -> None:
    usual = threads_of_library()
    with single_library_thread(LARGE_MATRIX - 1):
        assert threads_of_library() == {1}
    with single_library_thread(LARGE_MATRIX):
        assert threads_of_library() == usual


def test_a_solver_with_one_thread_has_one_for_a_large_matrix_too() -> None:
    with solver_threads(1), library_threads(LARGE_MATRIX):
        assert threads_of_library() == {1}


def test_a_share_has_one_thread_in_the_library() -> None:
    found: list[set[int]] = []

    def look(start: int, stop: int) -> None:
        with library_threads(LARGE_MATRIX):
            found.append(threads_of_library())

    with solver_threads(2):
        in_shares(look, 4, 1)
    assert found == 4 * [{1}]


def shares_of(count: int, least: int) -> list[tuple[int, int, str]]:
    """The shares of a division, in their order, and the thread that worked on each."""
    shares: list[tuple[int, int, str]] = []
    in_shares(lambda start, stop: shares.append((start, stop, threading.current_thread().name)), count, least)
    return sorted(shares)


@pytest.mark.parametrize("count", [20, 21, 29, 500])
def test_shares_contain_every_item_once(count: int) -> None:
    with solver_threads(3):
        shares = shares_of(count, 10)
    assert [start for start, _, _ in shares] == list(range(0, count, 10))
    assert [stop for _, stop, _ in shares] == [*range(10, count, 10), count]


@pytest.mark.parametrize(("count", "threads"), [(19, 2), (500, 1)])
def test_what_is_not_worth_a_second_thread_is_one_call(count: int, threads: int) -> None:
    with solver_threads(threads):
        assert [share[:2] for share in shares_of(count, 10)] == [(0, count)]


def test_without_a_solver_there_is_one_call() -> None:
    assert [share[:2] for share in shares_of(100, 10)] == [(0, 100)]


def test_two_threads_work_at_the_same_time() -> None:
    together = threading.Barrier(2, timeout=30.0)

    def meet(start: int, stop: int) -> None:
        together.wait()

    with solver_threads(2):
        in_shares(meet, 2, 1)


def test_a_share_of_a_share_is_not_divided() -> None:
    inner: list[tuple[int, int]] = []

    def divide(start: int, stop: int) -> None:
        in_shares(lambda first, last: inner.append((first, last)), 100, 10)

    with solver_threads(2):
        in_shares(divide, 4, 1)
    assert inner == 4 * [(0, 100)]


def test_an_error_of_a_share_arrives() -> None:
    def fail(start: int, stop: int) -> None:
        if start == 7:
            raise ZeroDivisionError

    with solver_threads(2), pytest.raises(ZeroDivisionError):
        in_shares(fail, 20, 1)


def test_no_share_begins_after_an_error_has_arrived() -> None:
    begun: list[int] = []

    def fail(start: int, stop: int) -> None:
        begun.append(start)
        raise ZeroDivisionError

    with solver_threads(2):
        with pytest.raises(ZeroDivisionError):
            in_shares(fail, 1000, 1)
        count = len(begun)
        assert count <= 2
        in_shares(lambda start, stop: None, 4, 1)
    assert len(begun) == count


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_tasks_side_by_side_answer_in_their_order(threads: int) -> None:
    with solver_threads(threads):
        assert side_by_side([lambda i=i: i for i in range(7)], pytest.fail) == list(range(7))  # type: ignore[misc]


def test_two_tasks_run_at_the_same_time_and_their_loops_are_divided() -> None:
    together = threading.Barrier(2, timeout=30.0)
    found: list[list[tuple[int, int, str]]] = []

    def task() -> None:
        together.wait()
        found.append(shares_of(100, 10))

    with solver_threads(2):
        side_by_side([task, task], pytest.fail)
    for shares in found:  # by whoever is free
        assert sum(stop - start for start, stop, _ in shares) == 100


@pytest.mark.parametrize("failing", [0, 1])
def test_an_error_of_a_task_stops_the_others(failing: int) -> None:
    stopped = threading.Event()

    def fail() -> None:
        raise ZeroDivisionError

    def wait() -> None:
        if failing == 0:  # an error in this thread stops those that run
            assert stopped.wait(30.0)

    tasks = [wait, wait]
    tasks[failing] = fail
    with solver_threads(2):
        with pytest.raises(ZeroDivisionError):
            side_by_side(tasks, stopped.set)
        assert stopped.is_set()
        assert side_by_side([lambda: 1, lambda: 2], pytest.fail) == [1, 2]
