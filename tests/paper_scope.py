"""A very coarse paper study of some twenty curves, for the tests of its whole path."""

from __future__ import annotations

from stickslip.papers.rough_damper.plan import CHOICES, Choice, Scope
from sweep_cases import QUICK

_KEPT = {key: value for key, value in QUICK.items() if key.split(".")[0] in ("mesh", "reduction", "geometry")}
CHANGES = {**_KEPT, "solver.harmonics": 1, "solver.samples": 64, "solver.largest_step": 0.15}


def coarse_scope() -> Scope:
    """One run of three D and three G, one roughness in the unloading mode, one changed choice."""
    friction = next(choice for choice in CHOICES if choice.name == "friction coefficient")
    return Scope(
        dimensions=(2.35, 2.4, 2.49),
        scales=(1e-8, 1e-9, 1e-10),
        short_dimensions=(2.4,),
        short_scales=(1e-9,),
        runs=((5.0, 100.0),),
        extra=((2.2, 1e-8, "unloading"),),
        choices=(Choice(friction.name, friction.key, friction.base, (0.5,), friction.reason),),
        changes=CHANGES,
    )
