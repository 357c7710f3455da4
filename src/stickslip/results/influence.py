"""Sobol indices of a result from the samples of a band, by polynomials fitted to them.

The result y of independent inputs is approximated by orthonormal polynomials of the inputs (polynomial chaos) fitted by
least squares. The squares of their coefficients are fractions of the variance: those of polynomials of input i alone
give the first-order index ``S_i = V(E(y | x_i)) / V(y)``, those in which i occurs the total index ``T_i`` (I. M. Sobol,
Math. Comput. Simul. 55, 2001; B. Sudret, Reliab. Eng. Syst. Saf. 93, 2008). No further samples are needed.

The polynomials are those with the smallest leave-one-out error (exact, from the diagonal of the projection). This error
is the unexplained fraction of the variance; it is part of V(y), so the indices and it add up to 1. A total index may be
larger by up to that fraction, which its interval contains. If the fraction exceeds LARGEST_UNEXPLAINED, there are no
indices, only the reason.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

LARGEST_UNEXPLAINED = 0.3  # chosen: above it, the order of the inputs can be wrong
LARGEST_DEGREE = 8  # chosen: of a polynomial
SAMPLES_PER_TERM = 2  # usual oversampling of a least-squares fit
RESAMPLINGS = 400  # bootstrap; intervals of 95 % need some hundred
CONFIDENCE = 0.95  # of all intervals of a band
NO_SCATTER = 1e-9  # chosen: a smaller relative scatter is round-off of the solver (its tolerance)
_SEED = 20_260_101  # of the bootstrap: the same samples give the same intervals
Terms = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, eq=False)
class Coordinate:
    """An input of the samples.

    name:
        its key.
    samples:
        (n,) its coordinate in each sample.
    nodes, weights:
        (q,) a quadrature of its distribution, which determines the orthonormal polynomials; sum of weights 1.
    """

    name: str
    samples: FloatArray
    nodes: FloatArray
    weights: FloatArray

    @property
    def largest_degree(self) -> int:
        """Polynomials of listed values have less than one degree for each value."""
        return min(LARGEST_DEGREE, self.nodes.size - 1)

    def polynomials(self, degree: int) -> FloatArray:
        """(n, degree + 1) the orthonormal polynomials of the samples."""
        scale = float(np.abs(self.nodes).max())
        at_nodes = np.polynomial.legendre.legvander(self.nodes / scale, degree)
        triangle = np.linalg.qr(np.sqrt(self.weights)[:, None] * at_nodes)[1]
        at_samples = np.polynomial.legendre.legvander(self.samples / scale, degree)
        values: FloatArray = np.linalg.solve(triangle.T, at_samples.T).T
        return values


@dataclass(frozen=True)
class Influence:
    """Fractions of the variance of a result that come from each input.

    names:
        keys of the inputs.
    first, total:
        (n_inputs,) Sobol indices; NaN if they are not resolved. ``first_interval`` and ``total_interval`` (n_inputs, 2)
        contain them with a confidence of 95 % (bootstrap).
    unexplained:
        fraction of the variance that the polynomials do not explain, from leave-one-out errors; NaN without a fit.
    n_samples:
        number of samples used.
    reason:
        why there are no indices; "" if they are resolved.
    """

    names: tuple[str, ...]
    first: tuple[float, ...]
    total: tuple[float, ...]
    first_interval: tuple[tuple[float, float], ...]
    total_interval: tuple[tuple[float, float], ...]
    unexplained: float
    n_samples: int
    reason: str = ""


def influence(coordinates: Sequence[Coordinate], values: FloatArray) -> Influence:
    """Sobol indices of ``values`` (n,), NaN for samples without one, over the inputs of these samples."""
    usable = np.isfinite(values)
    y, count = values[usable], int(usable.sum())
    least = 2 * SAMPLES_PER_TERM * (len(coordinates) + 1)
    if count < least:
        words = f"{count} samples have a result, but indices of {len(coordinates)} inputs require at least {least}."
        return _unresolved(coordinates, count, np.nan, words)
    if np.ptp(y) <= NO_SCATTER * np.abs(y).max():
        return _unresolved(coordinates, count, np.nan, "The result is the same for all samples.")
    factors = [each.polynomials(each.largest_degree)[usable] for each in coordinates]
    terms, unexplained = min(
        ((terms, _left_out_error(_matrix(factors, terms), y)) for terms in _candidates(coordinates, count)),
        key=lambda candidate: candidate[1],
    )
    if not unexplained <= LARGEST_UNEXPLAINED:
        words = (
            f"No polynomial describes the result: {100.0 * min(unexplained, 1.0):.0f} % of its variance remain "
            f"unexplained by {count} samples (at most {100.0 * LARGEST_UNEXPLAINED:.0f} % are allowed). Use more "
            "samples; a jump of the result, such as one at a fold, needs many."
        )
        return _unresolved(coordinates, count, unexplained, words)
    matrix = _matrix(factors, terms)
    first, total = _indices(matrix, y, terms, unexplained)
    rng = np.random.default_rng(_SEED)
    drawn = [
        _indices(matrix[rows], y[rows], terms, unexplained)
        for rows in (rng.integers(0, count, count) for _ in range(RESAMPLINGS))
    ]
    tails = (0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE))
    first_ends, total_ends = (np.quantile([each[which] for each in drawn], tails, axis=0) for which in (0, 1))
    # the indices themselves are inside, also where a bootstrap of few samples is biased
    first_ends = np.stack([np.minimum(first_ends[0], first), np.maximum(first_ends[1], first)])
    total_ends = np.stack([np.minimum(total_ends[0], total), np.maximum(total_ends[1], total)])
    total_ends[1] = np.minimum(total_ends[1] + unexplained, 1.0)
    return Influence(
        tuple(each.name for each in coordinates),
        tuple(map(float, first)),
        tuple(map(float, total)),
        tuple((float(low), float(high)) for low, high in first_ends.T),
        tuple((float(low), float(high)) for low, high in total_ends.T),
        float(unexplained),
        count,
    )


def _unresolved(coordinates: Sequence[Coordinate], count: int, unexplained: float, reason: str) -> Influence:
    nothing = (np.nan,) * len(coordinates)
    pairs = ((np.nan, np.nan),) * len(coordinates)
    names = tuple(each.name for each in coordinates)
    return Influence(names, nothing, nothing, pairs, pairs, float(unexplained), count, reason)


def _candidates(coordinates: Sequence[Coordinate], count: int) -> Iterator[Terms]:
    """Sets of degrees in each input, with and without products of two inputs, that ``count`` samples can determine."""
    limits = [each.largest_degree for each in coordinates]
    seen = set()
    for order, degree in itertools.product((1, 2), range(1, LARGEST_DEGREE + 1)):
        terms = tuple(_terms(limits, degree, order))
        if len(terms) * SAMPLES_PER_TERM <= count and terms not in seen:
            seen.add(terms)
            yield terms


def _terms(limits: Sequence[int], degree: int, order: int) -> Iterator[tuple[int, ...]]:
    """The constant, then degrees of products of at most ``order`` inputs with this total degree."""
    size = len(limits)
    yield (0,) * size
    for number in range(1, min(order, size) + 1):
        for inputs in itertools.combinations(range(size), number):
            for degrees in itertools.product(*(range(1, min(limits[i], degree) + 1) for i in inputs)):
                if sum(degrees) <= degree:
                    chosen = dict(zip(inputs, degrees, strict=True))
                    yield tuple(chosen.get(i, 0) for i in range(size))


def _matrix(factors: Sequence[FloatArray], terms: Terms) -> FloatArray:
    """(n, n_terms) products of polynomials."""
    columns = [np.prod([factor[:, k] for factor, k in zip(factors, term, strict=True)], axis=0) for term in terms]
    return np.stack(columns, axis=1)


def _left_out_error(matrix: FloatArray, y: FloatArray) -> float:
    """Mean square error at each sample of the fit to all others, over the variance of the samples."""
    basis = np.linalg.qr(matrix)[0]
    residual = y - basis @ (basis.T @ y)
    free = 1.0 - (basis**2).sum(axis=1)
    if free.min() <= 1e-10:  # a sample that alone determines a term
        return np.inf
    return float(np.mean((residual / free) ** 2) / y.var())


def _indices(matrix: FloatArray, y: FloatArray, terms: Terms, unexplained: float) -> tuple[FloatArray, FloatArray]:
    squares = np.linalg.lstsq(matrix, y, rcond=None)[0] ** 2
    degrees: NDArray[np.int64] = np.array(terms)
    is_in = degrees > 0
    # the unexplained part is a fraction of the variance of the samples, hence of the sum of both parts
    explained = squares[is_in.any(axis=1)].sum()
    if explained == 0.0:
        return np.zeros(is_in.shape[1]), np.zeros(is_in.shape[1])
    fractions = squares / explained * (1.0 - unexplained)
    alone = is_in.sum(axis=1) == 1
    first: FloatArray = (fractions[:, None] * (is_in & alone[:, None])).sum(axis=0)
    total: FloatArray = (fractions[:, None] * is_in).sum(axis=0)
    return first, total
