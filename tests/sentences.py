"""Errors are matched by type and keys here; their sentences stand in one snapshot, ``tests/sentences.json``.

``with rejects(InputError, "interfaces.joint.normal_load"):`` fails unless exactly this type of error comes, about
exactly these keys, with the sentence that the snapshot has for the test. ``printed_sentence(text)`` compares what a
command prints, and warnings and messages of results. ``pytest --update-sentences`` writes the sentences of the tests
that ran; a reviewer reads the diff.
"""

from __future__ import annotations

import difflib
import dis
import json
import os
import platform
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Generic, TypeVar

import pytest

import stickslip
from stickslip.core.errors import ConvergenceError, StickslipError

Rejection = TypeVar("Rejection", bound=StickslipError)

PACKAGE = Path(stickslip.__file__).parent
REPOSITORY = Path(__file__).resolve().parents[1]
TOLERANCE = 0.01  # between numbers with a decimal point: two machines may round the third digit differently
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
# What differs from run to run, and the word that stands for it in the snapshot.
_VARYING = (
    (re.compile(r"\bprocess \d+"), "process <number>"),
    (re.compile(r"\b[\d.]+ MB free"), "<number> MB free"),
    (re.compile(r"\bhas [\d.]+ [kM]B\b"), "has <size>"),  # of a file that HDF5 or a compression wrote
    (re.compile(r"(tcp|tls)://[\w.]+:\d+"), r"\1://<address>"),
    (re.compile(r"\btmp[a-z0-9_]{8}\b"), "<name>"),
    (re.compile(r"_[0-9a-f]{12}\b"), "_<digest>"),  # of a case of a sweep: it contains the code of the package
    (re.compile(r"\b0x[0-9a-f]{8,}"), "<address>"),
    (re.compile(r"\b[0-9a-f]{32,}\b"), "<digest>"),
    (re.compile(r"[\w.+]+ \(code [0-9a-f]{8,}\)"), "<version>"),
    (re.compile(rf"\bstickslip {re.escape(stickslip.__version__)}\b"), "stickslip <version>"),
)


def rejects(kind: type[Rejection], *keys: str) -> _Rejects[Rejection]:
    """The code inside raises an error of exactly this type, about exactly these keys or arguments, with the sentence of
    the snapshot."""
    return _Rejects(kind, keys)


class _Rejects(Generic[Rejection]):
    """A class, because a generator would show the code of contextlib where a test fails."""

    def __init__(self, kind: type[Rejection], keys: Sequence[str]) -> None:
        self._kind, self._keys, self._raises = kind, tuple(keys), pytest.raises(kind)

    def __enter__(self) -> pytest.ExceptionInfo[Rejection]:
        self._caught = self._raises.__enter__()
        return self._caught

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool:
        __tracebackhide__ = True
        if not self._raises.__exit__(kind, error, trace):
            return False
        came = self._caught.value
        found = tuple(getattr(came, "keys", ()))
        if (type(came), found) != (self._kind, self._keys):
            what = f"{type(came).__name__} about {_listed(found)}"
            pytest.fail(f"{what} came instead of {self._kind.__name__} about {_listed(self._keys)}: {came}")
        text = _without_words_of_others(came)
        _running().compare(text, numbers=not isinstance(came, ConvergenceError))
        return True


def printed_sentence(text: str, *keys: str, numbers: bool = True) -> None:
    """A command printed ``text``, or a result has it; it names each of ``keys`` and is the one of the snapshot.

    ``numbers=False`` compares the words only: the numbers differ from machine to machine, as round-off does, or from
    run to run.
    """
    __tracebackhide__ = True
    missing = [key for key in keys if key not in text]
    if missing:
        pytest.fail(f"the sentence does not name {_listed(missing)}: {text}")
    _running().compare(text, numbers)


def _listed(keys: Sequence[str]) -> str:
    return ", ".join(keys) or "no key"


def _without_words_of_others(error: BaseException) -> str:
    """The sentence of an error without the words of Python and of other packages, which change with their version."""
    text, cause = str(error), error
    while following := cause.__cause__ or cause.__context__:
        cause = following
        words = getattr(cause, "strerror", None) or str(cause)
        for part in (words, " ".join(words.split())):
            if len(part) > 3 and not _is_own(cause):
                text = text.replace(part, f"<words of {type(cause).__name__}>")
    return text


def _is_own(error: BaseException) -> bool:
    """Whether a ``raise`` of this package made the error; one of compiled code ends in this package as well."""
    if isinstance(error, StickslipError):
        return True
    last: TracebackType | None = error.__traceback__
    while last is not None and last.tb_next is not None:
        last = last.tb_next
    if last is None or not Path(last.tb_frame.f_code.co_filename).is_relative_to(PACKAGE):
        return False
    return last.tb_frame.f_code.co_code[last.tb_lasti] == dis.opmap["RAISE_VARARGS"]


# --- the snapshot


