"""Figures with matplotlib, in the style of the program's own pictures."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .fitting import FitResult
    from .maps import Map
    from .point_test import PointResult
    from .result import Result
    from .simulation import Simulation

# The palette of Okabe & Ito (2008), told apart with every kind of colour blindness.
_COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f"]
_STYLE: dict[str, Any] = {
    "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.8, "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "lines.linewidth": 1.6,
    "font.size": 9.0, "axes.titlesize": 9.5, "axes.titlelocation": "left", "legend.frameon": False,
    "figure.constrained_layout.use": True, "svg.hashsalt": "repose",
}


@contextlib.contextmanager
def style() -> Iterator[None]:
    """The style of the figures, for figures of one's own: `with style(): ...`."""
    import matplotlib
    with matplotlib.rc_context({**_STYLE, "axes.prop_cycle": matplotlib.cycler(color=_COLOURS)}):
        yield


@contextlib.contextmanager
def _panels(title: str, rows: int, columns: int, width: float = 4.2,
            height: float = 3.2) -> Iterator[tuple["Figure", list["Axes"]]]:
    from matplotlib.figure import Figure
    with style():
        figure = Figure(figsize=(width * columns, height * rows))
        axes = figure.subplots(rows, columns, squeeze=False)
        figure.suptitle(title, x=0.01, ha="left", fontsize=10.5)
        yield figure, list(axes.flat)


#: Pairs of columns that a point test is drawn in, where it has them.
_PAIRS = [("p_Pa", "q_Pa"), ("eps_a", "q_Pa"), ("gamma", "tau_Pa"), ("eps_a", "u_Pa"),
          ("eps_a", "eps_v"), ("gamma", "eps_v"), ("sigma_a_Pa", "v"), ("I", "mu"), ("p_Pa", "v")]
_LABELS = {"p_Pa": "p′ (kPa)", "q_Pa": "q (kPa)", "tau_Pa": "τ (kPa)", "u_Pa": "u (kPa)",
           "sigma_a_Pa": "σ′_a (kPa)", "eps_a": "ε_a (%)", "eps_v": "ε_v (%)", "gamma": "γ (%)",
           "v": "v", "I": "I", "mu": "μ"}


def _shown(name: str, values: np.ndarray) -> np.ndarray:
    """Stresses in kPa, strains in per cent."""
    return values / 1e3 if name.endswith("_Pa") else \
        values * 100.0 if name.startswith("eps") or name == "gamma" else values


def _moves(values: np.ndarray) -> bool:
    finite = values[np.isfinite(values)]
    return finite.size > 1 and np.ptp(finite) > 1e-9 * max(np.max(np.abs(finite)), 1e-12)


