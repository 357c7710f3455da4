"""The snapshot of sentences: which change fails which test, and what --update-sentences writes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sentences import normalised, same

CONFTEST = 'pytest_plugins = ("sentences",)\n'
# Plugins of other packages that the small project does without; they take seconds to load.
QUICK = [
    word for name in ("cacheprovider", "benchmark", "hypothesispytest", "pytest_cov") for word in ("-p", f"no:{name}")
]
PYTEST_INI = "[pytest]\ntestpaths = tests\n"
SOURCE = """
from stickslip.core.errors import ConvergenceError, InputError

def load(value):
    raise InputError(f"the load is {value} N, but it must be above 0 N.", arguments=["load"])

def gap():
    raise InputError("the gap must be 0 m or above.", arguments=["gap"])

def curve():
    raise ConvergenceError("no curve after 17 steps, residual 3.1e-05.")
"""
TESTS = """
import pytest
import joint
from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError, InputError

@pytest.mark.parametrize("value", [0, -1])
def test_load(value):
    with rejects(InputError, "load"):
        joint.load(value)

def test_gap_then_load():
    with rejects(InputError, "gap"):
        joint.gap()
    with rejects(InputError, "load"):
        joint.load(0)

def test_gap():
    with rejects(InputError, "gap"):
        joint.gap()

def test_curve():
    with rejects(ConvergenceError):
        joint.curve()

def test_command():
    printed_sentence("Error: the gap must be 0 m or above.", "gap")
