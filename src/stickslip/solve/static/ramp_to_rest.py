"""The state at rest under a static load: unilateral contact with friction, reached by a load ramp.

    K u + B^T f = load,   N = N(closure) >= 0,   |T| <= mu N,   closure = B_n u - gap

Friction depends on the history: the load grows in steps from zero, and in each the traction follows the friction law
from the last step (:mod:`stickslip.solve.static.load_ramp`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.normal_law import NormalLaw, SpringLaw
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray, finite_array, whole_number
from stickslip.solve.static.load_ramp import LoadRamp
from stickslip.solve.static.state import StaticState
from stickslip.structure.superelement import Superelement

# chosen: local stiffness is iterated until normal forces and stiffness change by less than this fraction of the
# largest.
STIFFNESS_TOLERANCE = 1e-4
STIFFNESS_ITERATIONS = 200  # chosen: half steps in the logarithm need about 15
# chosen: with gaps the number of load steps is multiplied by MORE_STEPS, up to MOST_STEPS, until no traction changes by
# more than this fraction of the largest limit.
PATH_TOLERANCE = 0.01
MORE_STEPS, MOST_STEPS = 4, 64

# Normal and tangential stiffness (n_pairs,) of pairs under normal forces (n_pairs,).
LocalStiffness = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def static_preload(
    superelement: Superelement,
    pairs: ContactPairs,
    load: ArrayLike,
    *,
    friction: bool = True,
    local_stiffness: LocalStiffness | None = None,
    normal_law: NormalLaw | None = None,
    steps: int = 4,
    progress: ProgressCallback | None = None,
) -> StaticState:
    """Normal forces, gaps, tractions and states of the pairs under a static load that grows from zero.

    Parameters
    ----------
    superelement:
        the structure; only its stiffness matters. Bodies that contact alone supports may be free.
    pairs:
        the joint before the load, with any laws: ``preload`` of Coulomb pairs is 0 for pairs that just touch,
        ``-k_n gap`` with a gap, above 0 with an interference, and their tangential stiffness is equal in both
        directions.
    load:
        (n,) N; it may be zero where an interference presses.
    friction:
        False gives the state without traction, the rest state of released sliders: Jenkins elements and Iwan joints
        carry nothing along t1 and t2 either, elastic laws carry their own force.
    local_stiffness:
        optional: the stiffness of each pair as a function of its own normal force, iterated until both agree.
    normal_law:
        a law instead of springs, such as :class:`PressureGapLaw`; ``local_stiffness`` then sets the tangential springs
        alone. The gaps are those of ``pairs``. Both are for joints of Coulomb pairs alone.
    steps:
        initial number of load steps; a step that does not converge is shortened. Pairs with a gap, an interference, a
        pressure-gap law or a law beside Coulomb friction slip along curved paths, so with friction the number is
        multiplied by four until no traction changes by more than 1 % of the largest friction limit, up to 64; the
        message gives the last change.

    Raises
    ------
    InputError
        for a wrong shape, a load of zero, unequal tangential springs, a traction that pairs keep already, or a
        stiffness law on pairs of other laws.
    ConvergenceError
        if there is no equilibrium; the message gives the fraction of the load that the joint carried.
    """
    force = _checked_load(load, superelement, pairs)
    steps = whole_number("steps", steps, 1)
    listener = progress or (lambda fraction, detail: None)
    if local_stiffness is not None or normal_law is not None:
        _ = pairs.coulomb  # raises InputError for other laws
    gap = _gap(pairs)
    law = normal_law
    ramp = LoadRamp(superelement, pairs, force, law, gap, friction)
    state = ramp.run(steps)
    others = pairs.law_names != (CoulombLaw.name,) and pairs.frictional().any()
    bent = friction and (gap.any() or normal_law is not None or others)
    if bent:
        state, steps, path = _refined_steps(ramp, pairs, state, steps)
    if local_stiffness is None:
        return replace(state, message=state.message + (path if bent else ""))
    for iteration in range(STIFFNESS_ITERATIONS):
        listener(iteration / STIFFNESS_ITERATIONS, f"local stiffness, iteration {iteration + 1}")
        normal, tangential = local_stiffness(state.normal_force)
        # Half a step in the logarithm: stiffness is nearly proportional to the load, and a full step would overshoot.
        normal = np.sqrt(normal * state.normal_stiffness) if normal_law is None else state.normal_stiffness
        tangential = np.sqrt(tangential * state.tangential_stiffness)
        local = ContactPairs(pairs.operator, normal, tangential, pairs.friction_coefficient, -normal * gap)
        previous = state
        law = normal_law or SpringLaw(normal)
        ramp = LoadRamp(superelement, local, force, law, gap, friction)
        state = ramp.run(steps)
        # The stiffness too: forces that equilibrium alone determines do not show whether it satisfies its law.
        change = max(
            _change(state.normal_force, previous.normal_force),
            _change(state.normal_stiffness, previous.normal_stiffness) if normal_law is None else 0.0,
            _change(state.tangential_stiffness, previous.tangential_stiffness),
        )
        if change <= STIFFNESS_TOLERANCE:
            words = f" Local stiffness after {iteration + 1} iterations."
            if bent:
                state, _, path = _refined_steps(ramp, pairs, state, steps)
                words = path + words
            return replace(state, message=state.message + words)
    raise ConvergenceError(
        f"the stiffness of the pairs under their own pressure did not converge in {STIFFNESS_ITERATIONS} iterations; "
        f"the normal forces or stiffness still change by {change:.1e} of the largest. Use a pressure-gap law, or one "
        "stiffness for each face."
    )


def _gap(pairs: ContactPairs) -> FloatArray:
    """(n_pairs,) m of Coulomb pairs, negative for an interference; 0 for others."""
    gap = np.zeros(pairs.n_pairs)
    for law, members in zip(pairs.laws, pairs.members, strict=True):
        if isinstance(law, CoulombLaw):
            gap[members] = -law.offset_force / law.normal_stiffness
    return gap


def _limits(pairs: ContactPairs, state: StaticState) -> FloatArray:
    """(n_pairs,) N, the largest traction of each pair in a state."""
    limits = pairs.largest_slip_force.copy()
    for law, members in zip(pairs.laws, pairs.members, strict=True):
        if isinstance(law, CoulombLaw):
            limits[members] = law.friction_coefficient * state.normal_force[members]
    return limits


def _change(new: FloatArray, old: FloatArray) -> float:
    """Largest change as a fraction of the largest value."""
    return float(np.abs(new - old).max() / max(old.max(), 1e-300))


def _refined_steps(ramp: LoadRamp, pairs: ContactPairs, state: StaticState, steps: int) -> tuple[StaticState, int, str]:
    """The state from a number of load steps above which its tractions do not change, this number, and a sentence on
    it."""
    while True:
        finer = ramp.run(MORE_STEPS * steps)
        limit = max(float(_limits(pairs, finer).max()), 1e-300)
        change = float(np.abs(finer.traction - state.traction).max()) / limit
        state, steps = finer, MORE_STEPS * steps
        if change <= PATH_TOLERANCE or MORE_STEPS * steps > MOST_STEPS:
            sentence = f" Tractions change by {100.0 * change:.2g} % of the largest friction limit"
            return state, steps, f"{sentence} when the load steps become {MORE_STEPS} times as many."


def _checked_load(load: ArrayLike, superelement: Superelement, pairs: ContactPairs) -> FloatArray:
    force = finite_array("load", load)
    if force.shape != (superelement.size,):
        raise InputError(
            f"load must have shape ({superelement.size},), N on each unknown, but its shape is {force.shape}.",
            arguments=["load"],
        )
    if not force.any() and not (_gap(pairs) < 0.0).any():
        raise InputError(
            "load is zero everywhere, so nothing presses the pairs together. Give a static load.", arguments=["load"]
        )
    if pairs.operator.shape[1] != superelement.size:
        raise InputError(
            f"operator has {pairs.operator.shape[1]} columns, but the superelement has {superelement.size} unknowns.",
            arguments=["operator"],
        )
    if not pairs.released:
        raise InputError(
            "some pairs already have a traction at rest (residual_traction or path_to_rest), but a static load grows "
            "from a joint without traction. Give static_preload the pairs before any load."
        )
    springs = pairs.tangential_springs
    unequal = np.flatnonzero((springs[:, 0] != springs[:, 1]) & ~np.isnan(springs[:, 0]))
    if unequal.size:
        raise InputError(
            f"tangential_stiffness[{unequal[0]}] differs along t1 and t2; a static load ramp requires pairs that are "
            "equally stiff in both directions.",
            arguments=["tangential_stiffness"],
        )
    return force
