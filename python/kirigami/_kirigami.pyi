"""Types of the compiled part. The classes have the docstrings."""

import os
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
    "Sheet",
    "SingularTangent",
    "State",
    "Surrogate",
    "WeightsError",
]

_Doubles: TypeAlias = NDArray[np.float64]
_Path: TypeAlias = str | os.PathLike[str]
_Order: TypeAlias = Literal["value", "forces", "tangent", "design"]

class KirigamiError(Exception):
    """What kirigami reports: the base of all its exceptions."""
class WeightsError(KirigamiError):
    """Weights or their card cannot be read, or do not belong together."""
class InvalidScene(KirigamiError):
    """A scene, or a file that it names, is not valid; the message names the file and the key."""
class InvalidDesign(KirigamiError):
    """A design has no sheet: its cuts or its ligaments cannot exist."""
class NoEquilibrium(KirigamiError):
    """No equilibrium was found at full load."""
class SingularTangent(KirigamiError):
    """The tangent of the equilibrium is singular, as at a limit point: the gradient does not exist."""

@final
class Surrogate:
    """The learned energy of a hinge, W(a, s, theta; w_lig, alpha), with its continuation outside the
    training domain.

    Units are mm, N, N mm and rad.

    >>> film = kirigami.Surrogate.load("data/pet-0.5mm/medium.safetensors")
    >>> film([0.0, 0.0, 0.5], w_lig=18.0, alpha=1.2).energy"""

    def __new__(cls, weights: _Path, ensemble: Sequence[_Path] = ...) -> Surrogate: ...
    @staticmethod
    def load(weights: _Path, ensemble: Sequence[_Path] = ...) -> Surrogate:
        """The same as `Surrogate(weights, ensemble)`."""
    @property
    def card(self) -> dict[str, Any]:
        """The card of the weights: units, scaling, training data, training domain, test errors."""
    def hinges(self, w_lig: ArrayLike, alpha: ArrayLike, hole: ArrayLike | None = None) -> Hinges:
        """Hinges prepared for evaluation.

        w_lig: ligament width (mm), a number or an array of the shape of the hinges; alpha: cut
        angle (rad), likewise; hole: radius of the hole over w_lig, by default the hole of reference
        on the card of the weights."""
    def __call__(
        self,
        states: ArrayLike,
        w_lig: ArrayLike,
        alpha: ArrayLike,
        hole: ArrayLike | None = None,
        order: _Order = "tangent",
    ) -> HingeStates:
        """States (a, s, theta) (mm, mm, rad), shape (..., 3), at ligament widths (mm), cut angles (rad) and holes (radius over
        w_lig). order: what is evaluated, up to `value`, `forces` or `tangent`; `design` adds the derivatives in the design."""

@final
class Hinges:
    """Hinges of given designs, prepared once for any number of evaluations."""

    @property
    def shape(self) -> list[int]:
        """The shape of the hinges."""
    def __call__(self, states: ArrayLike, order: _Order = "tangent") -> HingeStates:
        """States (a, s, theta) (mm, mm, rad), shape (..., 3). order: as of `Surrogate`."""

