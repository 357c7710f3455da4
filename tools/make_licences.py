"""Writes docs/licences.md: the installed packages of the project with their licences.

python tools/make_licences.py       (in an environment with the versions of constraints.txt)
"""

from __future__ import annotations

import re

from packages import ROOT, installed, licence, requirements

TARGET = ROOT / "docs" / "licences.md"
_HEAD = """# Licences of the packages that are installed with stickslip

stickslip itself has the BSD licence with three clauses (file `LICENSE`). This page lists the licence of each package
of the default installation, without extras and development tools. The licences come from the metadata of the versions
in `constraints.txt`. `tools/make_licences.py` writes this page, and a test compares it with the installed packages.

None of these packages has the GPL or AGPL licence, and none has the LGPL licence itself. Some wheels contain compiled
libraries with such a licence, according to their licence files. Anyone who passes an installation on also passes these
libraries on:

| package | library in its wheel | licence |
|---|---|---|
"""
_TABLE = """
| package | licence |
|---|---|
"""
# Entries of the licence files that the wheels of NumPy and SciPy carry: name, some lines, licence.
_BUNDLED = re.compile(r"^Name: (?P<name>.+)\n(?:(?!Name: ).*\n)*?License: (?P<licence>.*GPL.*)$", re.MULTILINE)


def bundled() -> list[tuple[str, str, str]]:
    """Package, library and licence of every library under a licence of the GPL family that a wheel says to contain."""
    rows = []
    for package in installed(requirements()).values():
        for file in package.files or ():
            if file.name.startswith("LICENSE") and ".dist-info" in str(file):
                found = _BUNDLED.findall(file.read_text(encoding="utf-8"))
                rows += [(package.metadata["Name"], name, words) for name, words in found]
    return sorted(rows)


def table() -> str:
    """The whole page."""
    rows = [(package.metadata["Name"], licence(package)) for package in installed(requirements()).values()]
    libraries = "".join(f"| {package} | {name} | {words} |\n" for package, name, words in bundled())
    own = "".join(f"| {name} | {words} |\n" for name, words in sorted(rows, key=lambda row: row[0].lower()))
    return f"{_HEAD}{libraries}{_TABLE}{own}"


if __name__ == "__main__":
    TARGET.write_text(table(), encoding="utf-8")
    print(f"Wrote {TARGET}")
