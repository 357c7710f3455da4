"""The inputs of a case as parameters of its peak: from a key of the study file to the input of the solver.

A key of the joint, a load or the damping changes the joint and the loads on the same reduced structure. A dimension or
a material changes the mesh or its matrices: the change of the full matrices then acts on the motion of the full mesh
(docs/theory_gradients.md).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from stickslip.case.case import Case, MeshCase, TwoBladeCase
from stickslip.case.continuous_keys import ContinuousKey, continuous_keys
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError, StudyFileError
from stickslip.model.joint import Joint
from stickslip.model.layout import Layout
from stickslip.model.model import Model, build_model, connect, kind_of, load_joint, set_up
from stickslip.model.study_structure import ReducedStructure, study_structure
from stickslip.solve.gradients.parameters import STEP, Parameter
from stickslip.solve.solver_input import SolverInput
from stickslip.structure.elasticity import Structure

# Sections of a study file whose keys change the matrices of the structure.
OF_STRUCTURE: dict[type[Case], tuple[str, ...]] = {
    TwoBladeCase: ("geometry", "damper", "material", "rotation"),
    MeshCase: ("material", "bodies", "rotation"),
}
# Keys of a two-blade study that change together if the damper is as long as the blades are wide: the mesh has other
# elements if it is shorter, and a longer one does not fit.
_JOINED = ("geometry.width", "geometry.damper_length")


def case_parameters(case: Case, model: Model, output: str | None = None) -> tuple[Parameter, ...]:
    """Each number of a study file that describes the structure, its joint or its loads, as a parameter.

    Parameters
    ----------
    case, model:
        the case and its model (:func:`build_model`).
    output:
        name of the output whose peak is differentiated; by default the first.

    Returns
    -------
    tuple of Parameter
        with the key as name, in the units that the study file shows. Directions, positions, lists and numbers that are
        zero are no parameters.

    Raises
    ------
    InputError
        for an output that the model does not have, and a reduction for several speeds.
    """
    name = next(iter(model.outputs)) if output is None else output
    if name not in model.outputs:
        raise InputError(
            f'output is "{name}", but the outputs of the model are {", ".join(model.outputs)}.', arguments=["output"]
        )
    if model.reduced.speeds is not None:  # its recovery is in equilibrium at rest, not at the speed
        raise InputError(
            "rotation.top_speed gives one reduction for several speeds, which has no gradients. Remove the key.",
            ("rotation.top_speed",),
        )
    source = _CaseInput(case, model, name)
    return tuple(source.parameter(keys) for keys in _groups(case))


def _groups(case: Case) -> Iterator[tuple[ContinuousKey, ...]]:
    """Keys that change together: each alone, except a damper that is as long as its blades are wide."""
    keys = {key.path: key for key in continuous_keys(case)}
    joined: tuple[ContinuousKey, ...] = ()
    if isinstance(case, TwoBladeCase) and case.geometry.damper_length >= case.geometry.width * (1.0 - 1e-9):
        joined = tuple(keys.pop(path) for path in _JOINED)
        yield joined
    yield from ((key,) for key in keys.values())


class _CaseInput:
    """The input of the solver for a case with changed values."""

    def __init__(self, case: Case, model: Model, output: str) -> None:
        self._case, self._model, self._output = case, model, output
        self._of_structure = OF_STRUCTURE.get(type(case), ()) if model.in_study.full_model is not None else ()
        self._base = self._input(case, model.joint)
        damping = case.damping
        self._rayleigh = damping.rayleigh_alpha or 0.0, damping.rayleigh_beta or 0.0
        self._own = replace(self._base, structure=model.in_study.full_model, rayleigh=self._rayleigh)

    def parameter(self, keys: Sequence[ContinuousKey]) -> Parameter:
        """The parameter of keys that change in proportion."""
        first = keys[0]
        unit = "" if first.unit == "1" else f" {first.unit}"
        changes_structure = first.section in self._of_structure

        def change(shown: float) -> SolverInput:
            if shown == first.shown:
                return self._own if changes_structure else self._base
            case = self._case
            try:
                for key in keys:
                    case = key.changed(case, key.shown * (shown / first.shown))
            except StudyFileError as error:
                raise InputError(f"the study is not valid with {shown:.6g}{unit}.", (first.path,)) from error
            return self._on_changed_structure(case) if changes_structure else self._on_same_structure(case)

        name = " = ".join([first.path, *(key.path.rpartition(".")[2] for key in keys[1:])])
        return Parameter(name, first.unit, first.shown, change, STEP * abs(first.shown))

    def _on_same_structure(self, case: Case) -> SolverInput:
        return self._input(case, load_joint(case, self._model.joint.layout))

    def _on_changed_structure(self, case: Case) -> SolverInput:
        setup, own = set_up(case), self._model
        structure, of_case = study_structure(setup.assemble()).full_model, own.in_study.full_model
        assert structure is not None  # see _of_structure
        assert of_case is not None
        _require_same_mesh(structure, of_case)
        _require_same_places(setup.layout, own.joint.layout)
        joint = load_joint(case, setup.layout)
        changed = self._input(case, joint)
        if case.preload.method == "solved":  # the state at rest depends on the changed structure too
            solved = build_model(case, structure, joint).pairs
            changed = replace(
                changed, pairs=ContactPairs.with_laws(changed.pairs.operator, solved.laws, solved.members)
            )
        return replace(changed, structure=structure, rayleigh=self._rayleigh)

    def _input(self, case: Case, joint: Joint) -> SolverInput:
        """The input on the reduction of the case itself."""
        undamped = self._model.reduced.at(kind_of(self._case).rotation_speed(self._case)).require_structure()
        model = connect(case, ReducedStructure.of_superelement(undamped, joint.layout), joint)
        return SolverInput(
            model.superelement,
            model.pairs,
            model.excitation,
            model.outputs[self._output],
            case.damping.modal_damping_ratio,
        )


def _require_same_mesh(changed: Structure, own: Structure) -> None:
    """Raise InputError for a mesh with other elements: its motion is not that of the case."""
    if not np.array_equal(changed.mesh.cells, own.mesh.cells) or not np.array_equal(
        changed.free_unknowns, own.free_unknowns
    ):
        raise InputError("a small change of it gives a mesh with other elements.")


def _require_same_places(changed: Layout, own: Layout) -> None:
    """Raise InputError where pairs, forces or outputs are at other nodes."""
    sides = ("first_nodes", "second_nodes")
    same_pairs = all(np.array_equal(getattr(changed.face_pairs, side), getattr(own.face_pairs, side)) for side in sides)
    same_groups = all(
        np.array_equal(group.nodes, changed.node_groups[name].nodes) for name, group in own.node_groups.items()
    )
    if not (same_pairs and same_groups):
        raise InputError("a small change of it moves contact pairs, forces or outputs to other nodes.")
