"""The files of kirigami: scenes as dicts, run folders, databases. They are open formats, read here by their usual libraries."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np


def read_scene(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The keys of a scene file (docs/KEYS.md) as a dict, to be changed and given to `Problem(keys, folder=Path(path).parent)`."""
    try:
        import tomllib
    except ModuleNotFoundError:  # before Python 3.11
        import tomli as tomllib  # type: ignore[import-not-found, no-redef]

    with open(path, "rb") as file:
        return tomllib.load(file)


def read_database(path: str | os.PathLike[str], library: str = "polars") -> Any:
    """A database of hinge states (Parquet) as a frame of Polars or of pandas, which read it themselves.

    One row is a converged increment of a ray; the manifest next to it (`X.json`) holds units, counts and split.
    """
    if library == "polars":
        import polars

        return polars.read_parquet(Path(path))
    if library == "pandas":
        import pandas  # type: ignore[import-untyped]

        return pandas.read_parquet(path)
    raise ValueError(f'`library` is "{library}", expected "polars" or "pandas"')


@dataclass(frozen=True)
class Run:
    """The folder of a design run. `Problem(run.folder)` is its problem, from the copies of its inputs."""

    folder: Path

    @staticmethod
    def read(folder: str | os.PathLike[str]) -> Run:
        """The run in a folder; FileNotFoundError if it has no state."""
        folder = Path(folder)
        if not (folder / "state.json").exists():
            raise FileNotFoundError(f"{folder} has no state.json: it is not the folder of a run")
        return Run(folder)

    @property
    def state(self) -> dict[str, Any]:
        """The state of the search."""
        return self._read("state.json")

    @property
    def history(self) -> list[dict[str, Any]]:
        """One dict a step: loss, outline error and terms; `polars.DataFrame(run.history)` is a table."""
        return self.state["history"]

    @property
    def design(self) -> np.ndarray:
        """The best design, as the vector x of the problem."""
        best = self.state["best"]
        parts = [best["pattern"]["z"], *best["pattern"]["ell"], best["omega"]]
        if best.get("opening") is not None:
            parts.append([best["opening"]])
        return np.concatenate([np.asarray(part, dtype=float) for part in parts])

    @property
    def report(self) -> dict[str, Any]:
        """`report.json`."""
        return self._read("report.json")

    def _read(self, name: str) -> dict[str, Any]:
        with open(self.folder / name, encoding="utf-8") as file:
            return json.load(file)


def _json(keys: dict[str, Any]) -> str:
    """The keys of a scene as JSON; arrays, numbers of NumPy and paths are written as lists, numbers and text."""

    def plain(value: Any) -> Any:
        if isinstance(value, (np.ndarray, np.generic)):
            return value.tolist()
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        raise TypeError(f"{value!r} of type {type(value).__name__} cannot be the value of a key of a scene")

    return json.dumps(keys, default=plain)
