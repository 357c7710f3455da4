"""Studies with laws of other packages, and what reports, results files and sweeps hold of other laws."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from law_studies import JOINT, REST, interface_text, write_masses, write_study
from sentences import rejects
from stickslip.results.storage import load_results
from stickslip.study.check import check

PACKAGE = '''
from dataclasses import dataclass, field
from typing import ClassVar
import numpy as np
import stickslip as ss

@dataclass(frozen=True, kw_only=True)
class Glue(ss.ElasticLaw):
    """A spring along t1, t2, n that grows with the normal load of the pair."""
    name: ClassVar[str] = "glue"
    states: ClassVar = {ss.ContactState.STUCK: "glued"}
    normal_load: np.ndarray = None  # a default hides the property of ElasticLaw
    per_load: float = field(metadata=ss.constant("1/m"))
    bond: np.ndarray = field(default=0.0, metadata=ss.constant("N/m", of_face=True))

    @property
    def n_pairs(self):
        return len(self.normal_load)

    def resting_springs(self):
        springs = self.bond + self.per_load * self.normal_load
        return np.repeat(springs[:, None], 3, axis=1)

    def force_and_slope(self, displacement):
        springs = self.resting_springs()[:, :, None]
        return springs * displacement, springs + 0.0 * displacement

@dataclass(frozen=True, kw_only=True)
class Undeclared(Glue):
    thickness: float

@dataclass(frozen=True)
class Power:
    scale: float
    exponent: float

    def normal(self, pressure):
        return self.scale * pressure**self.exponent

    def tangential(self, pressure):
        return 0.5 * self.normal(pressure)

    def valid(self, pressure):
        return ("the power law is far from home.",) if (pressure > 1e4).any() else ()

    def describe(self):
        return "power"
'''
ENTRIES = """\
[stickslip.contact_laws]
glue = gluepackage:Glue
undeclared = gluepackage:Undeclared
[stickslip.stiffness_laws]
power = gluepackage:Power
"""
CODE = """\
import sys
sys.path.insert(0, {folder!r})
import numpy as np, stickslip as ss
case = ss.load_case({study!r})
pairs = ss.build_model(case).pairs
print(pairs.law_names, pairs.resting_stiffness().tolist())
solution = ss.solve_case(case)
print(solution.converged, solution.response.pairs.state_names, solution.record.warnings)
try:
    case.replace({{"interfaces.mass1.law": "undeclared"}})
except ss.StudyFileError as error:
    print(error)
"""


@pytest.mark.long
def test_laws_of_another_package_serve_a_study(tmp_path: Path) -> None:
    (tmp_path / "gluepackage.py").write_text(PACKAGE, encoding="utf-8")
    information = tmp_path / "gluepackage-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: gluepackage\nVersion: 1.0\n", encoding="utf-8")
    (information / "entry_points.txt").write_text(ENTRIES, encoding="utf-8")
    write_masses(tmp_path, 2)
    glue = f'[interfaces.mass1]\nfirst = "mass1"\nsecond = "ground"\n{JOINT}normal_load = "3 N"\nlaw = "glue"\n'
    glue += '[interfaces.mass1.constants]\nper_load = "2 1/mm"\nbond = "1 kN/m"\n'
    power = f'[interfaces.mass2]\nfirst = "mass2"\nsecond = "ground"\n{JOINT}normal_load = "4 N"\n'
    power += 'stiffness_law = "power"\n[interfaces.mass2.stiffness_constants]\nscale = 1e6\nexponent = 0.5\n'
    study = write_study(tmp_path, glue, power)
    code = CODE.format(folder=str(tmp_path), study=str(study))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    springs, outcome, *rejected = done.stdout.splitlines()
    normal = 1e-4 * 1e6 * (4.0 / 1e-4) ** 0.5  # area, scale, pressure: 20 kN/m
    assert springs.startswith("('coulomb', 'glue')")
    numbers = json.loads(springs[springs.index("[") :])
    np.testing.assert_allclose(numbers, [7e3] * 3 + [0.5 * normal, 0.5 * normal, normal], rtol=1e-14)
    assert outcome.startswith("True")
    assert "glued" in outcome
    assert "mass2: the power law is far from home." in outcome
    assert "can be used from Python only: it does not declare its constant thickness" in "\n".join(rejected)


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Two masses, an Iwan joint and dry friction, with all files."""
    folder = tmp_path_factory.mktemp("study")
    write_masses(folder, 2)
    text = [interface_text(name, law, name) for name, law in (("mass1", "coulomb"), ("mass2", "iwan"))]
    case = ss.load_case(write_study(folder, *text))
    ss.run(case, folder / "out")
    return case, folder / "out"


