"""A mesh whose joint never slips and that nothing loads at rest: all stresses are proportional to the force."""

from __future__ import annotations

from own_cases import EXAMPLE
from stickslip.case.case import Case

FORCE = "forces.push.amplitude"
JOINT = """\
law = "jenkins"
tangential_stiffness = "4e6 N/m"
normal_stiffness = "5e6 N/m"
[interfaces.{name}.constants]
friction_limit = "1 MN"
"""


def linear_mesh_case() -> Case:
    """The example of an own mesh, its friction replaced by springs that slip at 1 MN, around its first resonance."""
    head, _, rest = (EXAMPLE / "study.toml").read_text(encoding="utf-8").partition("[forces.push]")
    own = head.partition("[interfaces.sole]")[0].replace('file = "', f'file = "{EXAMPLE.as_posix()}/')
    sole = '[interfaces.sole]\nfirst = "damper_bottom"\nsecond = "beam_top"\n' + JOINT.format(name="sole")
    lid = '[interfaces.lid]\nfirst = "damper_top"\nsecond = "ground"\n' + JOINT.format(name="lid")
    tail = rest.partition("[roughness]")[0] + "[reduction]" + rest.partition("[reduction]")[2]
    case = Case.from_text(f"{own}{sole}{lid}[forces.push]{tail}")
    window = {"solver.frequency_start": "2380 Hz", "solver.frequency_stop": "2420 Hz"}
    return case.replace(
        {**window, "solver.accuracy": None, "solver.harmonics": 1, "solver.samples": 64, "output.figure_formats": []}
    )
