"""Writes requirements-hashed.txt: the packages of the project and of the group dev with the hashes of their files.

python tools/make_hashes.py       (Linux x86-64, CPython 3.11; asks the package index)

The hashes are those of the files that pip takes here. Check them against the public index before committing:
pip --isolated install --dry-run --ignore-installed --require-hashes -r requirements-hashed.txt
"""

from __future__ import annotations

import json
import subprocess
import sys

from packages import ROOT

TARGET = ROOT / "requirements-hashed.txt"
_HEAD = """# The packages of the project and of the group dev with hashes of their files (Linux x86-64, CPython 3.11):
#   pip install --require-hashes -r requirements-hashed.txt
#   pip install --no-deps --constraint constraints.txt --build-constraint constraints.txt --editable .
# Hashes cannot stand in constraints.txt: pip then wants one of everything, and an editable project has no file to hash.
# Written by tools/make_hashes.py.
"""


def hashed() -> str:
    """The whole file. Raises CalledProcessError where pip finds no set of packages."""
    command = [
        *(sys.executable, "-m", "pip", "install", "--quiet", "--dry-run", "--ignore-installed", "--report", "-"),
        *("--constraint", "constraints.txt", "--group", "dev", "--editable", "."),
    ]
    done = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    lines = []
    for each in json.loads(done.stdout)["install"]:
        source = each["download_info"]
        if "archive_info" in source:  # the project itself has none
            digest = source["archive_info"]["hashes"]["sha256"]
            lines.append(f"{each['metadata']['name']}=={each['metadata']['version']} --hash=sha256:{digest}\n")
    return _HEAD + "".join(sorted(lines, key=str.lower))


if __name__ == "__main__":
    TARGET.write_text(hashed(), encoding="utf-8")
    print(f"Wrote {TARGET}")