@dataclass
class _Test:
    """A test that runs, and its sentences."""

    name: str
    stored: Sequence[str]
    folder: Path  # temporary folders of this run
    updates: bool
    found: list[str] = field(default_factory=list)

    def compare(self, text: str, numbers: bool = True) -> None:
        """The next sentence of the test; its words only, without ``numbers``."""
        __tracebackhide__ = True
        sentence = normalised(text, self.folder)
        if not numbers:
            sentence = _NUMBER.sub("<number>", sentence)
        if self.found and same(self.found[-1], sentence):
            return  # tests that try every byte of a file have one entry
        place = len(self.found)
        stored = self.stored[place] if place < len(self.stored) else None
        agrees = stored is not None and same(stored, sentence)
        self.found.append(stored if stored is not None and agrees else sentence)
        if agrees or self.updates:
            return
        if stored is None:
            pytest.fail(
                f"the snapshot has no sentence {place + 1} of this test, which is:\n{sentence}\n{self.advice()}"
            )
        lines = difflib.ndiff(stored.splitlines(), sentence.splitlines())
        diff = "\n".join(line.rstrip("\n") for line in lines)
        pytest.fail(f"the sentence is not the one of the snapshot (-):\n{diff}\n{self.advice()}")

    def require_all(self) -> None:
        """Fail if the snapshot has more sentences than the test."""
        if len(self.found) < len(self.stored) and not self.updates:
            pytest.fail(
                f"the snapshot has {len(self.stored)} sentences of this test, but it came to {len(self.found)}. "
                f"{self.advice()}",
                pytrace=False,
            )

    def advice(self) -> str:
        return f'If the new sentence is right: pytest --update-sentences "{self.name}", and read the diff.'


@dataclass
class _Session:
    """The snapshot as the file has it, and what the tests of this run change."""

    path: Path
    updates: bool
    stored: dict[str, list[str]]
    collected: set[str] = field(default_factory=set)
    fresh: dict[str, list[str]] = field(default_factory=dict)

    def write(self, is_whole: bool) -> None:
        """The file with the sentences of the tests that ran; after the whole suite without tests that are gone."""
        content = {name: found for name, found in {**self.stored, **self.fresh}.items() if found}
        if is_whole:
            root = self.path.parents[1]
            files = {name.partition("::")[0] for name in self.collected}
            # a file that was left out as a whole, for want of another program, still has its tests
            left_out = {file for name in content if (file := name.partition("::")[0]) not in files}
            left_out = {file for file in left_out if (root / file).exists()}
            content = {
                name: found
                for name, found in content.items()
                if name in self.collected or name.partition("::")[0] in left_out
            }
        self.path.write_text(json.dumps(content, indent=1, ensure_ascii=False, sort_keys=True) + "\n", encoding="utf-8")


_SESSION = pytest.StashKey[_Session]()
_tests: list[_Test] = []  # the one that runs last; a test of this module runs others inside


def _running() -> _Test:
    return _tests[-1]


def same(stored: str, found: str) -> bool:
    """Whether two sentences have the same words, and the same numbers but for the rounding of those with a point."""
    if _NUMBER.split(stored) != _NUMBER.split(found):
        return False
    pairs = zip(_NUMBER.findall(stored), _NUMBER.findall(found), strict=True)
    return all(one == other or _is_rounded(one, other) for one, other in pairs)


def _is_rounded(one: str, other: str) -> bool:
    if not any(mark in number for number in (one, other) for mark in ".e"):
        return False
    values = float(one), float(other)
    return abs(values[0] - values[1]) <= TOLERANCE * max(map(abs, values))


def normalised(text: str, folder: Path) -> str:
    """``text`` as it is on every machine: names of temporary folders, processes, addresses and versions are words."""
    text = text.encode("utf-8", "backslashreplace").decode()
    for place in dict.fromkeys((str(folder), str(folder.resolve()))):
        text = re.sub(rf"{re.escape(place)}[\\/][^\\/\s\"']+", "<folder>", text)
    for place, word in ((str(REPOSITORY), "<repository>"), (sys.prefix, "<python>"), (platform.node(), "<machine>")):
        text = re.sub(rf"(?<!\w){re.escape(place)}(?!\w)", word, text) if place else text
    for pattern, word in _VARYING:
        text = pattern.sub(word, text)
    return text.replace(os.sep, "/")


# --- hooks of pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-sentences", action="store_true", help="write the sentences of the tests that run to the snapshot"
    )


def pytest_configure(config: pytest.Config) -> None:
    updates = bool(config.getoption("--update-sentences"))
    if updates and (hasattr(config, "workerinput") or config.getoption("numprocesses", None)):
        raise pytest.UsageError("--update-sentences writes one file, so it needs one process. Leave -n out.")
    path = config.rootpath / "tests" / "sentences.json"
    stored = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    config.stash[_SESSION] = _Session(path, updates, stored)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    config.stash[_SESSION].collected.update(item.nodeid for item in items)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    session = item.config.stash[_SESSION]
    folder: Path = item.config._tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]
    test = _Test(item.nodeid, session.stored.get(item.nodeid, ()), folder, session.updates)
    _tests.append(test)
    try:
        result = yield
        test.require_all()
    finally:
        _tests.pop()
    session.fresh[item.nodeid] = test.found
    return result


def pytest_sessionfinish(session: pytest.Session) -> None:
    own = session.config.stash[_SESSION]
    if not own.updates or not own.collected:
        return
    values = {Path(argument).resolve() for argument in session.config.args}
    whole = {(session.config.rootpath / place).resolve() for place in session.config.getini("testpaths")}
    has_errors = session.exitstatus in (pytest.ExitCode.INTERRUPTED, pytest.ExitCode.INTERNAL_ERROR)
    own.write(is_whole=whole <= values and not has_errors)