"""


class Project:
    """A small project with tests of its sentences, beside which the snapshot is up to date."""

    def __init__(self, pytester: pytest.Pytester) -> None:
        self.pytester = pytester
        (pytester.path / "pytest.ini").write_text(PYTEST_INI, encoding="utf-8")
        self.tests = pytester.mkdir("tests")
        self.write("conftest.py", CONFTEST)
        self.write("joint.py", SOURCE)
        self.write("test_joint.py", TESTS)
        self.run("--update-sentences").assert_outcomes(passed=6)

    def write(self, name: str, text: str) -> None:
        (self.tests / name).write_text(text, encoding="utf-8")

    def change(self, name: str, old: str, new: str) -> None:
        text = (self.tests / name).read_text(encoding="utf-8")
        assert old in text
        self.write(name, text.replace(old, new))

    def run(self, *arguments: str) -> pytest.RunResult:
        """A run without stored bytecode: two changes within a second would look the same to Python."""
        return self.pytester.runpytest_inprocess(*QUICK, *arguments)

    def snapshot(self) -> dict[str, list[str]]:
        content: dict[str, list[str]] = json.loads((self.tests / "sentences.json").read_text(encoding="utf-8"))
        return content


@pytest.fixture
def project(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Project:
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    return Project(pytester)


@pytest.mark.slow
def test_another_sentence_fails_its_tests_alone_until_it_is_written(project: Project) -> None:
    before = project.snapshot()
    assert before["tests/test_joint.py::test_gap_then_load"] == [
        "the gap must be 0 m or above.",
        "the load is 0 N, but it must be above 0 N.",
    ]
    project.change("joint.py", "the gap must be 0 m or above", "a gap below 0 m is rejected")
    outcome = project.run()
    outcome.assert_outcomes(passed=4, failed=2)
    outcome.stdout.fnmatch_lines(
        [
            "*- the gap must be 0 m or above.*",
            "*+ a gap below 0 m is rejected.*",
            '*pytest --update-sentences "tests/test_joint.py::test_gap_then_load"*',
            "FAILED tests/test_joint.py::test_gap_then_load*",
            "FAILED tests/test_joint.py::test_gap -*",
        ]
    )
    assert project.snapshot() == before
    project.run("--update-sentences").assert_outcomes(passed=6)
    after = project.snapshot()
    assert {name for name in before if before[name] != after[name]} == {
        "tests/test_joint.py::test_gap",
        "tests/test_joint.py::test_gap_then_load",
    }
    project.run().assert_outcomes(passed=6)


@pytest.mark.slow
def test_without_numbers_the_words_are_compared_alone(project: Project) -> None:
    text = 'printed_sentence("Error: the gap must be 0 m or above.", "gap")'
    new = 'printed_sentence("The residual is 3.1e-07 after 17 steps.", "17", numbers=False)'
    project.change("test_joint.py", text, new)
    project.run("--update-sentences").assert_outcomes(passed=6)
    assert project.snapshot()["tests/test_joint.py::test_command"] == ["The residual is <number> after <number> steps."]
    project.change("test_joint.py", "3.1e-07", "-8")
    project.run().assert_outcomes(passed=6)
    project.change("test_joint.py", "after 17", "after 18")  # the key is compared with the numbers
    project.run().assert_outcomes(passed=5, failed=1)
    project.change("test_joint.py", "after 18", "before 17")
    project.run().assert_outcomes(passed=5, failed=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "came"),
    [
        ('arguments=["gap"]', 'arguments=["load"]', "InputError about load came instead of InputError about gap"),
        ('arguments=["gap"]', "arguments=[]", "InputError about no key came instead of InputError about gap"),
        (
            'InputError("the gap',
            'RoughnessError("the gap',
            "RoughnessError about gap came instead of InputError about gap",
        ),
    ],
)
def test_another_key_or_type_fails_also_while_the_snapshot_is_written(
    project: Project, old: str, new: str, came: str
) -> None:
    before = project.snapshot()
    project.change("joint.py", "import ConvergenceError", "import RoughnessError, ConvergenceError")
    project.change("joint.py", old, new)
    for options in ([], ["--update-sentences"]):
        outcome = project.run(*options)
        outcome.assert_outcomes(passed=4, failed=2)
        outcome.stdout.fnmatch_lines([f"*{came}*"])
    assert project.snapshot() == before


@pytest.mark.slow
def test_no_error_fails_also_while_the_snapshot_is_written(project: Project) -> None:
    project.change("joint.py", 'raise InputError("the gap', 'return InputError("the gap')
    outcome = project.run("--update-sentences")
    outcome.assert_outcomes(passed=4, failed=2)
    outcome.stdout.fnmatch_lines(["*DID NOT RAISE*"])


@pytest.mark.slow
def test_a_missing_and_a_left_over_sentence_fail(project: Project) -> None:
    project.change("test_joint.py", "def test_gap():", "def test_other_gap():")
    outcome = project.run()
    outcome.assert_outcomes(passed=5, failed=1)
    outcome.stdout.fnmatch_lines(["*the snapshot has no sentence 1 of this test*"])
    project.change("test_joint.py", '    with rejects(InputError, "load"):\n        joint.load(0)', "    pass")
    outcome = project.run()
    outcome.assert_outcomes(passed=4, failed=2)
    outcome.stdout.fnmatch_lines(["*the snapshot has 2 sentences of this test, but it came to 1*"])


@pytest.mark.slow
def test_only_the_whole_suite_drops_tests_that_are_gone(project: Project) -> None:
    project.change("test_joint.py", "def test_gap():", "def test_other_gap():")
    project.run("--update-sentences", "tests/test_joint.py").assert_outcomes(passed=6)
    assert len(project.snapshot()) == 7
    project.run("--update-sentences", "-k", "curve").assert_outcomes(passed=1, deselected=5)
    assert "tests/test_joint.py::test_gap" not in project.snapshot()
    assert len(project.snapshot()) == 6


@pytest.mark.slow
def test_a_file_that_is_left_out_has_its_sentences(project: Project) -> None:
    before = project.snapshot()
    project.change("test_joint.py", "import pytest\n", 'import pytest\npytest.importorskip("no_such_program")\n')
    project.write("test_other.py", "def test_nothing():\n    pass\n")
    project.run("--update-sentences").assert_outcomes(passed=1, skipped=1)
    assert project.snapshot() == before


@pytest.mark.slow
def test_a_test_that_rejects_nothing_any_more_leaves_the_snapshot(project: Project) -> None:
    project.change("test_joint.py", 'printed_sentence("Error: the gap must be 0 m or above.", "gap")', "pass")
    project.run("--update-sentences").assert_outcomes(passed=6)
    assert "tests/test_joint.py::test_command" not in project.snapshot()


@pytest.mark.slow
def test_several_processes_may_read_but_not_write(project: Project) -> None:
    outcome = project.run("-n", "1", "--update-sentences")
    outcome.stderr.fnmatch_lines(["*--update-sentences writes one file, so it needs one process. Leave -n out.*"])
    assert outcome.ret == pytest.ExitCode.USAGE_ERROR


@pytest.mark.slow
def test_numbers_may_be_rounded_otherwise_but_not_be_others(project: Project) -> None:
    """An iteration ends with other numbers on another machine."""
    project.change("joint.py", "17 steps, residual 3.1e-05", "18 steps, residual 7.7e-06")
    project.run().assert_outcomes(passed=6)
    assert project.snapshot()["tests/test_joint.py::test_curve"] == [
        "no curve after <number> steps, residual <number>."
    ]
    assert same("up to 1.37 mm at 3 nodes", "up to 1.38 mm at 3 nodes")
    assert not same("up to 1.37 mm at 3 nodes", "up to 1.47 mm at 3 nodes")
    assert not same("up to 1.37 mm at 3 nodes", "up to 1.37 mm at 4 nodes")
    assert not same("up to 1.37 mm at 3 nodes", "up to 1.37 m at 3 nodes")


def test_what_differs_between_machines_is_not_in_the_snapshot(tmp_path: Path) -> None:
    text = (
        f'"{tmp_path}/a.toml", process 312, tcp://127.0.0.1:4242, 0x7f0011223344, {"ab" * 32}, tmpa1b2c3d4, 3 MB free'
    )
    expected = '"<folder>/a.toml", process <number>, tcp://<address>, <address>, <digest>, <name>, <number> MB free'
    assert normalised(text, tmp_path.parent) == expected


@pytest.mark.slow
def test_words_of_python_are_not_in_the_snapshot(project: Project) -> None:
    project.write(
        "test_words.py",
        """
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.validation import finite_array, real_number

def test_words():
    with rejects(InputError, "x"):
        finite_array("x", "two")
    with rejects(InputError, "y"):
        real_number("y", "2.5")
""",
    )
    project.run("--update-sentences", "tests/test_words.py").assert_outcomes(passed=1)
    assert project.snapshot()["tests/test_words.py::test_words"] == [
        "x must contain real numbers, but the conversion fails: <words of ValueError>.",
        "y is '2.5', but it must be one number, without a unit.",
    ]
