"""What Python costs: a run against the command, and a point test over the library's simulate().

    PYTHONPATH=build/release/python python3 python/tools/measure.py build/release/bin/repose
"""

import statistics
import subprocess
import sys
import tempfile
import time

import repose

SCENE = {"grid.h": 0.0125}


def run_overhead(command: str, repeats: int) -> None:
    """CPU seconds of the same run by the command, by repose.run and stepped by Simulation, in turn."""
    spent = {"command": [], "run": [], "Simulation": []}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats):
            words = [w for k, v in SCENE.items() for w in ("--set", f"{k}={v}")]
            subprocess.run([command, "run", "flat_mu_i", "-o", folder, "--quiet", "--no-plot",
                            "--threads", "1", *words], check=True)
            spent["command"].append(repose.Result(folder).summary["cpu_s"])
            done = repose.run("flat_mu_i", folder, threads=1, quiet=True, plot=False, **SCENE)
            spent["run"].append(done.summary["cpu_s"])
            begun = time.process_time()
            sim = repose.Simulation("flat_mu_i", threads=1, **SCENE)
            while sim.time < sim.end_time:
                sim.step()
            spent["Simulation"].append(time.process_time() - begun)
    for name, seconds in spent.items():
        print(f"{name:<11} least {min(seconds):.3f} s, median {statistics.median(seconds):.3f} s of CPU")
    for name in ("run", "Simulation"):
        print(f"{name}: {100 * (min(spent[name]) / min(spent['command']) - 1):+.2f} % over the command (least)")


def point_overhead(repeats: int) -> None:
    """Seconds of PointTest.run() beyond those of simulate() inside."""
    for name in ("weald_clay_undrained", "kaolin_isotropic"):
        test = repose.PointTest(name)
        over, inside, column = [], [], []
        for _ in range(repeats):
            begun = time.perf_counter()
            result = test.run()
            spent = time.perf_counter() - begun
            inside.append(result._driven.wall_s)
            over.append(spent - inside[-1])
            begun = time.perf_counter()
            result["q_Pa"]
            column.append(time.perf_counter() - begun)
        print(f"{name}: simulate() {1e6 * statistics.median(inside):.1f} µs, over it "
              f"{1e6 * statistics.median(over):.1f} µs, a column {1e6 * statistics.median(column):.1f} µs")


if __name__ == "__main__":
    print(repose.__version__, repose.instruction_set)
    point_overhead(2000)
    run_overhead(sys.argv[1], 5)
