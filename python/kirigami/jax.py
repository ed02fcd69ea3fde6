"""The equilibrium as a differentiable function of JAX.

>>> import jax, kirigami as kg, kirigami.jax
>>> jax.config.update("jax_enable_x64", True)
>>> problem = kg.Problem("configs/scenes/pet-3x3.toml")
>>> equilibrium = kirigami.jax.equilibrium(problem)
>>> width = lambda x: equilibrium(x).corners[:, :, 0].max()
>>> jax.grad(width)(problem.start)

Works under `jit`, `grad`, `vjp`, `jacrev` and `vmap`; a batch is solved over all threads.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from kirigami import _implicit
from kirigami._kirigami import Problem


class Equilibrium(NamedTuple):
    """The equilibrium at full load."""

    corners: jax.Array
    """Deployed corners SW, SE, NE, NW of the panels (mm), shape (panels, 4, 2)."""
    reactions: jax.Array
    """Forces (F_x, F_y, M) by which the supports hold the panels (N, N, N mm), shape (panels, 3)."""
    load_factor: jax.Array
    """zeta: 1 under dead loads; under a prescribed stroke the load over the load of the scene."""


def equilibrium(problem: Problem, strict: bool = True) -> Callable[..., Equilibrium]:
    """The function f(x, loads=None, thickness=None, stress=None) -> Equilibrium of a problem.

    x: design, shape (size,); loads: (F_x, F_y, M) on every panel, shape (panels, 3); thickness (mm); stress: all stresses at equal strain
    over the stresses of the material. What is not given is the scene's. Its reverse-mode derivative is implicit: one adjoint solve.

    Raises TypeError without double precision, and where a derivative in thickness or stress does not exist. Inside of compiled functions an
    equilibrium that is not found is raised by JAX, with the message of NoEquilibrium; without `strict` its outputs and gradient are NaN.
    """
    shapes = _implicit.input_shapes(problem)
    defaults = _implicit.Inputs(None, problem.loads, problem.thickness, 1.0)

    def solve(*inputs):
        return _implicit.solve(problem, _implicit.Inputs(*inputs), strict)

    def pullback(*arrays):
        return _implicit.pullback(problem, _implicit.Inputs(*arrays[:4]), _implicit.Solution(*arrays[4:]))

    solved = _on_host(solve, _implicit.output_shapes(problem))
    pulled_back = _on_host(pullback, shapes)

    @jax.custom_vjp
    def function(x, loads, thickness, stress):
        return Equilibrium(*solved(x, loads, thickness, stress)[:3])

    def forward(*inputs):
        perturbed = {name: bool(given.perturbed) for name, given in zip(shapes._fields, inputs)}
        _implicit.refuse(problem, {name: perturbed[name] for name in ("thickness", "stress")})
        values = tuple(given.value for given in inputs)
        *outputs, configuration = solved(*values)
        return Equilibrium(*outputs), (values, configuration)

    def backward(known, by_outputs):
        values, configuration = known
        zero = jax.custom_derivatives.SymbolicZero
        instantiated = (jnp.zeros(by.shape, by.dtype) if isinstance(by, zero) else by for by in by_outputs)
        return pulled_back(*values, *instantiated, configuration)

    function.defvjp(forward, backward, symbolic_zeros=True)

    def with_defaults(x, loads=None, thickness=None, stress=None) -> Equilibrium:
        if not jax.config.jax_enable_x64:
            raise TypeError('equilibria are solved in double precision: jax.config.update("jax_enable_x64", True)')
        inputs = []
        for name, given, default, shape in zip(shapes._fields, (x, loads, thickness, stress), defaults, shapes):
            value = jnp.asarray(default if given is None else given, dtype=np.float64)
            if value.shape != shape:
                raise ValueError(f"`{name}` has the shape {value.shape}, expected {shape}")
            inputs.append(value)
        return function(*inputs)

    return with_defaults


def _on_host(function: Callable, shapes: tuple) -> Callable:
    """A function of NumPy arrays as one of JAX, without a derivative."""

    def call(*arguments):
        # No JAX inside of the callback: it could wait for itself.
        return tuple(function(*(np.asarray(argument) for argument in arguments)))

    @jax.custom_vjp
    def on_host(*arguments):
        results = tuple(jax.ShapeDtypeStruct(shape, np.float64) for shape in shapes)
        return jax.pure_callback(call, results, *arguments, vmap_method="broadcast_all")

    def refuse(*_):
        raise NotImplementedError(_implicit.TWICE)

    on_host.defvjp(refuse, refuse)
    return on_host
