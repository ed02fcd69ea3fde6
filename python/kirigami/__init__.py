"""Kirigami sheets with learned hinges: energies, equilibria, gradients and designs as NumPy arrays.

Units are mm, N, MPa, N mm and rad. Numbers in round brackets, such as (14), are equations of the paper.

>>> import kirigami as kg
>>> problem = kg.Problem("configs/scenes/pet-3x3.toml")
>>> state = problem.solve(problem.start)
>>> state.corners.shape, state.reactions.sum(axis=0)

`kirigami.jax` and `kirigami.torch` make the equilibrium a differentiable function of these libraries, `kirigami.plot` draws.
"""

from kirigami._kirigami import (
    Deployment,
    Hinges,
    HingeStates,
    InvalidDesign,
    InvalidScene,
    KirigamiError,
    NoEquilibrium,
    Pattern,
    Problem,
    Sheet,
    SingularTangent,
    State,
    Surrogate,
    WeightsError,
)
from kirigami.files import Run, read_database, read_scene

__all__ = [
    "Deployment",
    "HingeStates",
    "Hinges",
    "InvalidDesign",
    "InvalidScene",
    "KirigamiError",
    "NoEquilibrium",
    "Pattern",
    "Problem",
    "Run",
    "Sheet",
    "SingularTangent",
    "State",
    "Surrogate",
    "WeightsError",
    "read_database",
    "read_scene",
]
