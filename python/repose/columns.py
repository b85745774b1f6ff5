"""A table of numbers by the names of its columns."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator, Mapping

import numpy as np

from . import _core
from .names import nearest


class Columns(Mapping):
    """The columns of a table as numpy arrays: `table["time_s"]`, `table.names`.

    A column of texts is an array of texts; a cell without a value is nan.
    """

    def __init__(self, columns: Mapping[str, np.ndarray], of: str = "the table") -> None:
        self._columns = dict(columns)
        self._of = of

    @classmethod
    def read(cls, file: os.PathLike | str) -> "Columns":
        """A CSV table that repose has written."""
        with open(file, newline="", encoding="utf-8") as stream:
            written = stream.read()
        # a line without its end is a row that was being written when the run was stopped
        rows = list(csv.reader(written[:written.rfind("\n") + 1].splitlines()))
        return cls._of_rows(rows, os.path.basename(os.fspath(file)))

    @classmethod
    def parse(cls, text: str, of: str = "the table") -> "Columns":
        """The same from text."""
        return cls._of_rows(list(csv.reader(text.splitlines())), of)

    @classmethod
    def _of_rows(cls, rows: list[list[str]], of: str) -> "Columns":
        names = rows[0] if rows else []
        columns = {}
        for k, name in enumerate(names):
            cells = [row[k] if k < len(row) else "" for row in rows[1:]]
            try:
                columns[name] = np.array([float(c) if c else np.nan for c in cells])
            except ValueError:
                columns[name] = np.array(cells, dtype=object)
        return cls(columns, of)

    @property
    def names(self) -> list[str]:
        """The names of the columns, in their order."""
        return list(self._columns)

    def __getitem__(self, name: str) -> np.ndarray:
        try:
            return self._columns[name]
        except KeyError:
            raise nearest(name, self.names, f"{self._of} has no column") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(next(iter(self._columns.values()))) if self._columns else 0

    def __repr__(self) -> str:
        return f"<{self._of}: {self.rows} rows of {', '.join(self.names)}>"
