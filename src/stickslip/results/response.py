"""The result of a forced-response run as labelled data: amplitudes, signals, contact states and energies.

Displacements are Fourier coefficients in the order mean, cos 1, sin 1, cos 2, sin 2, ...:
``u(t) = c_0 + sum_k c_k cos(k w t) + s_k sin(k w t)``, ``w = 2 pi f``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.core.resolution import Resolution
from stickslip.core.validation import FloatArray, require_choice
from stickslip.results.curve_figure import OTHER_CURVES, STIFFNESS_CURVES, TRACTION_CURVES, AmplitudeCurve
from stickslip.results.linear_curves import points_between
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.results.periodic_motions import CURVE, PAIRS
from stickslip.results.response_data import ResponseData
from stickslip.results.side_curves import SideCurve
from stickslip.results.sweeps_of_curve import Jump, SlowSweep, one_run, solid_words, stable_between_folds, sweeps
from stickslip.results.variables import Numbers, WholeNumbers

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from stickslip.contact.law.coulomb_harmonics import Update
    from stickslip.contact.law.law import ContactCycle


@dataclass(frozen=True, eq=False)
class ForcedResponse(ResponseData):
    """Forced response along a curve of ``n_points`` points, in the order of the curve.

    The curve may fold, so ``frequency_hz`` need not rise; neighbours in the index are neighbours on the curve.

    Parameters
    ----------
    frequency_hz:
        (n_points,) Hz.
    displacement:
        (n_points, n, 2 * harmonics + 1) m, coefficients mean, cos 1, sin 1, ...
    contact_state:
        (n_points, n_pairs) codes of :class:`stickslip.ContactState`: 0 stuck, 1 stick-slip, 2 separating.
    dissipated_energy:
        (n_points, n_pairs) J per cycle, dissipated by the contact force of each pair: friction and ``normal_work``. The
        energy balance is dissipated + viscous = input.
    normal_work:
        (n_points, n_pairs) J per cycle, the part of the normal force. A force that only depends on the closing does no
        work in a period, so this is a sampling error; if it is not small compared with the input, there are too few
        samples.
    closure:
        (n_points, n_pairs) relative distance between the slider at the start and at the end of the period.
    residual, iterations:
        (n_points,) relative residual of the balance, Newton iterations.
    input_energy, viscous_energy:
        (n_points,) J per cycle, work of the excitation and loss in the damping matrix.
    converged, message:
        whether the curve covers the whole range, and a message on its end.
    warnings:
        messages, for example on too few harmonics.
    harmonics, samples:
        highest harmonic of the solution, samples per period of the friction law.
    pairs:
        the joint.
    linear:
        the linear limits.
    force:
        (n, 2 * harmonics + 1) N, coefficients of the excitation; if it depends on the frequency, at the middle of the
        curve.
    settings, provenance:
        the options of the run, and the versions of software and machine.
    load_factor:
        (n_points,) the excitation at a point over ``force``; 1 except in a response at prescribed amplitude or phase.
    kinetic_energy:
        (n_points,) J, largest kinetic energy that the first harmonic would have with all unknowns in phase:
        ``w^2 / 2 (c_1 . M c_1 + s_1 . M s_1)``, twice its mean over the period. It does not depend on the phases
        between the unknowns. 0 in files of earlier versions, which do not contain it.
    walk:
        (n_points, n) m, displacement per cycle of a body that friction alone supports; 0 at points without it, None
        if it never occurs. ``displacement`` is the motion without it.
    part:
        (n_points,) number from 0 of the uninterrupted part of the curve to which a point belongs. Where the solver lost
        the branch and found it, or another one, farther on, a part ends; a warning says what is known.
    point_harmonics, estimated_error:
        (n_points,) with an accuracy: harmonics of each point, whose coefficients are zero in the others, and its
        estimated error by neglected harmonics: the distance to the curve with more of them, over the motion of the
        structure (mass norm). None with a fixed number of harmonics, except that ``point_harmonics`` is given where a
        piece of the curve has more of them (a warning says where and why).
    stable:
        (n_points,) whether small disturbances of the motion decay under the constant force; None if the stability was
        not computed, and ``stability_message`` then gives the reason.
    doubtful:
        (n_points,) whether the verdict ``stable`` is doubtful: a multiplier is too close to the unit circle, or the
        motion corrected with more harmonics has another verdict, or unsettled multipliers, or is not known; None with
        ``stable``.
    multipliers:
        (n_points, k) complex, the largest factors by which a small disturbance grows in a period (Floquet multipliers),
        the largest first; 0 where there are fewer. The motion is unstable where one is outside of the unit circle.
    bifurcations:
        where a multiplier crosses the unit circle, in the order of the curve.
    stability_message:
        a sentence on the stability of the points.
    traction_band:
        curves with extreme residual tractions around the highest peak; None if not asked for
        (``forced_response(..., traction_band=output)``).
    stiffness_band:
        curves with 1/3 and 3 times the contact stiffness; None if it was not computed, or was measured.
    other_solutions:
        periodic motions that are not on the curve; None without a search (:func:`search_other_solutions`).
    nonlinear_mode:
        a nonlinear mode of the same structure, with its contacts about the same rest; None without ``[analysis] kind =
        "mode"``.
    quasi_static_mode:
        the quasi-static estimate of a stuck mode, beside the nonlinear mode or alone.
    peak_ridge:
        the peaks over a key of the study; None without ``[analysis] kind = "ridge"``.
    performance_curve:
        of two blades: the peaks over centrifugal force over excitation force; None if it was not computed.
    gradients:
        derivatives of the highest peak by the inputs of the study; None without ``[analysis] gradients = true``.
    wear:
        wear of the joint over many cycles; None without ``[analysis] kind = "wear"``.

    Raises
    ------
    InputError
        for an array of the wrong shape or with an entry that is not finite.
    """

    # Properties that :meth:`to_xarray` adds to the stored data.
    DERIVED: ClassVar[Mapping[str, Numbers]] = {
        "friction_energy": Numbers(PAIRS, "J", "energy that friction dissipates per cycle"),
        "moving_pairs": WholeNumbers(CURVE, "1", "pairs that slip or separate"),
    }

    def __repr__(self) -> str:
        top = int(self.input_energy.argmax())
        return (
            f"ForcedResponse({points_between(self.frequency_hz)}, {self.pairs.n_pairs} pairs; peak at "
            f"{self.frequency_hz[top]:.2f} Hz, with an input of {self.input_energy[top]:.3g} J per cycle and "
            f"{self.moving_pairs[top]} moving pairs; {'converged' if self.converged else 'NOT converged'})"
        )

    def to_xarray(self) -> xarray.Dataset:
        """The curve as labelled data: the root group of the file, and numbers computed from it.

        Dimensions are point, pair, unknown and harmonic; ``frequency`` (Hz) is a coordinate of the points. Displacement
        and force have mean, cosine and sine parts.
        """
        dataset = self.to_dataset()
        for name, entry in self.DERIVED.items():
            dataset = dataset.assign(entry.variables(self, name))
        return dataset.set_coords("frequency")

    def linear_amplitude(self, output: ArrayLike, limit: str) -> FloatArray:
        """(n_linear,) the same amplitude on the linear curve ``limit``: "stuck" or "free". Raises InputError."""
        require_choice("limit", limit, ("stuck", "free"))
        curve: FloatArray = getattr(self.linear, limit)
        return periodic_amplitude(np.einsum("pic,i->pc", curve, self._row(output)))

    @property
    def stuck_name(self) -> str:
        """Name of the linear stuck curve, in which pairs that are open at rest stay open.

        For laws beside Coulomb friction it has the springs for small motions.
        """
        if not self.pairs.is_coulomb:
            return "linear, springs at rest"
        return "linear, all stuck" if self.pairs.closed_at_rest.all() else "linear, stuck (pairs closed at rest)"

    @property
    def curve_name(self) -> str:
        """Name of the curve itself beside the linear ones."""
        return "with friction" if self.pairs.is_coulomb else "with contact"

    def plot(self, output: ArrayLike, name: str = "") -> Figure:
        """Amplitude of an output against frequency, linear stuck and free beside it: stable solid, unstable dashed.

        The highest peak has a mark; where slow sweeps differ from it, their peaks and jumps have marks too.

        Parameters
        ----------
        output:
            (n,) row of a displacement; the amplitude is 0-to-peak, in µm.
        name:
            of the output, for the axis.

        Returns
        -------
        matplotlib.figure.Figure
            which a notebook shows and ``savefig`` writes. Raises InputError for a row of another length.
        """
        stuck, free = (self.linear_amplitude(output, limit) for limit in ("stuck", "free"))
        amplitude, linear_hz = self.amplitude(output), self.linear.frequency_hz
        return AmplitudeCurve(
            self.frequency_hz, amplitude, linear_hz, stuck, free, self.stuck_name, name, self.curve_name,
            self.stable_points, self.part, solid_words(self.stable), self.slow_sweeps(output), self._beside(output),
        ).figure()  # fmt: skip

    def harmonics_at(self, points: Sequence[int]) -> int:
        """The most harmonics that some points have, numbers from 0."""
        return self.harmonics if self.point_harmonics is None else int(self.point_harmonics[list(points)].max())

    def resolution_at(self, points: Sequence[int] = ()) -> Resolution:
        """The harmonics and samples with which another analysis of the same structure is solved.

        Those that the curve was asked for. Where one of the ``points``, numbers from 0, about which the analysis is has
        more of them, because the own ones have no motion there, it is those of the point. With an accuracy it is the
        most harmonics of the curve, for it does not say how many the other analysis needs.
        """
        widest = Resolution(self.harmonics, self.samples)
        if self.point_harmonics is None or self.estimated_error is not None:
            return widest
        own = Resolution(int(self.settings["harmonics"]), int(self.settings["samples"]))
        most = self.harmonics_at(points) if len(points) else own.harmonics
        return own if most <= own.harmonics else Resolution(most, self.samples)

    def slow_sweeps(self, output: ArrayLike) -> tuple[SlowSweep, SlowSweep]:
        """What a slow sweep up and a slow sweep down see of the curve, with the peaks of an output (n,).

        At constant excitation (:func:`stickslip.results.sweeps_of_curve.sweeps`). In a response at prescribed amplitude
        or phase the control passes folds, so that both sweeps follow the whole curve. Raises InputError.
        """
        amplitude = self.amplitude(output)
        if np.ptp(self.load_factor) > 0.0:
            return one_run(self.frequency_hz, amplitude)
        return sweeps(self.frequency_hz, amplitude, self.stable_points, self.part)

    def _beside(self, output: ArrayLike) -> dict[str, tuple[SideCurve, ...]]:
        """Curves beside this one by the name that a figure gives them."""
        named = {
            STIFFNESS_CURVES: self.stiffness_band,
            TRACTION_CURVES: self.traction_band,
            OTHER_CURVES: self.other_solutions,
        }
        return {name: each.curves(output) for name, each in named.items() if each is not None}

    def jumps(self, output: ArrayLike) -> tuple[Jump, ...]:
        """Where a slow sweep up and then a slow sweep down jump: frequency, and amplitudes of an output (n,) before and
        after.

        The unit of ``output`` sets that of the amplitudes. Raises InputError for a row of another length.
        """
        up, down = self.slow_sweeps(output)
        return (*up.jumps, *down.jumps)

    @property
    def stable_points(self) -> NDArray[np.bool_]:
        """(n_points,) :attr:`stable`; where it was not computed the folds of the curve decide."""
        return stable_between_folds(self.frequency_hz) if self.stable is None else self.stable

    def pair_cycle(self, point: int) -> ContactCycle:
        """Force, slider, state and energy of every pair over one period at one point. Raises InputError.

        The friction law is marched again to its periodic state on the displacement of that point, with the samples and
        the update rule of the solution (``settings["update"]``), so the file need not contain it.
        """
        displacement, walk = self.pair_displacement(point, self.samples), None
        if self.walk is not None:
            walk = self.walk[point]
        return self.pairs.with_update(cast("Update", self.settings["update"])).walking_cycle(displacement, walk)

    def pair_way(self, point: int) -> FloatArray:
        """(n_pairs, 3) m, the way of many cycles that the law adds to the mean of each pair (:meth:`ContactPairs.way`).

        Zero where no body walks. Raises InputError.
        """
        if self.walk is None:
            return np.zeros((self.pairs.n_pairs, 3))
        return self.pairs.way(self.walk[self._point(point)])
