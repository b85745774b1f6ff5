"""What ground from a map costs a point in a step, against a box's floor with friction (docs/terrain.md).

    python3 python/tools/terrain_cost.py build/release/bin/repose [PAIRS]

A sheet four cells thick on level ground and on waves with a slope of 0.2, and `valley` with cells of 2.5 m against an equally
thin sheet; one thread, the two in turn, CPU of whole runs.
"""

import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

LAW = """
[body.law]
name = "mu_i"
mu_0 = 0.40
mu_d = 0.65
I_0 = 0.3
d = 0.1          # m
rho_p = 2600.0   # kg/m3
rho_0 = 1600.0   # kg/m3
K = 4.0e6        # Pa
"""


def write_map(path: pathlib.Path, value) -> None:
    columns, rows, cell = 100, 60, 2.0
    lines = [f"ncols {columns}", f"nrows {rows}", "xllcorner 0", "yllcorner 0", f"cellsize {cell}", "NODATA_value -9999"]
    for row in range(rows):
        y = (rows - row - 0.5) * cell
        lines.append(" ".join(f"{value((i + 0.5) * cell, y):.3f}" for i in range(columns)))
    path.write_text("\n".join(lines) + "\n")


def on_map(folder: pathlib.Path, name: str) -> pathlib.Path:
    scene = folder / f"{name}.toml"
    scene.write_text(f"""[scene]
name = "{name}"
end_time = 0.4  # s
[terrain]
ground = "{name}.asc"
release = "release.asc"
friction = 0.3
[[body]]
shape = "release"
velocity = [5.0, 0.0, 0.0]  # m/s
{LAW}[grid]
h = 1.0  # m
""")
    return scene


def on_floor(folder: pathlib.Path, name: str, size: tuple, h: float, end: float) -> pathlib.Path:
    scene = folder / f"{name}.toml"
    scene.write_text(f"""[scene]
name = "{name}"
end_time = {end}  # s
[domain]
size = [200.0, 20.0, 120.0]  # m
floor = {{ friction = 0.3 }}
left = "open"
right = "open"
near = "open"
far = "open"
[[body]]
origin = [20.0, 0.0, 20.0]  # m
size = {list(size)}
velocity = [5.0, 0.0, 0.0]  # m/s
{LAW}[grid]
h = {h}  # m
""")
    return scene


def nanoseconds(command: str, scene: list) -> float:
    """CPU of a point in a step."""
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([command, "run", *scene, "--threads", "1", "--quiet", "--no-plot", "-o", out], check=True)
        summary = json.loads((pathlib.Path(out) / "summary.json").read_text())
    return 1e9 * summary["cpu_s"] / (summary["points"] * summary["steps"])


def compare(command: str, what: str, scene: list, floor: list, pairs: int) -> None:
    nanoseconds(command, scene)  # warm
    ratios = sorted(nanoseconds(command, scene) / nanoseconds(command, floor) for _ in range(pairs))
    print(f"{what}: {statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})", flush=True)


def main() -> None:
    command, pairs = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_map(folder / "level.asc", lambda x, y: 10.0)
        write_map(folder / "waves.asc", lambda x, y: 50.0 - 0.2 * x + 0.5 * math.sin(x / 8.0) * math.cos(y / 9.0))
        write_map(folder / "release.asc", lambda x, y: 4.0 if 20.0 < x < 140.0 and 20.0 < y < 100.0 else 0.0)
        thick = [str(on_floor(folder, "thick", (120.0, 4.0, 80.0), 1.0, 0.4))]
        thin = [str(on_floor(folder, "thin", (160.0, 2.5, 80.0), 2.5, 3.0))]
        for ground in ("level", "waves"):
            compare(command, ground, [str(on_map(folder, ground))], thick, pairs)
        valley = ["valley", "--set", "grid.h=2.5", "--set", "scene.end_time=6"]
        compare(command, "valley", valley, thin, pairs)


main()
