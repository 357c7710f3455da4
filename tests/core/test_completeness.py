"""Results that are not complete are reported at once."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import pytest

from sentences import printed_sentence, rejects
from stickslip.core.completeness import reported
from stickslip.core.errors import ConvergenceError, NotConvergedWarning


@dataclass
class Result:
    """An end of something."""

    converged: bool
    message: str = "The step became too small at 482 Hz."


def test_a_complete_result_is_returned_in_silence() -> None:
    result = Result(converged=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert reported(result, True) is reported(result, False) is result


def test_an_incomplete_result_warns_at_the_line_of_the_caller_or_raises() -> None:
    result = Result(converged=False)

    def solver(raise_on_failure: bool) -> Result:
        return reported(result, raise_on_failure)

    with pytest.warns(NotConvergedWarning) as caught:
        assert solver(False) is result
    assert caught[0].filename == __file__
    printed_sentence(str(caught[0].message))
    with rejects(ConvergenceError):
        solver(True)
