"""The compiled part of repose. Written by python/tools/make_stub.py."""

from typing import Any

import numpy
import numpy.typing

class Driven:
    """A point test as it was driven."""
    def column(self: Driven, name: str) -> numpy.ndarray:
        """A column of curve.csv by its name."""
    @property
    def columns(self) -> list[str]: ...
    def csv(self: Driven) -> str:
        """The text of curve.csv."""
    @property
    def density(self) -> numpy.ndarray: ...
    @property
    def dissipated(self) -> numpy.ndarray: ...
    @property
    def failed(self) -> bool: ...
    @property
    def fraction(self) -> float: ...
    def laboratory(self: Driven) -> str:
        """"laboratory" of summary.json, as text."""
    @property
    def notes(self) -> list[str]: ...
    def picture(self: Driven, path: str) -> None:
        """Draws curve.svg with gnuplot."""
    @property
    def reason(self) -> str: ...
    @property
    def rows(self) -> int: ...
    @property
    def state(self) -> numpy.ndarray: ...
    @property
    def status(self) -> str: ...
    @property
    def steps(self) -> int: ...
    @property
    def strain(self) -> numpy.ndarray: ...
    @property
    def stress(self) -> numpy.ndarray: ...
    def summary(self: Driven) -> str:
        """summary.json, as text."""
    @property
    def wall_s(self) -> float: ...
    @property
    def work(self) -> numpy.ndarray: ...

class Input:
    """An input with its overrides, not yet checked."""
    def count(self: Input, list: str) -> int:
        """How many entries a list of tables has."""
    def has(self: Input, table: str) -> bool:
        """Whether there is a table of this name."""
    @property
    def name(self) -> str: ...
    @staticmethod
    def open(kind: str, name_or_file: str, sets: list[str]) -> Input:
        """A file, or a shipped scene or point test by its name. sets: "key=value"."""
    @staticmethod
    def table(text: str, name: str, sets: list[str]) -> Input:
        """A table that a program has made, as TOML text."""
    def text(self: Input, table: str, key: str) -> str:
        """A text of a table; empty where there is none."""

class InputError(ValueError):
    """Input that cannot be used. `problems` lists all that is wrong, each with its place, the
accepted range and the nearest right name; str() is one per line."""
    problems: list[str]

class Law:
    """A law with its parameters."""
    def __init__(self: Law, input: Input) -> None: ...
    def density_at(self: Law, p: float, ocr: float) -> float:
        """Density at rest under the pressure p [kg/m³]."""
    @property
    def info(self) -> dict: ...
    def initial(self: Law, input: Input) -> tuple:
        """Stress (6,), state and density of a point at rest."""
    def modulus(self: Law, stress: Any, state: Any, density: Any) -> numpy.ndarray:
        """P-wave modulus ρc² [Pa]."""
    @property
    def name(self) -> str: ...
    @property
    def parameters(self) -> dict: ...
    def stored_energy(self: Law, stress: Any, state: Any, density: Any) -> numpy.ndarray:
        """Recoverable energy per current volume [J/m³]."""
    def tangent(self: Law, stress: Any, state: Any, density: Any, strain: Any, dt: float, spin: Any) -> numpy.ndarray:
        """The consistent tangent of a step, (points, N, N)."""
    def toml(self: Law) -> str:
        """The lines of a [law] table that makes this law again."""
    def update(self: Law, stress: Any, state: Any, density: Any, strain: Any, dt: float, spin: Any, in_place: bool) -> tuple:
        """Stress, state and density after a step."""

class NumericalFailure(ArithmeticError):
    """A computation that could not be finished: where, when and why. `result` is what there is
of it, or None."""
    result: Any

class PointTest:
    """A point test that was read and checked."""
    def __init__(self: PointTest, input: Input) -> None: ...
    @property
    def law(self) -> str: ...
    @property
    def law_toml(self) -> str: ...
    @property
    def method(self) -> str: ...
    @property
    def name(self) -> str: ...
    def run(self: PointTest) -> Driven:
        """Drives it."""
    def sensitivities(self: PointTest, parameters: list[str], columns: list[str]) -> tuple:
        """Columns and their derivatives, (rows, parameters) each."""
    @property
    def stages(self) -> int: ...
    def with_parameters(self: PointTest, values: dict[str, float]) -> PointTest:
        """The same test with other values of parameters of its law."""

