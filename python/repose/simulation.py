"""Simulations of scenes by the Material Point Method, step by step."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, arguments
from .columns import Columns
from .inputs import Source, document, open_input, refused
from .maps import Maps

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Points:
    """The material points at one moment, in the order of their creation; copies.

    D axes (2 in plane strain, 3 in space), C = 4 or 6 components (xx, yy, zz, xy, yz, zx), tension
    positive. In plane strain masses are per metre of depth.
    """

    id: np.ndarray  #: (n,) a point's name for life
    body: np.ndarray  #: (n,) index of its body
    position: np.ndarray  #: (n, D) m
    velocity: np.ndarray  #: (n, D) m/s
    velocity_gradient: np.ndarray  #: (n, D, D) dv_i/dx_j, 1/s
    stress: np.ndarray  #: (n, C) the point's own, Pa
    density: np.ndarray  #: (n,) kg/m3
    mass: np.ndarray  #: (n,) kg/m or kg
    state: np.ndarray  #: (n, variables) of its law; nan where its law has fewer

    @property
    def pressure(self) -> np.ndarray:
        """(n,) mean pressure, compression positive, Pa."""
        return -self.stress[:, :3].mean(axis=1)

    def __len__(self) -> int:
        return len(self.id)

    def __repr__(self) -> str:
        return f"<{len(self)} points in {self.position.shape[1]} dimensions>"


@dataclass(frozen=True)
class Nodes:
    """The grid's nodes in the last step; copies. Zero where no point is near.

    The mass behind a wall is added to the node it mirrors, so that the sum is that of the points
    (but for what hangs over an open edge). Across a periodic edge the last node is the first, and
    empty.

    Node [i, j] (or [i, j, k]) lies at h i, h j.
    """

    h: float  #: cell size, m
    mass: np.ndarray  #: (nx+1, ny+1[, nz+1]) kg/m or kg
    velocity: np.ndarray  #: (nx+1, ny+1[, nz+1], D) after forces and walls, m/s

    @property
    def momentum(self) -> np.ndarray:
        """(nx+1, ny+1[, nz+1], D) mass times velocity, kg/s or kg m/s."""
        return self.mass[..., np.newaxis] * self.velocity

    def __repr__(self) -> str:
        return f"<grid of {' x '.join(str(n) for n in self.mass.shape)} nodes, h = {self.h:g} m>"


class Simulation:
    """A scene that is stepped from Python.

        sim = Simulation("flat_mu_i", grid={"h": 0.0125})
        while sim.time < sim.end_time:
            sim.step(until=sim.time + 0.05)
            print(sim.time, sim.diagnostics()["front_99_m"])

    scene: a dictionary, the path of a file, or the name of a shipped scene (`shipped_scenes()`).
    law: stands in for the law of every body. threads: 0 for all cores; results do not depend on it.
    Keyword arguments change keys: grid={"h": 0.0125}, **{"body[0].law.K": 26e3}.

    Long calls leave the interpreter's lock to other threads. Ctrl-C stops between two steps with
    KeyboardInterrupt, and the simulation can go on or be saved.
    """

    def __init__(self, scene: Source, /, law: Any = None, *, threads: int = 0, **changes: Any) -> None:
        threads = arguments.whole("Simulation: threads", threads)
        self._sim = _core.Simulation(open_scene(scene, law, changes), threads)

    def step(self, until: float | None = None, steps: int | None = None) -> float:
        """Takes `steps` steps (1), or as many as lead exactly to the time `until` [s]; returns the
        time.

        Raises NumericalFailure where the integration diverges.
        """
        if until is not None and steps is not None:
            raise refused("step: give until, a time, or steps, a number; not both")
        if until is None:
            count = 1 if steps is None else arguments.whole("step: steps", steps, below=2**63)
            self._sim.advance(np.inf, count)
        else:
            until = arguments.number("step: until", until)
            if not until >= self.time:
                raise refused(f"step: until = {until} s must not lie before the time of the "
                              f"simulation, {self.time} s")
            self._sim.advance(until, np.iinfo(np.int64).max)
        return self.time

    def run(self) -> float:
        """Goes on to the scene's end_time."""
        return self.step(until=self.end_time)

    @property
    def name(self) -> str:
        """The scene's name."""
        return self._sim.name

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._sim.time

    @property
    def end_time(self) -> float:
        """Where the scene ends [s]; steps may go beyond."""
        return self._sim.end_time

    @property
    def steps(self) -> int:
        """Steps so far."""
        return self._sim.steps

    @property
    def next_dt(self) -> float:
        """The step that the next call would take [s]."""
        return self._sim.next_dt

    @property
    def h(self) -> float:
        """Cell size [m]."""
        return self._sim.h

    @property
    def domain(self) -> tuple[float, ...]:
        """Extent of the box along each axis [m]."""
        return tuple(self._sim.domain)

    @property
    def dimensions(self) -> int:
        """2 in plane strain, 3 in space."""
        return self._sim.dimensions

    @property
    def points(self) -> Points:
        """The material points as they are: a copy."""
        return Points(**self._sim.points())

    @property
    def nodes(self) -> Nodes:
        """The grid in the last step: a copy."""
        return Nodes(h=self.h, **self._sim.nodes())

    def diagnostics(self) -> dict[str, float]:
        """A row of series.csv: front, height, energies, ..."""
        return self._sim.diagnostics()

    def profile(self) -> Columns:
        """Solid depth over x: x_m, depth_m."""
        x, depth = self._sim.profile()
        return Columns({"x_m": x, "depth_m": depth}, "profile")

    def maps(self) -> Maps:
        """The maps of a flow over a terrain up to now: largest_depth, largest_speed, arrival_time,
        deposit, on the cells of the ground's map. Raises InputError for a scene without one."""
        return Maps.of_rasters(self._sim.maps(), f"{self.name} at {self.time:g} s")

    @property
    def notes(self) -> list[str]:
        """What was made of the input that one may not expect."""
        return self._sim.notes

    @property
    def warnings(self) -> list[str]:
        """What one should know of the run so far."""
        return self._sim.warnings

    @property
    def gravity(self) -> float:
        """Gravity [m/s2], downwards. It may be changed while the simulation goes on; the potential
        energy that the points gain by that counts in the ledger as there from the start."""
        return self._sim.gravity

    @gravity.setter
    def gravity(self, gravity: float) -> None:
        self._sim.set_gravity(arguments.number("gravity", gravity), self.tilt_deg)

    @property
    def tilt_deg(self) -> float:
        """Tilt of the box, towards +x [degrees]; may be changed like gravity."""
        return self._sim.tilt_deg

    @tilt_deg.setter
    def tilt_deg(self, tilt_deg: float) -> None:
        self._sim.set_gravity(self.gravity, arguments.number("tilt_deg", tilt_deg))

    def set_wall(self, edge: str, wall: str | Mapping | Sequence[Mapping]) -> None:
        """Goes on with another edge: "floor", "left", "right", "top" ("near", "far"); wall as in
        [domain], "slip", "no_slip", "open", {"friction": 0.4}, {"speed": 0.1}, or a list of parts."""
        arguments.text("set_wall: edge", edge)
        if not isinstance(wall, (str, list, tuple)):
            arguments.table("set_wall: wall, unless a text,", wall)
        text = document({"domain": {edge: wall}})
        self._sim.set_wall(edge, _core.Input.table(text, "set_wall", []))

    def save(self, file: str | os.PathLike) -> None:
        """Saves the whole state: FILE, a checkpoint, and beside it FILE.toml, the scene as it is
        now. `Simulation.load` goes on from them with the same bits. Where it fails, what was there
        stays."""
        arguments.path("save: file", file)
        path, scene = Path(file), _scene_beside(file)
        if path.name == "" or path.is_dir():
            raise IsADirectoryError(f"save: {os.fspath(file)!r} is a folder; a file is needed")
        fresh = scene.with_name(scene.name + ".part")
        fresh.write_text(self._sim.resolved(f"The scene of {path.name}, at t = {self.time!r} s"),
                         encoding="utf-8")
        try:
            self._sim.save(os.fspath(path))
        except BaseException:
            fresh.unlink()
            raise
        fresh.replace(scene)

    @classmethod
    def load(cls, file: str | os.PathLike, *, threads: int = 0) -> "Simulation":
        """The simulation that was saved. Raises OSError where the files are none of `save`."""
        path = Path(arguments.path("load: file", file))
        threads = arguments.whole("load: threads", threads)
        simulation = cls(_scene_beside(path), threads=threads)
        simulation._sim.load(os.fspath(path))
        return simulation

    def __copy__(self) -> "Simulation":
        raise TypeError("a simulation is not copied: save() it and load() another")

    def __deepcopy__(self, memo: dict) -> "Simulation":
        return self.__copy__()

    def __reduce__(self) -> tuple:
        raise TypeError("a simulation is not pickled: save() it to a file and load() that, or pickle what "
                        "was taken from it: points, diagnostics()")

    def picture(self, file: str | os.PathLike) -> bool:
        """Draws the picture of `repose run`, an SVG, with gnuplot; False if there is nothing."""
        return self._sim.picture(arguments.path("picture: file", file))

    def plot(self, colour: str = "speed") -> "Figure":
        """A matplotlib figure of the points, coloured by "speed", "pressure" or "density"."""
        from .plotting import heap_figure
        return heap_figure(self, colour)

    def __repr__(self) -> str:
        return (f"<simulation {self.name!r}: {self._sim.point_count} points, h = {self.h:g} m, "
                f"t = {self.time:.6g} of {self.end_time:g} s, {self.steps} steps>")


def _scene_beside(file: str | os.PathLike) -> Path:
    return Path(os.fspath(file) + ".toml")


def open_scene(scene: Source, law: Any, changes: Mapping) -> _core.Input:
    """A scene whose bodies all have the given law; one that is a dictionary without a name changes
    keys of their own."""
    if law is None:
        return open_input("scene", scene, changes)
    count = open_input("scene", scene, {}).count("body")
    if isinstance(law, Mapping) and "name" not in law:
        of_bodies = {f"body[{i}].law.{key}": x for i in range(count) for key, x in law.items()}
        return open_input("scene", scene, {**of_bodies, **changes})
    return open_input("scene", scene, changes, placed={f"body[{i}].law": law for i in range(count)})


def estimate(scene: Source, /, **changes: Any) -> dict[str, float]:
    """What running a scene will take, as `repose check` says: points, live_cells, first_dt_s,
    steps, memory_MB, wall_s."""
    return _core.estimate(open_input("scene", scene, changes))
