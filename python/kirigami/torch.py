"""The equilibrium as a differentiable function of PyTorch.

>>> import torch, kirigami as kg, kirigami.torch
>>> problem = kg.Problem("configs/scenes/pet-3x3.toml")
>>> x = torch.tensor(problem.start, requires_grad=True)
>>> kirigami.torch.equilibrium(problem, x).corners[..., 0].max().backward()
>>> x.grad
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch

from kirigami import _implicit
from kirigami._kirigami import Problem


class Equilibrium(NamedTuple):
    """The equilibrium at full load, with the leading dimensions of x."""

    corners: torch.Tensor
    """Deployed corners SW, SE, NE, NW of the panels (mm), shape (..., panels, 4, 2)."""
    reactions: torch.Tensor
    """Forces (F_x, F_y, M) by which the supports hold the panels (N, N, N mm), shape (..., panels, 3)."""
    load_factor: torch.Tensor
    """zeta: 1 under dead loads; under a prescribed stroke the load over the load of the scene."""


def equilibrium(
    problem: Problem,
    x: torch.Tensor,
    loads: torch.Tensor | None = None,
    thickness: torch.Tensor | None = None,
    stress: torch.Tensor | None = None,
    strict: bool = True,
) -> Equilibrium:
    """The equilibrium of a problem at full load, differentiable once.

    x: designs, shape (..., size), float64; loads: (F_x, F_y, M) on every panel, shape (..., panels, 3); thickness (mm), shape (...);
    stress: all stresses at equal strain over the stresses of the material, shape (...). What is not given is the scene's. A batch is solved over
    all threads.

    Raises TypeError for other than double precision, and where a derivative in thickness or stress does not exist; NoEquilibrium; and in the
    backward pass SingularTangent. Without `strict` the outputs and the gradient of an equilibrium that is not found are NaN.
    """
    if x.dtype != torch.float64:
        raise TypeError(f"`x` is {x.dtype}: equilibria are solved in double precision (torch.float64)")
    lead = x.shape[:-1]
    shapes = _implicit.input_shapes(problem)
    defaults = _implicit.Inputs(x, problem.loads, problem.thickness, 1.0)
    inputs = []
    for name, given, default, shape in zip(shapes._fields, (x, loads, thickness, stress), defaults, shapes):
        value = torch.as_tensor(default if given is None else given, dtype=torch.float64)
        if value.shape not in (shape, (*lead, *shape)):
            raise ValueError(f"`{name}` has the shape {tuple(value.shape)}, expected {(*lead, *shape)}")
        inputs.append(value.expand((*lead, *shape)))
    _implicit.refuse(problem, {name: given.requires_grad for name, given in zip(shapes._fields[2:], inputs[2:])})
    return Equilibrium(*_Solve.apply(problem, strict, *inputs))


class _Solve(torch.autograd.Function):
    @staticmethod
    def forward(ctx, problem, strict, *inputs):
        solution = _implicit.solve(problem, _implicit.Inputs(*map(_array, inputs)), strict)
        *outputs, configuration = (torch.from_numpy(np.array(column)) for column in solution)
        ctx.problem = problem
        ctx.save_for_backward(*inputs, configuration)
        return tuple(outputs)

    @staticmethod
    def backward(ctx, *by_outputs):
        *inputs, configuration = ctx.saved_tensors
        return None, None, *_Pullback.apply(ctx.problem, *inputs, *by_outputs, configuration)


class _Pullback(torch.autograd.Function):
    """The gradient as a function of its own, so that its derivative is refused; without it a gradient of a gradient would be constant."""

    @staticmethod
    def forward(ctx, problem, *tensors):
        arrays = [_array(tensor) for tensor in tensors]
        gradient = _implicit.pullback(problem, _implicit.Inputs(*arrays[:4]), _implicit.Solution(*arrays[4:]))
        return tuple(torch.from_numpy(np.array(column)) for column in gradient)

    @staticmethod
    def backward(ctx, *_):
        raise NotImplementedError(_implicit.TWICE)


def _array(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().cpu().numpy()