class Simulation:
    """A scene that is stepped; `repose.Simulation`."""
    def __init__(self: Simulation, input: Input, threads: int) -> None: ...
    def advance(self: Simulation, until: float, most_steps: int) -> None: ...
    def diagnostics(self: Simulation) -> dict: ...
    @property
    def dimensions(self) -> int: ...
    @property
    def domain(self) -> list[float]: ...
    @property
    def end_time(self) -> float: ...
    @property
    def gravity(self) -> float: ...
    @property
    def h(self) -> float: ...
    def load(self: Simulation, path: str) -> None: ...
    def maps(self: Simulation) -> dict: ...
    @property
    def name(self) -> str: ...
    @property
    def next_dt(self) -> float: ...
    def nodes(self: Simulation) -> dict: ...
    @property
    def notes(self) -> list[str]: ...
    def picture(self: Simulation, path: str) -> bool:
        """Draws final.svg with gnuplot."""
    @property
    def point_count(self) -> int: ...
    def points(self: Simulation) -> dict: ...
    def profile(self: Simulation) -> tuple: ...
    def resolved(self: Simulation, origin: str) -> str: ...
    def save(self: Simulation, path: str) -> None: ...
    def set_gravity(self: Simulation, gravity: float, tilt_deg: float) -> None: ...
    def set_wall(self: Simulation, edge: str, input: Input) -> None: ...
    @property
    def steps(self) -> int: ...
    @property
    def tilt_deg(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def warnings(self) -> list[str]: ...

def batch_array(points: int, columns: int | None = None) -> numpy.typing.NDArray[numpy.float64]:
    """An array of zeros, (points, columns) or (points,), that updates take as it is."""

def closest(name: str, known: list[str]) -> str:
    """The known name that a misspelt one stands for, or ""."""

def command(arguments: list[str]) -> int:
    """The command line, its own name first; returns the exit code."""

def estimate(input: Input) -> dict:
    """What `repose check` says of a scene: points, steps, memory, seconds."""

instruction_set: str

def json_schema(kind: str) -> str:
    """A JSON Schema of a kind of input, as text."""

def keys(kind: str) -> list:
    """Every key of a kind of input: name, unit, range, meaning, default."""

def law_description(name: str) -> str:
    """The tables of a law as `repose models NAME` prints them."""

def laws() -> list:
    """Every form of every law: its tables."""

def point_series_in(folder: str) -> str:
    """The NAME.hdf.series of a folder that is of points, or ""."""

def read_frame(path: str) -> dict:
    """A frame: time_s, position_m and its fields, by name."""

def read_frame_series(series: str) -> list[tuple[str, float]]:
    """(file, time) of every frame that a NAME.hdf.series lists."""

def read_raster(path: str) -> dict:
    """A map: values, west, south, cell, crs."""

def register_law(law: Any, tables: dict) -> None:
    """Makes a law known by its name; `repose.register_law` is what to call."""

def run_fit(input: Input, source: str, output: str, threads: int, seed: int, resume: bool, quiet: bool, plot: bool) -> int:
    """`repose fit`: returns the exit code."""

def run_scene(input: Input, source: str, output: str, threads: int, seed: int, resume: bool, quiet: bool, plot: bool) -> int:
    """`repose run`: returns the exit code."""

def run_sensitivity(input: Input, source: str, output: str, threads: int, seed: int, resume: bool, quiet: bool, plot: bool) -> int:
    """`repose sensitivity`: returns the exit code."""

def run_test(input: Input, source: str, output: str, threads: int, seed: int, resume: bool, quiet: bool, plot: bool) -> int:
    """`repose point`: returns the exit code."""

def run_verb(arguments: list[str]) -> int:
    """A verb with its options as text; returns the exit code."""

def shipped_cases() -> list[str]:
    """Names of the validation cases that come with repose."""

def shipped_scenes() -> list[str]:
    """Names of the scenes that come with repose."""

def shipped_tests() -> list[str]:
    """Names of the point tests that come with repose."""

def solve_fit(input: Input, seed: int, threads: int, cache: str, progress: Any) -> dict:
    """A fit as `repose fit` computes it: fit.json, predictions.csv and fitted.toml as text."""

def toml_number(x: float) -> str:
    """The fewest digits that read back as the same number."""

def toml_string(text: str) -> str:
    """A TOML string, quotes included."""

version: str

version_string: str
