"""The equilibrium and its implicit gradient over NumPy arrays with leading dimensions, for `kirigami.jax` and `kirigami.torch`."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from kirigami._kirigami import Problem, State


class Inputs(NamedTuple):
    """What the equilibrium depends on; each array has the same leading dimensions."""

    x: np.ndarray
    loads: np.ndarray
    thickness: np.ndarray
    stress: np.ndarray


class Solution(NamedTuple):
    """Outputs of the equilibrium, and the configuration from which its gradient follows."""

    corners: np.ndarray
    reactions: np.ndarray
    load_factor: np.ndarray
    configuration: np.ndarray


def input_shapes(problem: Problem) -> Inputs:
    """The shapes of the inputs of one equilibrium."""
    return Inputs((problem.size,), problem.loads.shape, (), ())


def output_shapes(problem: Problem) -> Solution:
    """The shapes of the outputs of one equilibrium."""
    panels = problem.loads.shape[0]
    return Solution((panels, 4, 2), (panels, 3), (), (panels, 3))


def solve(problem: Problem, inputs: Inputs, strict: bool) -> Solution:
    """All equilibria: a single one from the last state of the problem, several over all threads. One that is not found is raised if
    `strict`, and is otherwise NaN."""
    lead = inputs.x.shape[:-1]
    if lead or not strict:
        states = problem.solve_many(*_flat(inputs, lead), strict=strict)
    else:
        states = [problem.solve(inputs.x, inputs.loads, float(inputs.thickness), float(inputs.stress))]
    shapes = output_shapes(problem)

    def output(state, name: str):
        return getattr(state, name) if isinstance(state, State) else np.full(getattr(shapes, name), np.nan)

    columns = ([output(state, name) for state in states] for name in Solution._fields)
    return Solution(*(np.reshape(column, lead + shape) for column, shape in zip(columns, shapes)))


def pullback(problem: Problem, inputs: Inputs, solution: Solution) -> Inputs:
    """The gradient in the inputs. The outputs of `solution` are the gradient in them, its configuration is the equilibrium's."""
    lead = inputs.x.shape[:-1]
    count = int(np.prod(lead))

    def one(i: int) -> Inputs:
        x, loads, thickness, stress = (column[i] for column in flat)
        corners, reactions, load_factor, configuration = (column[i] for column in given)
        if np.isnan(configuration).any():
            return Inputs(*(np.full(shape, np.nan) for shape in input_shapes(problem)))
        by = problem.pullback(x, configuration, corners, reactions, float(load_factor), loads, float(thickness), float(stress))
        return Inputs(by["design"], by["loads"], by["thickness"] or 0.0, by["stress"] or 0.0)

    flat, given = _flat(inputs, lead), _flat(solution, lead)
    if count == 1:
        gradients = [one(0)]
    else:
        with ThreadPoolExecutor(os.cpu_count()) as threads:
            gradients = list(threads.map(one, range(count)))
    columns = zip(*gradients)
    return Inputs(*(np.reshape(column, lead + shape) for column, shape in zip(columns, input_shapes(problem))))


def refuse(problem: Problem, differentiated: dict[str, bool]) -> None:
    """An error if a derivative is wanted that does not exist."""
    for name, wanted in differentiated.items():
        if wanted and name not in problem.differentiable:
            known = ", ".join(problem.differentiable)
            raise TypeError(f"the equilibrium of this scene has no derivative in `{name}`: its hinge law determines those in {known}")


TWICE = "the equilibrium has first derivatives only: it cannot be differentiated twice"


def _flat(columns: tuple, lead: tuple[int, ...]) -> list[np.ndarray]:
    """The arrays with one leading dimension."""
    count = int(np.prod(lead))
    return [np.reshape(column, (count, *np.shape(column)[len(lead):])) for column in columns]
