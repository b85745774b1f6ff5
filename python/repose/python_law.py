"""Laws written in Python: slow, for trying something out."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from . import _core, arguments
from .inputs import refused


@dataclass(frozen=True)
class Parameter:
    """A parameter of a PythonLaw. default: None makes it required, unless it is optional; an
    optional one that is not given is None. lower, upper: its range, whose ends `closed` includes.
    log: its natural scale in a fit is logarithmic."""

    doc: str
    unit: str = "-"
    default: float | None = None
    lower: float = -math.inf
    upper: float = math.inf
    closed: bool = False
    optional: bool = False
    log: bool = False
    symbol: str = ""


class PythonLaw:
    """To inherit: a law as a class, made known by `register_law(MyLaw)`.

        class Elastic(repose.PythonLaw):
            name = "my_elastic"
            doc = "isotropic, hypoelastic"
            parameters = {"K": Parameter("bulk modulus", "Pa", lower=0),
                          "G": Parameter("shear modulus", "Pa", lower=0),
                          "rho_0": Parameter("density", "kg/m3", lower=0)}

            def update(self, P, stress, state, density, strain, dt):
                volume = strain[:, :3].sum(axis=1, keepdims=True)
                new = stress + 2 * P.G * strain
                new[:, :3] += (P.K - 2 * P.G / 3) * volume
                return new

            def modulus(self, P, stress, state, density):
                return P.K + 4 * P.G / 3

    From then on its name stands in any [law] table: point tests (method "implicit", the tangent by
    differences), fits, scenes. P has the parameters as attributes. Arrays: stress and strain
    (points, 4) in plane strain or (points, 6), tension positive, stress already turned with the
    material; state (points, variables); density (points,) at the end of the step. What is returned
    and is not a finite number counts as a point that cannot be advanced. An exception ends the run
    with its traceback. Work that such a law dissipates appears in a ledger as work_residual.
    """

    name: str = ""
    doc: str = ""
    has_stress_memory: bool = True  #: the stress at the start of a step matters
    parameters: Mapping[str, Parameter] = {}
    state: Mapping[str, str] = {}  #: per variable what it is, as in {"e": "void ratio [-]"}; 64 at most

    def update(self, P: SimpleNamespace, stress: np.ndarray, state: np.ndarray,
               density: np.ndarray, strain: np.ndarray, dt: float) -> Any:
        """Stress at the end of the step, or (stress, state) for a law with state variables."""
        raise NotImplementedError(f"{type(self).__name__}.update is missing")

    def modulus(self, P: SimpleNamespace, stress: np.ndarray, state: np.ndarray,
                density: np.ndarray) -> Any:
        """P-wave modulus rho c^2 [Pa], (points,) or one number: what an explicit step respects."""
        raise NotImplementedError(f"{type(self).__name__}.modulus is missing")

    def viscosity(self, P: SimpleNamespace, stress: np.ndarray, density: np.ndarray,
                  strain_rate: np.ndarray) -> Any:
        """Shear viscosity that limits an explicit step [Pa s]; none unless a law says so."""
        return 0.0

    def stored_energy(self, P: SimpleNamespace, stress: np.ndarray, state: np.ndarray,
                      density: np.ndarray) -> Any:
        """Recoverable energy per current volume [J/m3]; 0 unless a law says so."""
        return 0.0

    def complete(self, P: SimpleNamespace) -> None:
        """Derives absent optional parameters and checks conditions between parameters: may set
        attributes of P and raise InputError."""

    def initial(self, P: SimpleNamespace, given: dict[str, Any], stress: np.ndarray) -> Any:
        """A point at rest under `stress` (6,): (stress, state, density). given: the conditions of an
        [initial] table. Unless a law says otherwise the density is the one given, or rho_0."""
        density = given.get("density", getattr(P, "rho_0", None))
        if density is None:
            raise _core.InputError(f"{self.name}: needs a density: a parameter rho_0, [initial] "
                                   f"density, or a method initial()")
        return stress, np.zeros(len(self.state)), density


class _Adapter:
    """What the library calls: parameters arrive as a dictionary and answers leave as tuples."""

    def __init__(self, law: PythonLaw) -> None:
        self._law = law

    def update(self, P, stress, state, density, strain, dt):
        answer = self._law.update(SimpleNamespace(**P), stress, state, density, strain, dt)
        if isinstance(answer, tuple):
            if len(answer) != 2:
                raise ValueError(f"{self._law.name}.update must return (stress, state); it returned "
                                 f"{len(answer)} things")
            return answer
        if self._law.state:
            raise ValueError(f"{self._law.name}.update must return (stress, state): the law has state")
        return answer, state

    def modulus(self, P, *arrays):
        return self._each(self._law.modulus(SimpleNamespace(**P), *arrays), arrays[0])

    def stored_energy(self, P, *arrays):
        return self._each(self._law.stored_energy(SimpleNamespace(**P), *arrays), arrays[0])

    def viscosity(self, P, *arrays):
        return self._each(self._law.viscosity(SimpleNamespace(**P), *arrays), arrays[0])

    @staticmethod
    def _each(answer, stress):
        return np.broadcast_to(np.asarray(answer, dtype=float), (len(stress),))

    def complete(self, P):
        named = SimpleNamespace(**P)
        self._law.complete(named)
        return {name: getattr(named, name) for name in P}

    def initial(self, P, given, stress):
        answer = self._law.initial(SimpleNamespace(**P), given, stress)
        stress, state, density = answer
        return (np.reshape(stress, (1, 6)), np.reshape(state, (1, len(self._law.state))),
                float(density))


def _check(place: str, name: str, p: Parameter) -> None:
    if not re.fullmatch(r"[A-Za-z0-9_-]+", name) or name == "name":
        raise refused(f"{place}: a parameter's name is a key of [law]: letters, digits, _ and -, and "
                      f"not \"name\"")
    if not p.lower <= p.upper:
        raise refused(f"{place}: lower = {p.lower} must not be above upper = {p.upper}")
    inside = p.default is None or p.lower < p.default < p.upper or (
        p.closed and p.lower <= p.default <= p.upper)
    if not inside or (p.default is not None and not math.isfinite(p.default)):
        raise refused(f"{place}: default = {p.default} does not lie within its range")


def register_law(law: type[PythonLaw]) -> type[PythonLaw]:
    """Makes a law known by its name, to point tests, fits and scenes; may stand as a decorator.

    Raises InputError where the name is taken (a name stands for one law as long as the program
    runs) or a table is none.
    """
    if not isinstance(law, type):
        raise arguments.wrong("register_law: law", "a class that inherits from repose.PythonLaw", law)
    made = law()
    if not isinstance(made, PythonLaw):
        raise TypeError(f"{law.__name__} does not inherit from repose.PythonLaw")
    parameters = []
    for name, p in made.parameters.items():
        if not isinstance(p, Parameter):
            raise TypeError(f"{law.__name__}.parameters[{name!r}] is no repose.Parameter")
        _check(f"{law.__name__}.parameters[{name!r}]", name, p)
        parameters.append({"name": name, "symbol": p.symbol or name, "unit": p.unit, "doc": p.doc,
                           "default": p.default, "optional": p.optional, "log": p.log,
                           "lower": p.lower, "upper": p.upper,
                           "lower_open": not p.closed or math.isinf(p.lower),
                           "upper_open": not p.closed or math.isinf(p.upper)})
    state = [{"name": name, "symbol": name, "unit": "", "doc": doc}
             for name, doc in made.state.items()]
    _core.register_law(_Adapter(made), {"name": made.name, "doc": made.doc,
                                        "has_stress_memory": made.has_stress_memory,
                                        "parameters": parameters, "state": state})
    return law
