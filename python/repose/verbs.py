"""What the command does, with result folders: run, sweep, sensitivity, validate, chart."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from . import _core, arguments
from .inputs import Source, open_input, toml
from .result import Result

_DONE, _FAILED, _INTERRUPTED = 0, 3, 130


def _ended(code: int, folder: str | os.PathLike) -> Result:
    """The result of a verb that returned; raises what its exit code means."""
    if code == _INTERRUPTED:
        raise KeyboardInterrupt(f"{os.fspath(folder)}: stopped; resume=True goes on")
    result = Result(folder)
    if code == _DONE:
        return result
    reason = result.summary.get("reason") or f"exit code {code}"
    failure = _core.NumericalFailure(f"{os.fspath(folder)}: {reason}")
    failure.result = result
    raise failure


def _folder(output: str | os.PathLike | None, name: str) -> str:
    return arguments.path("output", output) if output is not None else os.path.join("results", name)


def run(scene: Source, /, output: str | os.PathLike | None = None, *, resume: bool = False,
        threads: int = 0, seed: int = 0, quiet: bool = False, plot: bool = True,
        **changes: Any) -> Result:
    """Runs a scene as `repose run` does and returns its result folder (default: results/NAME).

    scene, changes: as for `Simulation`; with a [sweep], every run of it. resume: goes on from the
    last checkpoint. Ctrl-C leaves a checkpoint and raises KeyboardInterrupt; a run that fails
    raises NumericalFailure, its `result` being what there is.
    """
    threads = arguments.whole("run: threads", threads)
    seed = arguments.whole("run: seed", seed, below=2**64)
    arguments.flags("run", resume=resume, quiet=quiet, plot=plot)
    given = open_input("scene", scene, changes)
    if given.has("sweep"):
        name = Path(given.name).stem
    else:
        name = given.text("scene", "name") or Path(given.name).stem
    folder = _folder(output, name)
    return _ended(_core.run_scene(given, given.name, folder, threads, seed, resume, quiet, plot),
                  folder)


def sweep(source: Source, /, *, grid: Mapping | None = None, list: Iterable[Mapping] | None = None,
          table: str | os.PathLike | None = None, output: str | os.PathLike | None = None,
          resume: bool = False, threads: int = 0, quiet: bool = False, plot: bool = True,
          **changes: Any) -> Result:
    """Many point tests, or runs of a scene, that differ in keys: one table of their figures.

        sweep("weald_clay_undrained", grid={"initial.ocr": [1, 2, 4], "law.M": [0.9, 1.0]})

    One of grid (every combination, the first key slowest), list (run by run, dictionaries) and
    table (a CSV file, a run in each row), or the source's own [sweep]. The result has `sweep`, a
    row per run; of tests `curves`, of scenes `runs`. Runs side by side on `threads` (0: all cores)
    with the same bytes for any number.
    """
    threads = arguments.whole("sweep: threads", threads)
    arguments.flags("sweep", resume=resume, quiet=quiet, plot=plot)
    arguments.source("sweep: source", source)
    if list is not None and (isinstance(list, (str, Mapping)) or not isinstance(list, Iterable)):
        raise arguments.wrong("sweep: list", "a list of dictionaries", list)
    ways = {key: value for key, value in (("grid", grid), ("list", list), ("table", table))
            if value is not None}
    if "list" in ways:
        ways["list"] = [dict(arguments.table("sweep: an entry of list", one)) for one in ways["list"]]
    replaced = {"sweep": ways} if ways else {}
    given = _either(source, changes, replaced)
    folder = _folder(output, "sweep" if isinstance(source, Mapping) else Path(given.name).stem)
    verb = _core.run_test if given.has("test") else _core.run_scene
    return _ended(verb(given, given.name, folder, threads, 0, resume, quiet, plot), folder)


def sensitivity(source: Source, /, asked: Mapping | None = None, *,
                output: str | os.PathLike | None = None, resume: bool = False, threads: int = 0,
                seed: int = 1, quiet: bool = False, plot: bool = True, **changes: Any) -> Result:
    """Which inputs the results of a point test or a scene depend on, as `repose sensitivity` does.

        sensitivity("weald_clay_undrained", {
            "samples": 128, "output": "S_u_Pa",
            "input": [{"key": "law.M", "lower": 0.9, "upper": 1.0},
                      {"key": "initial.p", "mean": 207e3, "sd": 10e3}]})

    asked: in place of the source's own [sensitivity]. The result has `table("sensitivity")`, a row
    per input and output, `samples`, a row per run, and `summary["outputs"]`, sensitivity.json.
    """
    threads = arguments.whole("sensitivity: threads", threads)
    seed = arguments.whole("sensitivity: seed", seed, below=2**64)
    arguments.flags("sensitivity", resume=resume, quiet=quiet, plot=plot)
    arguments.source("sensitivity: source", source)
    replaced = {} if asked is None else \
        {"sensitivity": dict(arguments.table("sensitivity: asked", asked))}
    given = _either(source, changes, replaced)
    folder = _folder(output, "sensitivity" if isinstance(source, Mapping) else Path(given.name).stem)
    return _ended(_core.run_sensitivity(given, given.name, folder, threads, seed, resume, quiet, plot),
                  folder)


def _either(source: Source, changes: Mapping, replaced: Mapping) -> _core.Input:
    """A point test or a scene."""
    is_scene = "scene" in source if isinstance(source, Mapping) else \
        os.fspath(source) in _core.shipped_scenes()
    return open_input("scene" if is_scene else "point_test", source, changes, replaced=replaced)


def validate(cases: str | Iterable[str] | None = None, /, *, laws: Iterable[str] = (),
             coarse: bool = False, output: str | os.PathLike | None = None, resume: bool = False,
             threads: int = 0, quiet: bool = False, plot: bool = True,
             **changes: Any) -> Result:
    """Laws against experiments and exact solutions, as `repose validate` does.

    cases: names (`shipped_cases()`) or folders with a case.toml; None: all that are shipped. laws:
    only these columns. coarse: the coarsest cells alone, without error bars.
    """
    if cases is not None and not isinstance(cases, (str, os.PathLike, Iterable)):
        raise arguments.wrong("validate: cases", "a name or a list of names", cases)
    names = [cases] if isinstance(cases, (str, os.PathLike)) else [*(cases or ())]
    folder = _folder(output, "validate")
    words = ["validate", *(arguments.path("validate: a case", name) for name in names), "-o", folder,
             *(word for law in arguments.texts("validate: laws", laws) for word in ("--law", law)),
             *_sets(changes)]
    return _verb(words, folder, coarse=coarse, resume=resume, threads=threads, quiet=quiet,
                 plot=plot)


def chart(what: str, /, file: str | os.PathLike | None = None, *, quick: bool = False,
          output: str | os.PathLike | None = None, resume: bool = False, threads: int | None = None,
          quiet: bool = False, plot: bool = True, **changes: Any) -> Result:
    """Speed against accuracy, as `repose chart` does: "point", "fit", "mpm", "all", or a file with
    a [chart] table."""
    arguments.path("chart: what", what)
    name = "gallery" if what == "all" else f"chart_{Path(what).stem}"
    folder = _folder(output, name)
    words = ["chart", os.fspath(what),
             *([arguments.path("chart: file", file)] if file is not None else []), "-o", folder,
             *_sets(changes)]
    return _verb(words, folder, quick=quick, resume=resume, threads=threads, quiet=quiet,
                 plot=plot)


def _sets(changes: Mapping) -> list[str]:
    from .inputs import flattened
    return [word for path, value in flattened(changes).items()
            for word in ("--set", f"{path}={toml(value, path)}")]


def _verb(words: list[str], folder: str, *, threads: int | None, plot: bool,
          **flags: bool) -> Result:
    arguments.flags(words[0], plot=plot, **flags)
    words = [*words, *(f"--{name}" for name, wanted in flags.items() if wanted)]
    if threads is not None:
        words += ["--threads", str(arguments.whole("threads", threads))]
    if not plot:
        words.append("--no-plot")
    return _ended(_core.run_verb(words), folder)
