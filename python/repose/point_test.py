"""Point tests: one material point along a path."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, arguments
from .inputs import Source, open_input, refused
from .law import Law
from .names import nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class PointResult(Mapping):
    """A point test as it was driven: `result["q_Pa"]` is a column of curve.csv (a unit may be left
    out: `result["q"]`), compression positive.

    status: "completed", "stopped" by a condition of the test, or what went wrong; `reason` says it
    in words. notes: what a user should know. laboratory: what a report quotes (S_u_Pa, ...),
    summary: the whole of summary.json.
    """

    def __init__(self, driven: _core.Driven, name: str, law: str) -> None:
        self._driven = driven
        self.name = name
        self.law = law

    def __getitem__(self, column: str) -> np.ndarray:
        if not isinstance(column, str):
            raise nearest(column, self.columns, "a test has no column")
        try:
            return self._driven.column(column)
        except _core.InputError:
            raise nearest(column, self.columns, "a test has no column") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def columns(self) -> list[str]:
        """Names of the columns that the test and its law have."""
        return self._driven.columns

    @property
    def rows(self) -> int:
        """How many rows the curve has."""
        return self._driven.rows

    @property
    def status(self) -> str:
        """How it ended: "completed", "stopped", or a failure."""
        return self._driven.status

    @property
    def ok(self) -> bool:
        """Whether the path came to its end."""
        return not self._driven.failed

    @property
    def reason(self) -> str:
        """How it ended, in words."""
        return self._driven.reason

    @property
    def notes(self) -> list[str]:
        """What is possible but hardly meant, and what the curve shows that one should know."""
        return self._driven.notes

    @property
    def laboratory(self) -> dict[str, Any]:
        """What a report on such a test quotes, as in summary.json: units in the names."""
        return json.loads(self._driven.laboratory()) or {}

    @property
    def summary(self) -> dict[str, Any]:
        """summary.json."""
        return json.loads(self._driven.summary())

    @property
    def stress(self) -> np.ndarray:
        """(rows, 6), xx yy zz xy yz zx, TENSION positive, Pa; the axis of a test is y."""
        return self._driven.stress

    @property
    def strain(self) -> np.ndarray:
        """(rows, 6), logarithmic, tension positive, from the start of the test."""
        return self._driven.strain

    @property
    def state(self) -> np.ndarray:
        """(rows, variables) of the law, state first, then derived ones; of a law with more than four
        the first four."""
        return self._driven.state

    @property
    def density(self) -> np.ndarray:
        """(rows,), kg/m3."""
        return self._driven.density

    @property
    def work(self) -> np.ndarray:
        """Work done on the point since the start, per initial volume, J/m3."""
        return self._driven.work

    @property
    def dissipated(self) -> np.ndarray:
        """What of it was dissipated, J/m3."""
        return self._driven.dissipated

    def write(self, file: str | os.PathLike) -> None:
        """Writes curve.csv."""
        Path(arguments.path("write: file", file)).write_text(self._driven.csv(), encoding="utf-8")

    def picture(self, file: str | os.PathLike) -> None:
        """Draws the picture of `repose point`, an SVG, with gnuplot."""
        self._driven.picture(arguments.path("picture: file", file))

    def plot(self) -> "Figure":
        """A matplotlib figure of the test."""
        from .plotting import point_figure
        return point_figure(self)

    def __reduce__(self) -> tuple:
        raise TypeError("a driven test is not pickled: keep its columns, dict(result), or pickle its "
                        "PointTest and drive that again")

    def __repr__(self) -> str:
        return (f"<point test {self.name!r} of {self.law}: {self.rows} rows, {self.reason}; "
                f"columns {', '.join(self.columns)}>")


class PointTest:
    """A point test that is read and checked once and may be driven often.

        test = PointTest("weald_clay_undrained", initial={"ocr": 2})
        for M in (0.8, 0.9, 1.0):
            print(test.run(M=M)["q_Pa"][-1])

    test: a dictionary with the tables [law], [initial], [test] and [integration], the path of a
    file, or the name of a shipped one (`shipped_tests()`). law: a Law or a dictionary with a name
    that stands in for [law]; one without changes keys of it. Keyword arguments change keys:
    initial={"ocr": 8}, or **{"initial.ocr": 8}.
    """

    def __init__(self, test: Source, /, law: Law | Mapping | None = None, **changes: Any) -> None:
        given = open_input("point_test", test, changes, law)
        if given.has("sweep"):
            raise refused(f"{given.name}: has a [sweep], many tests in one: repose.sweep drives them")
        self._test = _core.PointTest(given)
        self._given = (test, law, changes)

    @property
    def name(self) -> str:
        """The test's name."""
        return self._test.name

    @property
    def method(self) -> str:
        """The integrator that drives it."""
        return self._test.method

    def run(self, *, strict: bool = True, **parameters: float) -> PointResult:
        """Drives the test, with other values of parameters of its law where given.

        Raises NumericalFailure where the path cannot be finished, its `result` being the part done;
        with strict=False that is returned.
        """
        arguments.flags("run", strict=strict)
        parameters = {name: arguments.number(f"run: {name}", x) for name, x in parameters.items()}
        test = self._test.with_parameters(parameters) if parameters else self._test
        result = PointResult(test.run(), test.name, test.law)
        if strict and not result.ok:
            failure = _core.NumericalFailure(f"{self.name}: {result.reason}")
            failure.result = result
            raise failure
        return result

    def sensitivities(self, parameters: Iterable[str],
                      columns: Iterable[str] = ("q_Pa",)) -> dict[str, np.ndarray]:
        """Derivatives of columns with respect to parameters of the law, (rows, parameters) each.

        Taken at a row's place on the path, in dual numbers; parameters that the law derives from
        others follow them.
        """
        names = arguments.texts("sensitivities: columns", columns)
        status, _, derivatives = self._test.sensitivities(
            arguments.texts("sensitivities: parameters", parameters), names)
        if status not in ("completed", "stopped"):
            raise _core.NumericalFailure(f"{self.name}: the derivatives end with: {status}")
        return dict(zip(names, derivatives))

    def __reduce__(self) -> tuple:
        # what it was made from: a file is read again
        return _made_again, self._given

    def __repr__(self) -> str:
        return f"<point test {self.name!r} of {self._test.law}, {self._test.stages} stage(s)>"


def _made_again(test: Source, law: Law | Mapping | None, changes: Mapping) -> PointTest:
    return PointTest(test, law, **changes)


def point(test: Source, /, law: Law | Mapping | None = None, *, strict: bool = True,
          output: str | os.PathLike | None = None, plot: bool = True, quiet: bool = True,
          **changes: Any) -> PointResult:
    """Drives one material point along a path, as `repose point` does; `PointTest` says of what.

    output: leaves the result folder of the command there as well (`plot`: with its picture).
    Raises InputError, and NumericalFailure where the path cannot be finished (its `result` is the
    part done; strict=False returns it).
    """
    arguments.flags("point", strict=strict, plot=plot, quiet=quiet)
    prepared = PointTest(test, law, **changes)
    if output is not None:
        output = arguments.path("point: output", output)
        given = open_input("point_test", test, changes, law)
        _core.run_test(given, given.name, output, 0, 0, False, quiet, plot)
    return prepared.run(strict=strict)
