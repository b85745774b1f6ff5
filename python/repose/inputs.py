"""From what a user writes to what the library's readers take: TOML text and overrides."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Union

import numpy as np

from . import _core, arguments

Source = Union[str, os.PathLike, Mapping]
_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")
_STEP = re.compile(r"([A-Za-z0-9_-]+)|\[(\d+)\]|\.")


def toml(value: Any, place: str = "the input") -> str:
    """A value as TOML, tables on one line."""
    if hasattr(value, "as_table"):  # a Law
        value = value.as_table()
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return _core.toml_number(float(value))
    if isinstance(value, (str, Path)):
        return _core.toml_string(str(value))
    if isinstance(value, Mapping):
        inside = (f"{_key(k, place)} = {toml(v, f'{place}.{k}')}" for k, v in value.items())
        return "{" + ", ".join(inside) + "}"
    if isinstance(value, (list, tuple, range)):
        return "[" + ", ".join(toml(v, f"{place}[{i}]") for i, v in enumerate(value)) + "]"
    if isinstance(value, np.ndarray):
        return toml(value.tolist(), place)
    raise refused(f"{place}: {_described(value)} is no value of an input: numbers, texts, true and "
                   f"false, lists and tables are")


def _described(value: Any) -> str:
    return "None (leave the key out)" if value is None else f"a {type(value).__name__}"


def _key(key: Any, place: str) -> str:
    if not isinstance(key, str):
        raise refused(f"{place}: the key {key!r} is no text")
    return key if _BARE.match(key) else _core.toml_string(key)


def refused(text: str) -> _core.InputError:
    """What to raise for input of Python's own that cannot be used."""
    error = _core.InputError(text)
    error.problems = [text]
    return error


def document(table: Mapping) -> str:
    """A dictionary as a TOML file."""
    return "".join(f"{_key(k, 'the input')} = {toml(v, str(k))}\n" for k, v in table.items())


def flattened(changes: Mapping, before: str = "") -> dict[str, Any]:
    """{"initial": {"ocr": 8}, "law.M": 1.0} as {"initial.ocr": 8, "law.M": 1.0}."""
    flat: dict[str, Any] = {}
    for key, value in changes.items():
        if isinstance(value, Mapping) and not before:
            flat.update(flattened(value, f"{key}."))
        else:
            flat[f"{before}{key}"] = value
    return flat


def _put(table: dict, path: str, value: Any) -> None:
    """Sets "body[0].law.K" of a dictionary, whose tables and lists on the way it copies."""
    steps: list[Any] = []
    at = 0
    for match in _STEP.finditer(path):
        if match.start() != at:
            break
        at = match.end()
        if match.group(1):
            steps.append(match.group(1))
        elif match.group(2):
            steps.append(int(match.group(2)))
    if at != len(path) or not steps:
        raise refused(f"{path}: is not a key, as in grid.h or body[0].law.K")
    parent: Any = table
    for step, following in zip(steps, steps[1:]):
        try:
            child = parent[step]
        except (KeyError, IndexError):
            if isinstance(step, int) or isinstance(following, int):
                raise refused(f"{path}: there is no entry {step!r}") from None
            child = {}
        if hasattr(child, "as_table"):
            child = child.as_table()
        if isinstance(child, Mapping):
            child = dict(child)
        elif isinstance(child, (list, tuple)):
            child = list(child)
        else:
            raise refused(f"{path}: {step} is a value, not a table")
        parent[step] = child
        parent = child
    try:
        parent[steps[-1]] = value
    except (IndexError, TypeError):
        raise refused(f"{path}: there is no entry {steps[-1]!r}") from None


def open_input(kind: str, source: Source, changes: Mapping, law: Any = None,
               replaced: Mapping | None = None, placed: Mapping | None = None) -> _core.Input:
    """Opens a dictionary, a file or a shipped input by its name, with changes of single keys.

    kind: "scene", "point_test" or "fit". law: stands in for the [law] table, or, a dictionary without
    a name, changes keys of it. replaced: whole tables that stand in for those of the source. placed: the same
    at any place, {"body[0].law": law}; changes come after them.
    """
    arguments.source(kind.replace("point_test", "test").replace("fit", "source"), source)
    whole = dict(replaced or {})
    if isinstance(law, Mapping) and "name" not in law:
        changes = {**changes, "law": law}
    elif law is not None:
        whole["law"] = law
    changes = {**(placed or {}), **flattened(changes)}
    if isinstance(source, Mapping):
        table = {**source, **whole}
        for path, value in changes.items():
            _put(table, path, value)
        return _core.Input.table(document(table), kind.replace("_", " "), [])
    sets = [f"{path}={toml(value, path)}" for path, value in {**whole, **changes}.items()]
    return _core.Input.open(kind, os.fspath(source), sets)
