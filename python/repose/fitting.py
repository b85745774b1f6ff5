"""Fits of a law's parameters to measured curves."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, arguments
from .columns import Columns
from .inputs import Source, open_input
from .law import Law

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class FitResult:
    """What a fit has found. `report` is fit.json as a dictionary, with all there is."""

    name: str
    status: str  #: "done", "not converged" or "failed"
    report: dict[str, Any] = field(repr=False)
    notes: list[str] = field(repr=False)
    predictions: Columns = field(repr=False)  #: predictions.csv: every row measured and fitted
    fitted_toml: str = field(repr=False)  #: a [law] table with the fitted values

    @cached_property
    def parameters(self) -> dict[str, float]:
        """The fitted values, by name."""
        return {name: p["value"] for name, p in self.report["parameters"].items()}

    @cached_property
    def standard_errors(self) -> dict[str, float]:
        """Their standard errors; None where the data do not determine one."""
        return {name: p["standard_error"] for name, p in self.report["parameters"].items()}

    @cached_property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """The 95 % intervals to quote; nan at an end that the data leave open."""
        return {name: tuple(np.nan if x is None else x for x in p["recommended_95"]["interval"])
                for name, p in self.report["parameters"].items()}

    @cached_property
    def correlation(self) -> np.ndarray:
        """(parameters, parameters), in the order of `parameters`; nan where there is none."""
        return np.array(self.report["correlation"], dtype=float)

    @property
    def objective(self) -> float:
        """The sum of squares of the weighted residuals, as fit.json has it."""
        return self.report["objective"]

    @cached_property
    def law(self) -> Law:
        """The law with the fitted values."""
        return Law(tomllib.loads(self.fitted_toml)["law"])

    def plot(self) -> "Figure":
        """A matplotlib figure: measured and fitted, per target and channel."""
        from .plotting import fit_figure
        return fit_figure(self)

    def __str__(self) -> str:
        lines = [f"{self.name}: {self.status}, objective {self.objective:.6g}"]
        for name, value in self.parameters.items():
            lower, upper = self.intervals[name]
            lines.append(f"  {name:<16} {value:.6g}   95 %: {lower:.6g} to {upper:.6g}")
        return "\n".join(lines)


def fit(source: Source, /, *, output: str | os.PathLike | None = None, seed: int = 1, threads: int = 0,
        progress: Callable[[int, int, float], Any] | None = None, plot: bool = True,
        resume: bool = False, quiet: bool = False, **changes: Any) -> FitResult:
    """Fits a law's parameters to measured curves, as `repose fit` does.

    source: a dictionary with [law], [fit], [[target]], ... or the path of a file. progress(start,
    starts, objective) is called after every start. output: leaves the result folder of the command
    (fit.json, fitted.toml, predictions.csv, pictures); the tables are then read from there.
    Raises InputError; NumericalFailure where no start comes to an end.
    """
    seed = arguments.whole("fit: seed", seed, below=2**64)
    threads = arguments.whole("fit: threads", threads)
    arguments.flags("fit", plot=plot, resume=resume, quiet=quiet)
    arguments.callback("fit: progress", progress)
    folder = None if output is None else arguments.path("fit: output", output)
    given = open_input("fit", source, changes)
    if folder is not None:
        return _in_folder(given, folder, seed, threads, resume, quiet, plot)
    found = _core.solve_fit(given, seed, threads, "", progress)
    if "report" not in found:
        raise _core.NumericalFailure(f"{found['name']}: no start came to an end")
    return FitResult(found["name"], found["status"], json.loads(found["report"]), found["notes"],
                     Columns.parse(found["predictions"], "predictions"), found["fitted_toml"])


def _in_folder(given: _core.Input, folder: str, seed: int, threads: int, resume: bool, quiet: bool,
               plot: bool) -> FitResult:
    from .verbs import _ended
    result = _ended(_core.run_fit(given, given.name, folder, threads, seed, resume, quiet, plot),
                    folder)
    toml_text = (result.folder / "fitted.toml").read_text(encoding="utf-8")
    report = result.fit
    return FitResult(result.name, result.status, report, report.get("notes", []),
                     result.table("predictions"), toml_text)