def point_figure(test: "PointResult") -> "Figure":
    """q over p′, q over the strain, and what else moves, four panels at most."""
    pairs = [(x, y) for x, y in _PAIRS if x in test.columns and y in test.columns
             and _moves(test[x]) and _moves(test[y])]
    pairs = [(x, y) for x, y in pairs if "gamma" not in test.columns or x != "eps_a"][:4]
    with _panels(f"{test.name}: {test.law}", -(-max(len(pairs), 1) // 2),
                 min(max(len(pairs), 1), 2)) as (figure, panels):
        for axes, (x, y) in zip(panels, pairs):
            axes.plot(_shown(x, test[x]), _shown(y, test[y]))
            axes.set_xlabel(_LABELS[x])
            axes.set_ylabel(_LABELS[y])
            if (x, y) == ("I", "mu") or y == "v":
                axes.set_xscale("log")
        for axes in panels[len(pairs):]:
            axes.set_axis_off()
    return figure


def fit_figure(fit: "FitResult") -> "Figure":
    """Measured rows and fitted ones, a panel per target and channel."""
    rows = fit.predictions
    key = [f"{t}|{x}|{c}" for t, x, c in zip(rows["target"], rows["x_name"], rows["channel"])]
    names = list(dict.fromkeys(key))
    columns = min(len(names), 3)
    with _panels(fit.name, -(-len(names) // columns), columns) as (figure, panels):
        for axes, name in zip(panels, names):
            chosen = np.array([k == name for k in key])
            target, x_name, channel = name.split("|")
            x = _shown(x_name, rows["x"][chosen])
            axes.plot(x, _shown(channel, rows["measured"][chosen]), "o", mfc="none", ms=4,
                      label="measured")
            axes.plot(x, _shown(channel, rows["fitted"][chosen]), label="fitted")
            axes.set_title(target)
            axes.set_xlabel(_LABELS.get(x_name, x_name))
            axes.set_ylabel(_LABELS.get(channel, channel))
            axes.legend()
        for axes in panels[len(names):]:
            axes.set_axis_off()
    return figure


def _heap(axes: "Axes", x: np.ndarray, y: np.ndarray, value: np.ndarray, label: str) -> None:
    # as the program's picture: a few extreme values must not take up the colours
    low, high = np.percentile(value, [0.5, 99.5]) if len(value) else (0.0, 1.0)
    drawn = axes.scatter(x, y, c=value, s=3, linewidths=0, cmap="viridis", vmin=low, vmax=high)
    axes.figure.colorbar(drawn, ax=axes, label=label, orientation="horizontal", fraction=0.08)
    axes.set_aspect("equal")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")


def heap_figure(simulation: "Simulation", colour: str = "speed") -> "Figure":
    """The points of a simulation in their box."""
    points = simulation.points
    values = {"speed": (np.linalg.norm(points.velocity, axis=1), "speed (m/s)"),
              "pressure": (points.pressure / 1e3, "pressure (kPa)"),
              "density": (points.density, "density (kg/m³)")}
    if colour not in values:
        from .names import nearest
        raise nearest(colour, values, "points are not coloured by")
    value, label = values[colour]
    with _panels(f"{simulation.name}, t = {simulation.time:.3g} s", 1, 1, 6.4, 3.6) as (figure, panels):
        _heap(panels[0], points.position[:, 0], points.position[:, 1], value, label)
        panels[0].set_xlim(0.0, simulation.domain[0])
        panels[0].set_ylim(0.0, simulation.domain[1])
    return figure


def result_figure(result: "Result") -> "Figure":
    """What a result folder holds: a run's last frame, series and profile; else its first table."""
    if "series" in result.tables:
        return _run_figure(result)
    table = result.table(result.tables[0]) if result.tables else None
    if table is None:
        raise ValueError(f"{result.folder}: there is no table to draw")
    numbers = [n for n in table.names if table[n].dtype != object and _moves(table[n])]
    if len(numbers) < 2:
        raise ValueError(f"{result.folder}: {result.tables[0]} has no two columns to draw")
    with _panels(result.name, 1, 1) as (figure, panels):
        panels[0].plot(table[numbers[0]], table[numbers[1]], "o-", ms=3)
        panels[0].set_xlabel(numbers[0])
        panels[0].set_ylabel(numbers[1])
    return figure


def _run_figure(result: "Result") -> "Figure":
    series = result.table("series")
    maps = [drawn for name, drawn in result.maps.items() if name in ("largest_depth", "deposit")]
    profile = result.table("profile") if "profile" in result.tables and not maps else None
    last = result.frames[-1] if len(result.frames) else None
    panels_wanted = 2 + len(maps) + (profile is not None) + (last is not None and not maps)
    with _panels(result.name, -(-panels_wanted // 2), 2) as (figure, panels):
        left = iter(panels)
        axes = next(left)
        for name in ("runout_99_m", "runout_max_m") if maps else ("front_99_m", "height_m"):
            axes.plot(series["time_s"], series[name], label=name.removesuffix("_m"))
        axes.set_xlabel("t (s)")
        axes.set_ylabel("m")
        axes.legend()
        axes = next(left)
        for name in series.names:
            if name.startswith(("kinetic_J", "potential_J", "dissipated_J")):
                axes.plot(series["time_s"], series[name], label=name.split("_")[0])
        axes.set_xlabel("t (s)")
        axes.set_ylabel("energy (J/m)" if "kinetic_J_per_m" in series.names else "energy (J)")
        axes.legend()
        for drawn in maps:
            drawn.plot(next(left))
        if profile is not None:
            axes = next(left)
            axes.plot(profile["x_m"], profile["depth_m"])
            axes.set_xlabel("x (m)")
            axes.set_ylabel("solid depth (m)")
        if last is not None and not maps:
            position = last["position_m"]
            speed = np.linalg.norm(last["velocity_m_per_s"], axis=1)
            _heap(next(left), position[:, 0], position[:, 1], speed, "speed (m/s)")
        for axes in left:
            axes.set_axis_off()
    return figure


def map_axes(drawn: "Map", axes: "Axes | None", least: float, options: dict[str, Any]) -> "Axes":
    """A map in the axes, or in a figure of its own, with a colour bar."""
    from matplotlib.figure import Figure
    with style():
        if axes is None:
            axes = Figure(figsize=(7.0, 5.0)).subplots()
        figure = axes.get_figure()
        shown = np.where(drawn.values > least, drawn.values, np.nan)
        image = axes.imshow(shown, extent=drawn.extent, **{"interpolation": "nearest", **options})
        axes.grid(False)
        axes.locator_params(axis="x", nbins=4)  # six digits each
        axes.set_xlabel("easting (m)")
        axes.set_ylabel("northing (m)")
        if figure is not None:
            figure.colorbar(image, ax=axes, label=drawn.label, shrink=0.7)
    return axes
