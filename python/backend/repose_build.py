"""Builds the wheel of repose with CMake (PEP 517), without anything but the standard library.

    pip install .
    pip install . -C cmake=-DREPOSE_NATIVE=OFF -C build-dir=build/other

`cmake` are further arguments of the configuration, `build-dir` where it builds (default:
build/wheel, or $REPOSE_WHEEL_BUILD_DIR). The wheel holds the package, the program, and below the
package what other C++ programs need: include/, lib/ and lib/cmake/repose/.
"""

import base64
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _version() -> str:
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    found = re.search(r"project\(repose VERSION ([0-9.]+)", text)
    if found is None:
        raise RuntimeError("CMakeLists.txt says no version")
    return found.group(1)


NAME = f"{PROJECT['name']}-{_version()}"
TAG = "cp{0}{1}-cp{0}{1}-{2}".format(sys.version_info.major, sys.version_info.minor,
                                     re.sub(r"[-.]", "_", sysconfig.get_platform()))


def _metadata() -> dict[str, str]:
    lines = ["Metadata-Version: 2.1", f"Name: {PROJECT['name']}", f"Version: {_version()}",
             f"Summary: {PROJECT['description']}", f"Requires-Python: {PROJECT['requires-python']}"]
    lines += [f"Requires-Dist: {needed}" for needed in PROJECT["dependencies"]]
    for extra, needs in PROJECT["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {needed}; extra == "{extra}"' for needed in needs]
    lines.append("Description-Content-Type: text/markdown")
    about = (ROOT / PROJECT["readme"]).read_text(encoding="utf-8")
    scripts = "".join(f"{name} = {what}\n" for name, what in PROJECT["scripts"].items())
    return {"METADATA": "\n".join(lines) + "\n\n" + about,
            "WHEEL": f"Wheel-Version: 1.0\nGenerator: repose_build\nRoot-Is-Purelib: false\nTag: {TAG}\n",
            "entry_points.txt": f"[console_scripts]\n{scripts}",
            "LICENSE": (ROOT / "LICENSE").read_text(encoding="utf-8")}


def get_requires_for_build_wheel(config_settings=None):
    """Nothing: all that is needed comes from the distribution."""
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the .dist-info folder alone, without a build."""
    folder = Path(metadata_directory) / f"{NAME}.dist-info"
    folder.mkdir()
    for name, text in _metadata().items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder.name


def _run(*command: str) -> None:
    print("+", shlex.join(command), flush=True)
    subprocess.run(command, check=True)


def _build(stage: Path, settings: dict) -> None:
    """Fills `stage` with the folder repose/ as it lies in site-packages."""
    build = Path(settings.get("build-dir") or os.environ.get("REPOSE_WHEEL_BUILD_DIR")
                 or ROOT / "build" / "wheel").absolute()
    more = settings.get("cmake", [])
    more = shlex.split(more) if isinstance(more, str) else list(more)
    if shutil.which("cmake") is None:
        raise SystemExit("repose: CMake is missing; scripts/packages build python installs what is needed")
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    _run("cmake", "-S", str(ROOT), "-B", str(build), *generator, "-DCMAKE_BUILD_TYPE=Release",
         "-DREPOSE_TESTS=OFF", "-DREPOSE_PYTHON=ON", "-DCMAKE_INSTALL_LIBDIR=lib",
         f"-DPython3_EXECUTABLE={sys.executable}", *more)
    _run("cmake", "--build", str(build), "--parallel", str(len(os.sched_getaffinity(0))))
    built = build / "python" / "repose"
    if not list(built.glob("_core*.so")):
        raise SystemExit("repose: the Python package was not built: pybind11 or Python's headers are "
                         "missing; scripts/packages build python installs them")
    shutil.copytree(built, stage / "repose", ignore=shutil.ignore_patterns("__pycache__"))
    _run("cmake", "--install", str(build), "--prefix", str(stage / "repose"), "--strip")


def _line(name: str, content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds the wheel and returns its file name."""
    wheel = f"{NAME}-{TAG}.whl"
    with tempfile.TemporaryDirectory() as folder:
        stage = Path(folder)
        _build(stage, config_settings or {})
        record = ""
        with zipfile.ZipFile(Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as archive:
            def add(name: str, content: bytes, mode: int = 0o644) -> None:
                nonlocal record
                entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))  # the same bytes at any time
                entry.external_attr = (0o100000 | mode) << 16
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, content)
                record += _line(name, content)
            for file in sorted(p for p in stage.rglob("*") if p.is_file()):
                mode = 0o755 if os.access(file, os.X_OK) else 0o644
                add(file.relative_to(stage).as_posix(), file.read_bytes(), mode)
            for name, text in _metadata().items():
                add(f"{NAME}.dist-info/{name}", text.encode())
            entry = f"{NAME}.dist-info/RECORD"
            archive.writestr(zipfile.ZipInfo(entry, (1980, 1, 1, 0, 0, 0)), record + f"{entry},,\n")
    return wheel
