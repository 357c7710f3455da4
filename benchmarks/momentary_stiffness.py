"""Peak with a contact stiffness that follows the momentary pressure, against constant springs; in time as a check.

OMP_NUM_THREADS=1 python benchmarks/momentary_stiffness.py
"""

from __future__ import annotations

import numpy as np
from blade_problem import BladeProblem, load_blade_problem

import stickslip as ss
from stickslip.results.peaks import peaks

CONTACTS, HARMONICS, SAMPLES = 10, 7, 256
STEPS, PERIODS = 500, 60


def joints(blade: BladeProblem) -> dict[str, ss.ContactPairs]:
    """The bench blade with each law; the stiffness at rest is the same."""
    one, loads = np.ones(blade.n_contacts), blade.preload
    springs = blade.normal_stiffness * one, blade.tangential_stiffness * one
    friction = blade.friction_coefficient * one
    laws: tuple[ss.ContactLaw, ...] = (
        ss.CoulombLaw(*springs, friction, loads, np.zeros_like(loads)),
        ss.ExponentialContact(*springs, friction, loads),
    )
    return {law.name: ss.ContactPairs.with_laws(blade.contact_operator(), [law]) for law in laws}


def main() -> None:
    """Print the peaks."""
    blade = load_blade_problem(CONTACTS)
    structure = ss.Superelement(blade.mass, blade.stiffness, blade.damping)
    force = ss.Excitation.force(blade.force_cos, blade.force_sin)
    for name, pairs in joints(blade).items():
        curve = ss.forced_response(
            structure, pairs, force, frequency_hz=blade.window_hz, harmonics=HARMONICS, samples=SAMPLES
        )
        whole = peaks(curve.frequency_hz, curve.amplitude(blade.output))[0]
        first = peaks(curve.frequency_hz, curve.harmonic_amplitude(blade.output, 1))[0]
        print(
            f"{name}: first harmonic {1e6 * first.amplitude:.1f} um at {first.frequency_hz:.1f} Hz, 0-to-peak "
            f"{1e6 * whole.amplitude:.1f} um at {whole.frequency_hz:.1f} Hz, states {curve.contact_state[whole.point]}"
        )
        start = ss.start_from_response(curve, whole.point)
        march = ss.integrate_to_steady_state(
            structure, pairs, blade.force_cos, blade.force_sin, curve.frequency_hz[whole.point], STEPS, PERIODS, 1e-5,
            **start,
        )  # fmt: skip
        amplitude = march.amplitude(blade.output)
        difference = 100.0 * (amplitude / curve.amplitude(blade.output)[whole.point] - 1.0)
        print(f"  in time at this point: {1e6 * amplitude:.1f} um, {difference:+.2f} %, settled: {march.converged}")


if __name__ == "__main__":
    main()
