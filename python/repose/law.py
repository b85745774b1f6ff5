"""Laws by name, and one with its parameters."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core, arguments
from .inputs import document, refused


@dataclass(frozen=True)
class LawInfo:
    """A law's tables: what it is called and what it is made of.

    parameters: per name a dict with symbol, unit, doc, need ("required", "defaulted" or
    "optional"), default, range, angle (the key of a friction angle that may stand for it) and words.
    state, derived: per name a dict with symbol, unit and doc.
    """

    name: str
    option_key: str
    option: str
    doc: str
    has_stress_memory: bool
    parameters: dict[str, dict]
    state: dict[str, dict]
    derived: dict[str, dict]

    @classmethod
    def _of(cls, tables: Mapping) -> "LawInfo":
        named = {key: {entry["name"]: dict(entry) for entry in tables[key]}
                 for key in ("parameters", "state", "derived")}
        return cls(**{**tables, **named})

    @property
    def title(self) -> str:
        """The name with its form: "mu_i, form = elastoviscoplastic"."""
        return self.name + (f", {self.option_key} = {self.option}" if self.option_key else "")

    def __str__(self) -> str:
        lines = [f"{self.title}: {self.doc}"]
        for name, p in self.parameters.items():
            given = p["default"] if p["need"] == "defaulted" else p["need"]
            unit = "" if p["unit"] == "-" else f" [{p['unit']}]"
            lines.append(f"  {name:<8} {p['doc']}{unit}, {p['range']} ({given})")
        for name, field in self.state.items():
            lines.append(f"  state {name}: {field['doc']} [{field['unit']}]")
        return "\n".join(lines)


def laws(name: str | None = None) -> list[LawInfo]:
    """Every form of every law, or of the law of this name, those registered from Python included."""
    found = [LawInfo._of(tables) for tables in _core.laws()]
    if name is None:
        return found
    _core.law_description(arguments.text("laws: name", name))  # says which names there are
    return [info for info in found if info.name == name]


class Law:
    """A law with its parameters.

        Law("mu_i", mu_0=0.38, mu_d=0.57, I_0=0.28, d=0.0053, rho_p=2000, rho_0=1300, K=2.5e5)
        Law({"name": "modified_cam_clay", "compression": "v-ln_p", "M": 0.95, ...})
        Law("results/my_fit/fitted.toml")

    Options ("form", "compression", ...) stand among the parameters, as in a [law] table; friction
    may be given as an angle in triaxial compression (phi for M, ...). `laws("mu_i")` tells what
    there is.

    Arrays. Stress and strain are tension positive, components xx, yy, zz, xy in plane strain,
    (points, 4), or xx, yy, zz, xy, yz, zx, (points, 6); shear components are those of the tensor
    (eps_xy, not gamma). state is (points, variables), density (points,). An array in memory column
    by column (order "F") of a multiple of 16 points, or made by `batch_array`, is taken as it is;
    any other is copied.
    """

    def __init__(self, name: str | Mapping | "Law" | None = None, /, **parameters: Any) -> None:
        if isinstance(name, Law):
            table = {**name.as_table(), **parameters}
        elif isinstance(name, Mapping):
            table = {**name, **parameters}
        elif isinstance(name, str) and name.endswith(".toml"):
            table = None
        else:
            table = {**({} if name is None else {"name": name}), **parameters}
        if table is None:
            sets = [f"law.{key}={document({'x': x})[4:].strip()}" for key, x in parameters.items()]
            self._law = _core.Law(_core.Input.table(document({"law": name}), "law", sets))
        else:
            self._law = _core.Law(_core.Input.table(document({"law": table}), "Law", []))

    @property
    def name(self) -> str:
        """What the law is called."""
        return self._law.name

    @property
    def info(self) -> LawInfo:
        """The law's tables."""
        return LawInfo._of(self._law.info)

    @property
    def parameters(self) -> dict[str, Any]:
        """Every parameter by name, SI units; derived ones included, None where one stays absent."""
        return self._law.parameters

    @property
    def state(self) -> list[str]:
        """Names of the state variables, in the order of the columns of state arrays."""
        return [field["name"] for field in self._law.info["state"]]

    def as_table(self) -> dict[str, Any]:
        """The [law] table that makes this law again."""
        return tomllib.loads(self._law.toml())

    def initial(self, **conditions: Any) -> tuple[np.ndarray, np.ndarray, float]:
        """A point at rest: stress (6,) tension positive, state, density.

        conditions: those of an [initial] table, p, sigma_v, ocr, ocr_v, K0, v, e, density, sigma
        (compression positive). Raises InputError where the law cannot start from them.
        """
        return self._law.initial(_core.Input.table(document({"initial": conditions}), "Law", []))

    def points(self, count: int, components: int = 6,
               **conditions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """`count` equal points at rest: stress (count, components), state, density, in memory that
        `update(..., in_place=True)` takes."""
        count = arguments.whole("points: count", count)
        if arguments.whole("points: components", components) not in (4, 6):
            raise refused(f"points: components = {components} must be 4, of plane strain, or 6")
        stress, state, density = self.initial(**conditions)
        all_stress = _core.batch_array(count, components)
        all_state = _core.batch_array(count, len(state))
        all_density = _core.batch_array(count)
        all_stress[:] = stress[:components]
        all_state[:] = state
        all_density[:] = density
        return all_stress, all_state, all_density

    def density_at(self, p: float, ocr: float = 1.0) -> float:
        """Density at rest under the mean pressure p [Pa], in kg/m3."""
        return self._law.density_at(arguments.number("density_at: p", p),
                                    arguments.number("density_at: ocr", ocr))

    def update(self, stress: np.ndarray, state: np.ndarray, density: np.ndarray,
               strain: np.ndarray, dt: float, spin: np.ndarray | None = None,
               in_place: bool = False) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """One step of every point: stress, state and density after it.

        strain: the step's logarithmic strain, (points, 4) or (points, 6). dt [s]. spin: the step's
        rotation vector, half the curl of the velocity times dt: about z, (points,), in plane
        strain; (points, 3) in space. in_place: the three arrays are changed and returned; they must
        be such as `points` makes. Raises InputError for shapes, NumericalFailure for a point that
        cannot be advanced (in place, that point is then left as it was).
        """
        return self._law.update(stress, state, density, strain, arguments.number("update: dt", dt), spin,
                                arguments.flag("update: in_place", in_place))

    def tangent(self, stress: np.ndarray, state: np.ndarray, density: np.ndarray,
                strain: np.ndarray, dt: float, spin: np.ndarray | None = None) -> np.ndarray:
        """The consistent tangent of `update`, d stress_a / d strain_b at [point, a, b], in Pa.

        Exact for the library's laws; of a law in Python by central differences.
        """
        return self._law.tangent(stress, state, density, strain, arguments.number("tangent: dt", dt), spin)

    def modulus(self, stress: np.ndarray, state: np.ndarray, density: np.ndarray) -> np.ndarray:
        """P-wave modulus rho c^2 of every point, in Pa."""
        return self._law.modulus(stress, state, density)

    def wave_speed(self, stress: np.ndarray, state: np.ndarray, density: np.ndarray) -> np.ndarray:
        """c of every point, in m/s."""
        return np.sqrt(self.modulus(stress, state, density) / np.asarray(density))

    def stored_energy(self, stress: np.ndarray, state: np.ndarray,
                      density: np.ndarray) -> np.ndarray:
        """Recoverable energy per current volume, in J/m3."""
        return self._law.stored_energy(stress, state, density)

    def __reduce__(self) -> tuple:
        # its table makes it again; a law of one's own must be registered where it is read
        return Law, (self.as_table(),)

    def __repr__(self) -> str:
        inside = ", ".join(f"{key}={value!r}" for key, value in self.as_table().items()
                           if key != "name")
        return f"Law({self.name!r}, {inside})"
