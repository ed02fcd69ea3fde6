"""Pictures of sheets and hinges by matplotlib. Every function draws on the given axes, or on new ones, and returns them."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import pyplot
from matplotlib.collections import PolyCollection

from kirigami._kirigami import Deployment, Sheet, State, Surrogate


def sheet(drawn: Sheet | State | Deployment, values: Any = None, label: str = "", axes: Any = None, **style: Any) -> Any:
    """The panels of a flat sheet, of a state, or of the last step of a deployment; `values`, one a panel, are shown as colours."""
    axes = axes or pyplot.subplots(layout="constrained")[1]
    if isinstance(drawn, Sheet):
        boundaries = drawn.boundaries()
    else:
        boundaries = drawn.sheet.boundaries(drawn.configuration[-1] if isinstance(drawn, Deployment) else drawn.configuration)
    panels = PolyCollection(boundaries, array=values, **{"facecolor": "0.9", "edgecolor": "0.2", "linewidth": 0.6, **style})
    axes.add_collection(panels)
    axes.autoscale_view()
    axes.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    if values is not None:
        axes.figure.colorbar(panels, ax=axes, label=label)
    return axes


def path(deployment: Deployment, axes: Any = None) -> Any:
    """The largest and the root mean square rotation of the hinges over the load factor."""
    axes = axes or pyplot.subplots(layout="constrained")[1]
    theta = np.degrees(deployment.deformation[..., 2])
    axes.plot(deployment.load_factor, np.abs(theta).max(axis=1), marker=".", label="largest")
    axes.plot(deployment.load_factor, np.sqrt(np.mean(theta**2, axis=1)), marker=".", label="root mean square")
    axes.set(xlabel="load factor", ylabel="rotation of the hinges (deg)")
    axes.legend()
    return axes


def rotation(weights: Surrogate, widths: Any, alpha: float = np.pi / 2, most: float = np.pi / 4, axes: Any = None) -> Any:
    """Energy and moment of hinges in pure rotation up to `most` (rad), for ligament widths (mm); dashed outside the training domain."""
    axes = pyplot.subplots(1, 2, figsize=(9, 3.5), layout="constrained")[1] if axes is None else axes
    theta = np.linspace(0.0, most, 91)
    for width in np.atleast_1d(widths):
        states = weights(np.column_stack([0 * theta, 0 * theta, theta]), width, alpha)
        for axis, values in zip(axes, (states.energy, states.forces[:, 2])):
            (line,) = axis.plot(np.degrees(theta), np.where(states.inside, values, np.nan), label=f"{width:g} mm")
            axis.plot(np.degrees(theta), values, linestyle="--", linewidth=0.8, color=line.get_color())
    axes[0].set(xlabel="rotation (deg)", ylabel="W (N mm)")
    axes[1].set(xlabel="rotation (deg)", ylabel="M (N mm)")
    axes[0].legend(title="ligament")
    return axes