@final
class HingeStates:
    """Hinges in given states. Energy, forces and tangent are evaluated by the call; damage, depth and
    spread when they are read."""

    @property
    def energy(self) -> _Doubles:
        """W (N mm), of the shape of the hinges."""
    @property
    def forces(self) -> _Doubles:
        """(F_a, F_s, M_theta) = dW/d(a, s, theta) (N, N, N mm), shape (..., 3)."""
    @property
    def tangent(self) -> _Doubles:
        """d2W/d(a, s, theta)^2, shape (..., 3, 3)."""
    @property
    def by_design(self) -> _Doubles:
        """dW/d(w_lig, alpha, hole) at constant (a, s, theta), shape (..., 3)."""
    @property
    def forces_by_design(self) -> _Doubles:
        """d2W/d(a, s, theta)d(w_lig, alpha, hole), shape (..., 3, 3)."""
    @property
    def damage(self) -> _Doubles:
        """D, the mean plastic strain of the ligament over that at fracture; nan outside the training
        domain, where it is unknown."""
    @property
    def damage_peak(self) -> _Doubles:
        """D_peak, the damage of the most strained 1 % of the ligament: it tears at 1. nan outside the
        training domain, and if the weights do not predict it."""
    @property
    def depth(self) -> _Doubles:
        """Depth in the training domain: 1 at its centre, 0 at its edge, negative outside."""
    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether each state, the width, the angle and the hole of its hinge are inside the training
        domain (bool)."""
    @property
    def spread(self) -> _Doubles:
        """Standard deviation over the networks of the ensemble of (W, F_a, F_s, M_theta), shape (...,
        4)."""

@final
class Pattern:
    """A cut pattern that deploys rigidly, (2)-(5), of m x n panels.

    Pattern(m, n, corners, r=None, tau=None)

    corners: SW, SE, NE, NW of the outline (mm), shape (4, 2), or its (width, height), shape (2,);
    r: void aspect ratios of the interior cuts in (0, 1), row by row, shape ((m-1)(n-1),), by
    default 1/2; tau: positions of the cuts on the edges bottom, right, top, left as fractions of
    the edge, shape (2(m-1) + 2(n-1),), by default evenly spaced."""

    def __new__(cls, m: int, n: int, corners: ArrayLike, r: ArrayLike | None = None, tau: ArrayLike | None = None) -> Pattern: ...
    @property
    def r(self) -> _Doubles:
        """Void aspect ratios of the interior cuts, row by row."""
    @property
    def tau(self) -> _Doubles:
        """Positions of the cuts on the edges bottom, right, top, left, as fractions of the edge."""
    @property
    def hinges(self) -> int:
        """Number of hinges."""

@final
class Sheet:
    """A flat sheet: rigid panels joined by ligaments.

    Sheet(pattern, w_lig, slit_width=0.2)

    w_lig: ligament widths (mm), a number or an array of shape (hinges,); slit_width: width of the
    slits (mm)."""

    def __new__(cls, pattern: Pattern, w_lig: ArrayLike, slit_width: float = 0.2) -> Sheet: ...
    @property
    def corners(self) -> _Doubles:
        """Corners SW, SE, NE, NW of every panel (mm), row by row, shape (panels, 4, 2)."""
    def boundaries(self, configuration: ArrayLike | None = None) -> list[_Doubles]:
        """The polygons that the panels are (mm), one array of shape (points, 2) a panel: the corners of
        its cell, unless it is trimmed. With a configuration, the motions of the panels, deployed."""
    @property
    def references(self) -> _Doubles:
        """The points of the panels whose motions are (u_x, u_y): centroids, or where a panel is held
        or pulled (mm), shape (panels, 2)."""
    @property
    def hinge_panels(self) -> list[list[int]]:
        """The two panels A and B of every hinge, shape (hinges, 2)."""
    @property
    def tips(self) -> _Doubles:
        """The tips O of the main cuts (mm), shape (hinges, 2)."""
    @property
    def w_lig(self) -> _Doubles:
        """Ligament widths (mm), shape (hinges,)."""
    @property
    def alpha(self) -> _Doubles:
        """Cut angles alpha (rad), shape (hinges,)."""
    @property
    def outline(self) -> list[tuple[int, int]]:
        """Indices (panel, corner) of the corners on the outline, counter-clockwise, into `corners`."""
    def deploy(self, opening: float) -> tuple[_Doubles, _Doubles]:
        """The kinematic deployment with every hinge open by `opening` (rad): motions (u_x, u_y, phi)
        of the panels (mm, mm, rad), shape (panels, 3), and their corners, shape (panels, 4, 2)."""

@final
class Deployment:
    """A deployed sheet with its path. All arrays begin with the load steps; with pins there is a
    single one."""

    @property
    def status(self) -> list[str]:
        """How each load step ended: `converged`, `left-domain` (with hinges outside the training
        domain), `almost`, `limit-point` (the sheet jumped to another branch) or `diverged` (no
        equilibrium was found: the path ends)."""
    @property
    def followed(self) -> bool:
        """Whether the path was followed from the flat sheet; False if it was corrected from a path
        near it."""
    @property
    def load_factor(self) -> _Doubles:
        """zeta of every load step."""
    @property
    def residual(self) -> _Doubles:
        """Maximum unbalanced force over the maximum force, per load step."""
    @property
    def potential(self) -> _Doubles:
        """Pi of (10) (N mm), per load step."""
    @property
    def configuration(self) -> _Doubles:
        """Motions (u_x, u_y, phi) of the panels (mm, mm, rad), shape (steps, panels, 3)."""
    @property
    def corners(self) -> _Doubles:
        """Corners SW, SE, NE, NW of the panels (mm), shape (steps, panels, 4, 2)."""
    @property
    def deformation(self) -> _Doubles:
        """(a, s, theta) of the hinges (mm, mm, rad), shape (steps, hinges, 3)."""
    @property
    def energy(self) -> _Doubles:
        """Energies of the hinges, contact included (N mm), shape (steps, hinges)."""
    @property
    def damage(self) -> _Doubles:
        """D of the hinges, shape (steps, hinges); nan where it is unknown: outside the training
        domain, or without a learned law."""
    @property
    def damage_peak(self) -> _Doubles:
        """D_peak of the hinges, shape (steps, hinges): a ligament tears at 1; nan where it is not
        known."""
    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether each hinge is inside the training domain, shape (steps, hinges)."""
    @property
    def reactions(self) -> _Doubles:
        """Forces (F_x, F_y, M) by which the supports hold the panels at full load (N, N, N mm), shape
        (panels, 3); zero where a panel is free."""
    @property
    def sheet(self) -> Sheet:
        """The flat sheet."""
    def __len__(self) -> int: ...