@pytest.mark.slow
def test_a_results_file_holds_law_and_constants_with_units(outcome: Any) -> None:
    import h5py

    saved = load_results(outcome[1] / "results.nc")
    assert saved.response.pairs.law_names == ("coulomb", "iwan")
    assert saved.study is not None
    assert "[interfaces.mass2.constants]" in saved.study.inputs
    with h5py.File(outcome[1] / "results.nc") as file:
        group = file["pairs/law_1"]
        units = {
            name: group[f"constant_{name}"].attrs["units"] for name in ("slip_force", "exponent", "normal_stiffness")
        }
    assert units == {"slip_force": "N", "exponent": "1", "normal_stiffness": "N/m"}


@pytest.mark.slow
def test_a_page_has_no_constants_of_friction_for_other_laws(outcome: Any) -> None:
    text = (outcome[1] / "report.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="page-data">(.*?)</script>', text, flags=re.DOTALL).group(1))  # type: ignore[union-attr]
    assert data["coulomb"] == [1, 0]
    assert [data["lawStates"][law][0] for law in data["lawOfPair"]] == ["stuck", "at rest"]
    assert data["loops"]["normalPairs"] == 1
    assert "NaN" not in json.dumps(data)
    assert "with contact" in text
    assert 'id="rough-map"' not in text  # no face follows from [roughness]


@pytest.mark.slow
def test_check_shows_the_law_of_a_face(outcome: Any) -> None:
    rows = dict(row for _, section in check(outcome[0]) for row in section)
    assert rows["Contact law, mass2"] == "iwan"
    assert rows["Stiffness of small motions along t1, mass2"] == "1e+04 N/m"
    assert rows["Slip force, mass2"] == "4 N"
    assert "first natural frequencies, contact stuck" in rows


@pytest.mark.long
def test_a_sweep_of_a_constant(outcome: Any, tmp_path: Path) -> None:
    result = ss.sweep(outcome[0], {"interfaces.mass2.constants.slip_force": "2 N,8 N"}, out=tmp_path, workers=1)
    assert [row.values for row in result.table.rows] == [(2.0,), (8.0,)]
    assert all(row.converged for row in result.table.rows)


@pytest.mark.slow
def test_what_only_the_joint_knows_is_rejected_before_anything_is_solved(tmp_path: Path) -> None:
    write_masses(tmp_path)
    text = interface_text("joint", "elastic-stop").replace('gap = "0.3 mm"\n', "")
    with rejects(ss.InputError, "interfaces.joint.gap") as error:
        ss.build_model(ss.load_case(write_study(tmp_path, text)))
    assert error.value.keys == ("interfaces.joint.gap",)


def test_a_prescribed_load_of_a_pair_that_takes_none_is_rejected(tmp_path: Path) -> None:
    write_masses(tmp_path, 2)
    text = [interface_text(name, law, name) for name, law in (("mass1", "coulomb"), ("mass2", "iwan"))]
    text[0] = text[0].replace('normal_load = "3 N"\n', "")
    for values, actual in (([3.0, 0.0], True), ([3.0, 1.0], False)):
        case = ss.load_case(write_study(tmp_path, *text, rest=f"[preload]\nvalues = {values}\n{REST}"))
        if actual:
            assert ss.build_model(case).pairs.normal_load.tolist() == values
            continue
        with rejects(ss.InputError, "preload.values"):
            ss.build_model(case)
