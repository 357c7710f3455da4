"""Which packages an installed project needs, by the metadata of what is installed, and under which licence each is."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]


def plain(name: str) -> str:
    """The name of a package as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def pins() -> dict[str, str]:
    """Plain name -> version of constraints.txt."""
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    found = [line.split("==") for line in lines if not line.startswith("#")]
    return {plain(name): version for name, version in found}


def requirements(dev: bool = False, extras: bool = False) -> list[str]:
    """Requirements of the project in pyproject.toml, of its group dev and of all extras where these are wanted."""
    data = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    answer = list(data["project"]["dependencies"])
    answer += _group(data["dependency-groups"], "dev") if dev else []
    answer += [each for extra in data["project"]["optional-dependencies"].values() for each in extra] if extras else []
    return answer


def _group(groups: dict[str, list[str | dict[str, str]]], name: str) -> list[str]:
    """Requirements of a dependency group and of those that it includes (PEP 735)."""
    answer = []
    for each in groups[name]:
        answer += [each] if isinstance(each, str) else _group(groups, each["include-group"])
    return answer


def installed(wanted: Iterable[str]) -> dict[str, Distribution]:
    """Plain name -> package of all that the requirements need, directly or not; those not installed are left out."""
    found: dict[str, Distribution] = {}
    waiting = [Requirement(each) for each in wanted]
    seen: set[tuple[str, frozenset[str]]] = set()
    while waiting:
        requirement = waiting.pop()
        key = plain(requirement.name), frozenset(requirement.extras)
        if key in seen:
            continue
        seen.add(key)
        try:
            package = distribution(requirement.name)
        except PackageNotFoundError:
            continue
        found[key[0]] = package
        for text in package.requires or ():
            needed = Requirement(text)
            extras = requirement.extras or {""}
            if needed.marker is None or any(needed.marker.evaluate({"extra": extra}) for extra in extras):
                waiting.append(needed)
    return found


def licence(package: Distribution) -> str:
    """What a package's metadata state: the expression, else the classifiers, else the first line of the text."""
    data = package.metadata
    expression = data.get("License-Expression")
    if expression:
        return expression
    classifiers = [line for line in data.get_all("Classifier") or () if line.startswith("License ::")]
    names = [line.rpartition(" :: ")[2] for line in classifiers if not line.endswith("OSI Approved")]
    if names:
        return ", ".join(names)
    return (data.get("License") or "").strip().partition("\n")[0] or "not stated"
