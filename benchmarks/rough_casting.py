"""The two blades with the faces of a rough casting, whose numbers the documentation of the solver has."""

from pathlib import Path

import stickslip as ss


def rough_casting() -> ss.Case:
    """The case of examples/rough_casting.toml."""
    return ss.load_case(Path(__file__).resolve().parents[1] / "examples" / "rough_casting.toml")
