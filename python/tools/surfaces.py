"""The tables of docs/surfaces.md and docs/edges.md and of the channels in data/benchmarks/plane_collapse_2 and _5.

    PYTHONPATH=build/release/python python3 python/tools/surfaces.py hourglass | silo | drum | channel | door

One thread; the finer cells of hourglass and silo take ten minutes each, everything else together ten.
"""

import pathlib
import sys
import tomllib

import numpy as np

import repose


def discharge(sim: repose.Simulation, what: str) -> None:
    """Prints the mass per time that leaves between 2 and 5 s."""
    start = sim.diagnostics()["mass_kg_per_m"]
    gone = []
    for time in (2.0, 5.0):
        sim.step(until=time)
        now = sim.diagnostics()
        gone.append(now["outflow_kg_per_m"])
        error = (now["mass_kg_per_m"] + gone[-1]) / start - 1.0
    print(f"{what}: {(gone[1] - gone[0]) / 3.0:.4f} kg/(m s), mass {error:.1e}", flush=True)


def hourglass() -> None:
    for h, widths in ((0.05, (0.314, 0.5, 0.7, 0.71, 0.725, 0.75, 0.775, 0.79, 0.8, 0.9, 1.096)), (0.025, (0.314, 0.7, 1.096))):
        for width in widths:
            left, right = 2.5 - width / 2, 2.5 + width / 2
            sim = repose.Simulation("hourglass", threads=1, **{
                "grid.h": h,
                "surface[0].corners": [[-1.0, 0.6], [left, 0.6], [left, 1.0], [-1.0, 1.0]],
                "surface[1].corners": [[right, 0.6], [6.0, 0.6], [6.0, 1.0], [right, 1.0]]})
            discharge(sim, f"h = {h} m, slot of {width} m")


def silo() -> None:
    for h, widths in ((0.05, (0.314, 0.5, 0.7, 0.71, 0.725, 0.75, 0.775, 0.79, 0.8, 0.9, 1.096)),
                      (0.025, (0.314, 0.7, 1.096))):
        for width in widths:
            opening = {"from": 2.5 - width / 2, "to": 2.5 + width / 2, "kind": "open"}
            sim = repose.Simulation("silo", threads=1, **{
                "grid.h": h, "domain.floor": [opening, {"kind": "no_slip"}]})
            discharge(sim, f"h = {h} m, opening of {width} m")


def drum() -> None:
    for spin in (0.25, 1.0, 2.5):
        sim = repose.Simulation("drum", threads=1, **{"surface[0].spin": spin})
        slopes = []
        for time in (2.0, 2.5, 3.0, 3.5, 4.0):
            sim.step(until=time)
            x, y = sim.points.position.T
            columns = np.arange(0.07, 0.171, 0.01)
            # the third highest point of a column: what flies does not count
            top = [np.sort(y[np.abs(x - at) < 0.005])[-3] for at in columns]
            slopes.append(np.degrees(np.arctan(np.polyfit(columns, top, 1)[0])))
        print(f"{spin} rad/s: {np.mean(slopes):.1f} deg, scatter {np.std(slopes, ddof=1):.1f}", flush=True)


def channel() -> None:
    for a, cells, depth, box, end, K in ((2, 13, 6, (78, 39), 1.4, 144060.0), (5, 8, 4, (120, 48), 2.2, 360150.0)):
        h = 0.1 / cells
        for friction in (0.0, 0.2, 0.4):
            wall = {"friction": friction} if friction > 0.0 else "slip"
            sim = repose.Simulation("channel_collapse", threads=1, **{
                "grid.h": h, "scene.end_time": end, "domain.size": [box[0] * h, box[1] * h, depth * h],
                "domain.near": wall, "domain.far": wall,
                "body[0].size": [0.1, 0.1 * a, depth * h], "body[0].law.K": K})
            sim.step(until=end)
            now = sim.diagnostics()
            print(f"a = {a}, walls {10 * depth * h:.2f} L_0 apart, friction {friction}: "
                  f"run-out {(now['front_99_m'] - 0.1) / 0.1:.2f}, H/L_0 {now['height_m'] / 0.1:.2f}", flush=True)


def door() -> None:
    """The column of `gate`, without the rock, behind a door that is lifted: in the plane and in space."""
    for speed in (1.0, 2.0, None):
        for depth in (None, 0.0625):
            scene = tomllib.loads(pathlib.Path("data/scenes/gate.toml").read_text())
            del scene["surface"][1]
            scene["surface"][0]["velocity"] = [0.0, speed or 0.0]
            if speed is None:
                del scene["surface"]
            if depth is not None:
                scene["domain"]["size"].append(depth)
                scene["body"][0]["size"].append(depth)
                for gate in scene.get("surface", []):
                    gate["velocity"].append(0.0)
            sim = repose.Simulation(scene, threads=1)
            mass = sim.diagnostics()["mass_kg_per_m" if depth is None else "mass_kg"]
            fronts = []
            for time in (0.1, 0.2, 0.3, 0.4, 0.6):
                sim.step(until=time)
                fronts.append(sim.diagnostics()["front_99_m"])
            now = sim.diagnostics()
            lost = now["mass_kg_per_m" if depth is None else "mass_kg"] / mass - 1.0
            print(f"door {'gone at once' if speed is None else f'at {speed} m/s'}, {'plane' if depth is None else 'space'}: "
                  f"x of 99 % of the mass {' '.join(f'{x:.4f}' for x in fronts)} m, mass {lost:.1e}", flush=True)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        {"hourglass": hourglass, "silo": silo, "drum": drum, "channel": channel, "door": door}[name]()
