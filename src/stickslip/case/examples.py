"""The studies that ``stickslip new`` writes, one for each kind of structure."""

from __future__ import annotations

from typing import Any

_BODY = {"young_modulus": "210 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
# Machined faces, written out: an own joint has no default roughness.
_ROUGHNESS = {"sq": "1 um", "sample_length": "0.8 mm"}
RESOLUTION = {"accuracy": "0.5 %"}
_SOLVER = {"frequency_start": "100 Hz", "frequency_stop": "1000 Hz", **RESOLUTION}
EXAMPLES: dict[str, dict[str, Any]] = {
    # Its contact stiffness is uncertain by a factor 3; a finer accuracy takes several times as long.
    "two-blade": {"solver": {"accuracy": "2 %"}},
    "mesh": {
        "study": {"title": "My structure"},
        "structure": {"kind": "mesh", "file": "model.inp", "length_unit": "mm", "fixed": ["root"]},
        "material": _BODY,
        "roughness": _ROUGHNESS,
        "bodies": {"lower": {"density": "8200 kg/m^3"}},
        "interfaces": {
            "lap": {"first": "upper_contact", "second": "lower_contact", "normal_load": "290 N"},
            "support": {"first": "lower_back", "second": "ground", "normal_load": "100 N", "friction": 0.2},
        },
        "forces": {"shaker": {"set": "tip", "direction": [1, 0, 0], "amplitude": "10 N"}},
        "responses": {"tip": {"point": ["0 mm", "0 mm", "145 mm"], "direction": [1, 0, 0]}},
        "solver": _SOLVER,
    },
    "bladed-disk": {
        "study": {"title": "Tuned disk of 24 blades with wedge dampers"},
        "structure": {"kind": "cyclic"},
        "material": {"young_modulus": "197 GPa", "poisson_ratio": 0.3, "density": "7800 kg/m^3"},
        "roughness": _ROUGHNESS,
        "interfaces": {
            "own platform": {"first": "damper here", "second": "platform right", "normal_load": "900 N"},
            "next platform": {"first": "damper ahead", "second": "next platform left", "normal_load": "900 N"},
        },
        "travelling_wave": {"engine_order": 4},
        "forces": {"gas": {"set": "tip", "direction": [0, 1, 0], "amplitude": "0.5 N"}},
        "responses": {
            "tip": {"set": "tip", "direction": [0, 1, 0]},
            "damper": {"set": "damper middle", "direction": [1, 0, 0]},
        },
        "solver": {"frequency_start": "560 Hz", "frequency_stop": "610 Hz", "accuracy": "2 %"},
    },
    "matrices": {
        "study": {"title": "My matrices"},
        "structure": {"kind": "matrices", "file": "superelement.npz"},
        "material": _BODY,
        "roughness": _ROUGHNESS,
        "interfaces": {
            "lap": {
                "first": "upper_contact",
                "second": "lower_contact",
                "normal": [0, 0, 1],
                "area": "180 mm^2",
                "normal_load": "290 N",
            }
        },
        "forces": {"shaker": {"node": 1, "direction": [1, 0, 0], "amplitude": "10 N"}},
        "responses": {"tip": {"node": 2, "direction": [1, 0, 0]}},
        "solver": _SOLVER,
    },
}
