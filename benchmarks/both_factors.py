"""One measurement with each factor, each in a process of its own, so that its peak memory is its own."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from typing import cast

from stickslip.structure.factor import Backend


def with_each_factor(script: str, measure: Callable[[Backend], dict[str, float | str]]) -> None:
    """Print a list of what ``measure`` of a script finds, for the factors on the command line or for both."""
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(cast(Backend, sys.argv[2]))))
        return
    for backend in sys.argv[1:] or ["pardiso", "superlu"]:
        command = [sys.executable, script, "--one", backend]
        answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        for name, value in json.loads(answer.splitlines()[-1]).items():
            print(f"{name:<40} {value if isinstance(value, str) else format(value, '.4g')}", flush=True)
        print()
