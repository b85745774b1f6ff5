"""Arguments of a wrong type: told by their names, before the library's own calls see them."""

from __future__ import annotations

import numbers
import operator
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from . import _core


class WrongType(_core.InputError, TypeError):
    """An argument of a type that cannot be used: an InputError, and a TypeError as Python has it."""


def wrong(what: str, needed: str, value: Any) -> WrongType:
    """What to raise for it."""
    given = "None" if value is None else f"{value!r:.60}, a {type(value).__name__}"
    error = WrongType(f"{what} must be {needed}; got {given}")
    error.problems = [str(error)]
    return error


def number(what: str, value: Any) -> float:
    """A real number; True and False are none."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        # arrays of one number, and what else says that it is one
        if isinstance(value, (str, bytes, bool, np.bool_)) or not hasattr(value, "__float__"):
            raise wrong(what, "a number", value)
        try:
            return float(value)
        except (TypeError, ValueError):
            raise wrong(what, "a number", value) from None
    return float(value)


def whole(what: str, value: Any, below: int = 2**31) -> int:
    """A whole number from 0 on."""
    if isinstance(value, (bool, np.bool_)):
        raise wrong(what, "a whole number", value)
    try:
        count = operator.index(value)
    except TypeError:
        raise wrong(what, "a whole number", value) from None
    if not 0 <= count < below:
        error = _core.InputError(f"{what} = {count} must be >= 0 and < {below}")
        error.problems = [str(error)]
        raise error
    return count


def flag(what: str, value: Any) -> bool:
    """True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise wrong(what, "True or False", value)
    return bool(value)


def flags(verb: str, **values: Any) -> None:
    """Arguments that are True or False, by their names."""
    for name, value in values.items():
        flag(f"{verb}: {name}", value)


def text(what: str, value: Any) -> str:
    """A text."""
    if not isinstance(value, str):
        raise wrong(what, "a text", value)
    return value


def texts(what: str, value: Any) -> list[str]:
    """Several texts; one alone is no list of its letters."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise wrong(what, "a list of texts", value)
    return [text(f"{what}[{i}]", one) for i, one in enumerate(value)]


def path(what: str, value: Any) -> str:
    """The path of a file or folder."""
    if not isinstance(value, (str, os.PathLike)):
        raise wrong(what, "a path", value)
    return os.fspath(value)


def callback(what: str, value: Any) -> Callable | None:
    """A function, or None."""
    if value is not None and not callable(value):
        raise wrong(what, "a function or None", value)
    return value


def table(what: str, value: Any) -> Mapping:
    """A dictionary."""
    if not isinstance(value, Mapping):
        raise wrong(what, "a dictionary", value)
    return value


def source(what: str, value: Any) -> None:
    """An input: a dictionary, a file, or a shipped one by its name."""
    if not isinstance(value, (str, os.PathLike, Mapping)):
        raise wrong(what, "a dictionary, the path of a file or the name of a shipped one", value)
