"""Granular and soil mechanics: drive a law at a point, fit it, run it in a collapse.

    import repose

    test = repose.point("weald_clay_undrained", initial={"ocr": 8})
    test["q_Pa"], test.laboratory["S_u_Pa"]

    sim = repose.Simulation("flat_mu_i", grid={"h": 0.0125})
    sim.step(until=0.1)
    sim.points.position

Inputs are what the TOML files of the command hold: a dictionary, the path of a file, or the name
of one that comes with repose; keyword arguments change single keys. All numbers are in SI units.
A mistake is an `InputError` that lists all that is wrong; what cannot be computed is a
`NumericalFailure`; a file that cannot be read or written is an `OSError`.
"""

from . import _core, arguments
from ._core import (InputError, NumericalFailure, batch_array, instruction_set,
                    shipped_cases, shipped_scenes, shipped_tests, version)
from .columns import Columns
from .fitting import FitResult, fit
from .law import Law, LawInfo, laws
from .maps import Map, Maps
from .point_test import PointResult, PointTest, point
from .python_law import Parameter, PythonLaw, register_law
from .result import Result
from .simulation import Nodes, Points, Simulation, estimate
from .verbs import chart, run, sensitivity, sweep, validate

__version__ = version


def keys(kind: str) -> list[dict]:
    """Every key of a kind of input, "scene", "test", "fit", "chart" or "case": name, unit, range,
    meaning, default."""
    return _core.keys(arguments.text("keys: kind", kind))


def json_schema(kind: str) -> str:
    """A JSON Schema of a kind of input, as text."""
    return _core.json_schema(arguments.text("json_schema: kind", kind))


def cmake_dir() -> str:
    """The folder that find_package(repose) takes as repose_DIR, where the package was installed by
    pip: the C++ headers, libraries and CMake files lie within it."""
    from pathlib import Path
    folder = Path(__file__).resolve().parent / "lib" / "cmake" / "repose"
    if not folder.is_dir():
        raise FileNotFoundError(f"{folder}: this package was not installed by pip")
    return str(folder)


__all__ = [
    "Columns", "FitResult", "InputError", "Law", "LawInfo", "Map", "Maps", "Nodes", "NumericalFailure",
    "Parameter", "PointResult", "PointTest", "Points", "PythonLaw", "Result", "Simulation",
    "batch_array", "chart", "cmake_dir", "estimate", "fit", "instruction_set", "json_schema", "keys", "laws",
    "point", "register_law", "run", "sensitivity", "shipped_cases", "shipped_scenes", "shipped_tests",
    "sweep", "validate", "version",
]