@final
class State:
    """The equilibrium at full load."""

    @property
    def corners(self) -> _Doubles:
        """Deployed corners SW, SE, NE, NW of the panels (mm), shape (panels, 4, 2)."""
    @property
    def reactions(self) -> _Doubles:
        """Forces (F_x, F_y, M) by which the supports hold the panels (N, N, N mm), shape (panels, 3);
        zero where a panel is free."""
    @property
    def load_factor(self) -> float:
        """zeta: 1 under dead loads; under a prescribed stroke the load over the load of the scene."""
    @property
    def configuration(self) -> _Doubles:
        """Motions (u_x, u_y, phi) of the panels (mm, mm, rad), shape (panels, 3)."""
    @property
    def deformation(self) -> _Doubles:
        """(a, s, theta) of the hinges (mm, mm, rad), shape (hinges, 3)."""
    @property
    def status(self) -> str:
        """How the state was found, as in `Deployment.status`."""
    @property
    def followed(self) -> bool:
        """Whether the path to the state was followed from the flat sheet; False if the state was
        corrected from one near it."""
    @property
    def sheet(self) -> Sheet:
        """The flat sheet."""

@final
class Problem:
    """A design problem: sheet, material, supports, loads, target and objective of a scene.

    Problem(scene, folder=None)

    scene: the file of a scene (TOML), the folder of a run, or a dict with the keys of a scene
    (docs/KEYS.md), whose paths are relative to `folder`, by default the working folder. A design is
    a vector x of `size` numbers; `blocks` names its parts. Units are mm, N, N mm and rad."""

    def __new__(
        cls, scene: _Path | dict[str, Any], folder: _Path | None = None, level: str | None = None
    ) -> Problem: ...
    @property
    def size(self) -> int:
        """Number of design variables."""
    @property
    def start(self) -> _Doubles:
        """The start design of the scene, shape (size,)."""
    @property
    def blocks(self) -> dict[str, slice]:
        """The parts of a design by name, as slices: `z`, the logits of the void aspect ratios; `ell`,
        the logits of the intervals between the cuts on the edges; `omega`, the logits of the
        ligament widths in their range; `opening` (rad), if it is a design variable."""
    @property
    def panels(self) -> tuple[int, int]:
        """Panels along x and y."""
    @property
    def thickness(self) -> float:
        """Thickness of the sheet (mm)."""
    @property
    def loads(self) -> _Doubles:
        """(F_x, F_y, M) on every panel at full load (N, N, N mm), shape (panels, 3)."""
    @property
    def differentiable(self) -> list[str]:
        """Names of the inputs in which the equilibrium has a derivative: the design, the loads and, if
        the hinge law determines them, the thickness and the stresses."""
    def with_widths(self, x: ArrayLike, w_lig: ArrayLike) -> _Doubles:
        """The design with other ligament widths (mm), a number or an array of shape (hinges,), inside
        the range of the scene."""
    def sheet(self, x: ArrayLike) -> Sheet:
        """The flat sheet of a design."""
    def deploy(
        self, x: ArrayLike, loads: ArrayLike | None = None, thickness: float | None = None, stress: float = 1.0, warm: bool = True
    ) -> Deployment:
        """The deployed sheet with its path, which ends early where no equilibrium is found; with pins
        the kinematic deployment.

        loads: (F_x, F_y, M) on every panel, shape (panels, 3), instead of the scene's; thickness
        (mm) instead of the scene's; stress: all stresses at equal strain over the stresses of the
        material; warm: correct the path from the last one if that is near, instead of following it
        from the flat sheet."""
    def equilibrium(
        self, x: ArrayLike, loads: ArrayLike | None = None, thickness: float | None = None, stress: float = 1.0, warm: bool = True
    ) -> Deployment:
        """The same as `deploy`, but NoEquilibrium is raised if none was found at full load."""
    def solve(
        self, x: ArrayLike, loads: ArrayLike | None = None, thickness: float | None = None, stress: float = 1.0, warm: bool = True
    ) -> State:
        """Only the equilibrium at full load: deployed corners, reactions, load factor. It costs a
        fraction of the path."""
    def solve_many(
        self,
        x: ArrayLike,
        loads: ArrayLike | None = None,
        thickness: ArrayLike | None = None,
        stress: ArrayLike | None = None,
        strict: bool = True,
    ) -> list[Any]:
        """Many equilibria at full load in one call, over all threads: x of shape (n, size) or (size,),
        loads of shape (n, panels, 3) or (panels, 3), thickness and stress of shape (n,) or numbers.
        All start from the last state of the problem.

        Returns a list of n states. strict: the first equilibrium that is not found is raised;
        otherwise its place holds the exception."""
    def pullback(
        self,
        x: ArrayLike,
        configuration: ArrayLike,
        corners: ArrayLike,
        reactions: ArrayLike,
        load_factor: float,
        loads: ArrayLike | None = None,
        thickness: float | None = None,
        stress: float = 1.0,
    ) -> dict[str, Any]:
        """The gradient in the inputs of a function of the equilibrium at full load, from its gradient
        in the outputs: the implicit derivative, by one adjoint solve.

        configuration: the configuration of the state that `solve` found with the same inputs;
        corners, reactions, load_factor: the gradient in these outputs, of their shapes. Returns a
        dict: `design` (size,), `loads` (panels, 3), and `thickness` (1/mm) and `stress`, which are
        None where the hinge law does not determine them."""
    def loss_and_gradient(self, x: ArrayLike, warm: bool = True) -> tuple[float, _Doubles]:
        """The objective (16) of the scene (mm^2) and its gradient, shape (size,)."""
    def terms(self, x: ArrayLike, warm: bool = True) -> dict[str, float]:
        """The terms of the objective by name, unweighted."""
    def design(
        self,
        start: ArrayLike | None = None,
        steps: int | None = None,
        method: Literal["adam", "lbfgs"] | None = None,
        learning_rate: float | None = None,
        callback: Callable[[dict[str, Any]], Any] | None = None,
    ) -> tuple[_Doubles, Any, list[dict[str, Any]]]:
        """The search of the scene, Algorithm 1, in memory: no file is written.

        callback: called after every step with a dict (step, loss, outline_error, the terms, ...);
        the search ends if it returns True. Ctrl-C ends it after the step. Returns (x, why it ended,
        the history, one dict a step)."""
    def stored(self, file: _Path | None = None) -> _Doubles:
        """The design of the run of this scene, or in a file (`state.json` of a run, or a design
        alone), shape (size,)."""
    def write(self, x: ArrayLike, folder: _Path, force: bool = False) -> dict[str, Any]:
        """Writes a design to a folder as `kirigami design` does, with pictures as SVG alone: cut files,
        report, page, mounting kit. An earlier run in the folder is replaced. `force` writes the cut
        files even if the report has errors. Returns the report, `report.json`."""
    def forget(self) -> None:
        """Forgets the last states: the next solves follow their paths from the flat sheet."""
