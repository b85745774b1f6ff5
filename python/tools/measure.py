"""What Python costs: a run against the command, and a point test over the library's simulate().

    PYTHONPATH=build/release/python python3 python/tools/measure.py build/release/bin/repose
"""

import statistics
import subprocess
import sys
import tempfile
import time

import repose

SCENE = {"grid.h": 0.00625, "scene.end_time": 0.5}


def run_overhead(command: str, repeats: int) -> None:
    """CPU seconds of the same run by the command and by repose.run, in turn."""
    shares = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats):
            words = [w for k, v in SCENE.items() for w in ("--set", f"{k}={v}")]
            subprocess.run([command, "run", "flat_mu_i", "-o", folder, "--quiet", "--no-plot",
                            "--threads", "1", *words], check=True)
            alone = repose.Result(folder).summary["cpu_s"]
            done = repose.run("flat_mu_i", folder, threads=1, quiet=True, plot=False, **SCENE)
            shares.append(done.summary["cpu_s"] / alone - 1.0)
            print(f"command {alone:.3f} s, repose.run {100 * shares[-1]:+.1f} %", flush=True)
    print(f"median of {repeats} pairs: {100 * statistics.median(shares):+.1f} %")


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
    run_overhead(sys.argv[1], 14)
