"""Result folders as arrays."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, arguments
from .columns import Columns
from .maps import Maps
from .names import nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Frame(Columns):
    """The points at one moment, `time_s`: position_m (n, 3), velocity_m_per_s (n, 3), stress_Pa
    (n, 6) in ParaView's order xx, yy, zz, xy, yz, zx, density_kg_per_m3, pressure_Pa, mises_Pa,
    body."""

    time_s: float  #: simulated time, s


class Frames(Sequence):
    """The frames of a run, read one at a time: `frames[-1]["velocity_m_per_s"]`, `frames.times`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        series = _core.point_series_in(os.fspath(folder))
        self._entries = _core.read_frame_series(series) if series else []

    @property
    def times(self) -> np.ndarray:
        """Their times [s]."""
        return np.array([time for _, time in self._entries])

    def __len__(self) -> int:
        return len(self._entries)

    def __getitem__(self, index: int) -> Frame:  # type: ignore[override]
        name, _ = self._entries[index]
        fields = _core.read_frame(os.fspath(self._folder / name))
        time_s = fields.pop("time_s")
        frame = Frame(fields, name)
        frame.time_s = time_s
        return frame

    def __repr__(self) -> str:
        return f"<{len(self)} frames in {self._folder}>"


class Result:
    """A result folder: `Result("results/flat_mu_i")`.

    Tables are `Columns`, by the names of their files: `series`, `profile`, `curve`,
    `predictions`, ..., or `table("sweep")`. Runs of a sweep or chart are `runs`.
    """

    def __init__(self, folder: str | os.PathLike) -> None:
        self.folder = Path(arguments.path("Result: folder", folder))
        if not (self.folder / "summary.json").is_file() and not (self.folder / "input.toml").is_file():
            raise FileNotFoundError(f"{self.folder}: no result of repose is there (neither "
                                    f"summary.json nor input.toml)")

    @cached_property
    def summary(self) -> dict[str, Any]:
        """summary.json; empty while the work has not come so far."""
        file = self.folder / "summary.json"
        if not file.is_file():
            return {}
        try:
            return json.loads(file.read_text(encoding="utf-8"))
        except json.JSONDecodeError as error:
            raise OSError(f"{file}: is damaged: {error}") from None

    @cached_property
    def input(self) -> dict[str, Any]:
        """input.toml, the input with every default."""
        return tomllib.loads((self.folder / "input.toml").read_text(encoding="utf-8"))

    @property
    def kind(self) -> str:
        """"run", "point_test", "fit", "sweep", ..."""
        return self.summary.get("kind", "run")

    @property
    def status(self) -> str:
        """"done", "failed", ...; without an end, "running" while a process has the folder, and
        "interrupted" after it was stopped or killed. Tables are then readable as far as they were written."""
        noted = self.summary.get("status", "running")
        if noted != "running":
            return noted
        return "running" if self._claimed() else "interrupted"

    def _claimed(self) -> bool:
        """Whether a process that lives has written its number into the folder."""
        try:
            process = int((self.folder / ".repose-lock").read_text(encoding="utf-8"))
            os.kill(process, 0)
        except PermissionError:  # there is such a process, of somebody else
            return True
        except (OSError, ValueError):
            return False
        return True

    @property
    def name(self) -> str:
        """The name of the scene, test or fit."""
        return self.summary.get("name", self.folder.name)

    @property
    def tables(self) -> list[str]:
        """The CSV tables there are, without their suffix."""
        return sorted(file.stem for file in self.folder.glob("*.csv"))

    def table(self, name: str) -> Columns:
        """A CSV table of the folder."""
        file = self.folder / f"{name}.csv"
        if not file.is_file():
            raise nearest(arguments.text("table: name", name), self.tables,
                          f"{self.folder} has no table")
        return Columns.read(file)

    def __getattr__(self, name: str) -> Columns:
        # tables by their names; what is no table is no attribute
        if not name.startswith("_") and name != "folder" and name in self.tables:
            return self.table(name)
        raise AttributeError(f"{self.folder if 'folder' in self.__dict__ else 'a result'} has no "
                             f"table or attribute {name!r}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.tables]

    @cached_property
    def frames(self) -> Frames:
        """The frames of a run."""
        return Frames(self.folder / "frames")

    @cached_property
    def maps(self) -> Maps:
        """The maps of a run over a terrain: `maps["deposit"].values`; largest_depth, largest_speed,
        arrival_time, deposit. Empty of any other."""
        return Maps.of_folder(self.folder)

    @property
    def runs(self) -> list["Result"]:
        """The results in runs/, of a sweep of scenes or a chart."""
        return [Result(folder) for folder in sorted((self.folder / "runs").glob("*"))
                if (folder / "summary.json").is_file()]

    @property
    def fit(self) -> dict[str, Any]:
        """fit.json."""
        return json.loads((self.folder / "fit.json").read_text(encoding="utf-8"))

    def __reduce__(self) -> tuple:
        return Result, (self.folder,)

    def plot(self) -> "Figure":
        """A matplotlib figure of what the folder holds."""
        from .plotting import result_figure
        return result_figure(self)

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name!r} in {self.folder}, {self.status}; " \
               f"tables {', '.join(self.tables)}; {len(self.frames)} frames>"
