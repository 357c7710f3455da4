"""A joint at rest that wears: its pairs with any depths of wear, from the static equilibrium (docs/theory_wear.md)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.solve.static.ramp_to_rest import static_preload
from stickslip.structure.superelement import Superelement

# chosen: stiffness that depends on the load is iterated until it changes by less than this fraction.
SETTLED = 1e-6
MOST_ITERATIONS = 100  # chosen: half steps in the logarithm need about 20
# Stiffness (normal, tangential) in N/m of pairs under normal forces (n_pairs,) N, worn by depths (n_pairs,) m.
WornStiffness = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True)
class WornJoint:
    """A joint of Coulomb pairs at rest. ``pairs`` are those without wear; ``stiffness`` None keeps their springs."""

    superelement: Superelement
    pairs: ContactPairs
    stiffness: WornStiffness | None = None

    def pairs_after(self, depth: FloatArray) -> ContactPairs:
        """The pairs about the state at rest with worn depths (n_pairs,) m. Raises ConvergenceError without one."""
        law, loads = self.pairs.coulomb, np.maximum(self.pairs.preload, 0.0)
        if self.stiffness is None:
            return self._at_rest(depth, law.normal_stiffness, law.tangential_stiffness)
        normal, tangential = self.stiffness(loads, depth)
        for _ in range(MOST_ITERATIONS):
            pairs = self._at_rest(depth, normal, tangential)
            loads = np.maximum(pairs.preload, 0.0)
            wanted = self.stiffness(loads, depth)
            if max(np.abs(np.log(wanted[0] / normal)).max(), np.abs(np.log(wanted[1] / tangential)).max()) <= SETTLED:
                return pairs
            # Half a step in the logarithm: with the pressure of each pair a full step would overshoot.
            normal, tangential = np.sqrt(normal * wanted[0]), np.sqrt(tangential * wanted[1])
        raise ConvergenceError(
            f"the stiffness of the worn pairs under their own load did not converge in {MOST_ITERATIONS} iterations."
        )

    def _at_rest(self, depth: FloatArray, normal: FloatArray, tangential: FloatArray) -> ContactPairs:
        """The pairs with these springs (normal (n_pairs,), tangential, N/m).

        Displacements count from the rest without wear. A pair that is closed there has its load at zero displacement
        whatever its spring: running in alone moves no load. An open one keeps its gap, in m.
        """
        preload = self.pairs.preload
        loads, gaps = np.maximum(preload, 0.0), np.maximum(-preload, 0.0) / self.pairs.coulomb.normal_stiffness
        unloaded = ContactPairs(
            self.pairs.operator,
            normal,
            tangential,
            self.pairs.coulomb.friction_coefficient,
            loads - normal * (gaps + depth),
        )
        # The load of the joint without wear: the displacement is then zero.
        load = self.pairs.operator[2::3].T @ loads
        return static_preload(self.superelement, unloaded, load, friction=False).about(unloaded, keep_traction=False)
