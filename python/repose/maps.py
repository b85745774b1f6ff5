"""Maps of terrains and of what flowed over them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, arguments
from .names import nearest

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: The maps of a run over a terrain, and what their numbers are.
NAMES = {"largest_depth": "largest depth (m)", "largest_speed": "largest speed (m/s)",
         "arrival_time": "arrival (s)", "deposit": "deposit (m)"}


@dataclass(frozen=True)
class Map:
    """Numbers on square cells, north up, with the place that they are of.

        maps = repose.Result("results/valley").maps
        deposit = maps["deposit"]
        deposit.values.max(), deposit.at(640500.0, 5130250.0)
        matplotlib.pyplot.imshow(deposit.values, extent=deposit.extent)
    """

    values: np.ndarray = field(repr=False)  #: (rows, columns), the northernmost row first; nan: no data
    west: float  #: easting of the left edge, m
    south: float  #: northing of the lower edge, m
    cell: float  #: length of a cell's edge, m
    crs: str = field(default="", repr=False)  #: coordinate system as WKT; "" where it is not known
    label: str = ""  #: what the numbers are, with their unit

    @classmethod
    def read(cls, file: str | os.PathLike) -> "Map":
        """An ESRI ASCII grid, or where repose is built with GDAL any raster of one band.

        Raises InputError where the file is no such map, OSError where it cannot be read.
        """
        path = arguments.path("Map.read: file", file)
        return cls(**_core.read_raster(path), label=NAMES.get(Path(path).stem, Path(path).stem))

    @property
    def north(self) -> float:
        """Northing of the upper edge [m]."""
        return self.south + self.cell * self.values.shape[0]

    @property
    def east(self) -> float:
        """Easting of the right edge [m]."""
        return self.west + self.cell * self.values.shape[1]

    @property
    def x(self) -> np.ndarray:
        """(columns,) eastings of the cells' middles [m]."""
        return self.west + self.cell * (np.arange(self.values.shape[1]) + 0.5)

    @property
    def y(self) -> np.ndarray:
        """(rows,) northings of the cells' middles [m], falling."""
        return self.north - self.cell * (np.arange(self.values.shape[0]) + 0.5)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """west, east, south, north [m], as matplotlib's imshow takes it."""
        return self.west, self.east, self.south, self.north

    @property
    def transform(self) -> tuple[float, float, float, float, float, float]:
        """GDAL's geotransform: the corner of column c and row r is at x = t[0] + t[1] c,
        y = t[3] + t[5] r. (Of rasterio: `Affine.from_gdal(*map.transform)`.)"""
        return self.west, self.cell, 0.0, self.north, 0.0, -self.cell

    def at(self, x: float, y: float) -> float:
        """The number of the cell that a place [m] is in; nan outside of the map."""
        column = int(np.floor((arguments.number("at: x", x) - self.west) / self.cell))
        row = int(np.floor((self.north - arguments.number("at: y", y)) / self.cell))
        rows, columns = self.values.shape
        return float(self.values[row, column]) if 0 <= row < rows and 0 <= column < columns else np.nan

    def plot(self, axes: "Axes | None" = None, least: float = 0.0, **options: Any) -> "Axes":
        """Draws it with matplotlib's imshow, which takes the options; numbers of at most `least` are
        left clear."""
        from .plotting import map_axes
        return map_axes(self, axes, least, options)


class Maps(Mapping):
    """Maps by their names: `maps["deposit"]`; those of a folder are read when they are asked for."""

    def __init__(self, sources: Mapping[str, Any], of: str) -> None:
        self._sources = dict(sources)
        self._of = of

    @classmethod
    def of_folder(cls, folder: Path) -> "Maps":
        """Those that a run has left."""
        files = [folder / f"{name}{suffix}" for name in NAMES for suffix in (".asc", ".tif")]
        found = {file.stem: file for file in files if file.is_file()}
        return cls(found, os.fspath(folder))

    @classmethod
    def of_rasters(cls, rasters: Mapping[str, dict], of: str) -> "Maps":
        """Those of a simulation as it is."""
        return cls({name: Map(**raster, label=NAMES[name]) for name, raster in rasters.items()}, of)

    def __getitem__(self, name: str) -> Map:
        try:
            source = self._sources[name]
        except KeyError:
            raise nearest(arguments.text("maps: name", name), list(self), f"{self._of} has no map") from None
        if not isinstance(source, Map):
            source = self._sources[name] = Map.read(source)
        return source

    def __iter__(self) -> Iterator[str]:
        return iter(self._sources)

    def __len__(self) -> int:
        return len(self._sources)

    def __repr__(self) -> str:
        return f"<{len(self)} maps of {self._of}: {', '.join(self)}>"
