"""What stepping a scene from Python costs in instructions, which do not depend on what else the machine does.

    PYTHONPATH=build/release/python python3 python/tools/instructions.py build/release/bin/repose [H]

Counts by valgrind (cachegrind) the instructions of `repose run` and of a script that steps the same scene from row
to row of its series, one thread, no frames, no picture; from each is taken what the same takes for a single step. Valgrind
knows no AVX-512: a build for this has -DREPOSE_MARCH=x86-64-v3 -DREPOSE_NATIVE=OFF.
"""

import re
import subprocess
import sys
import tempfile

SCENE = {"grid.h": float(sys.argv[2]) if len(sys.argv) > 2 else 0.025, "output.frame_interval": 0.0, "output.series_interval": 0.005, "output.checkpoint_interval": 0.0}
END, ONE_STEP = 0.2, 1e-6
SCRIPT = """
import sys, repose
sim = repose.Simulation("flat_mu_i", threads=1, **{changes})
rows = [sim.diagnostics()]
while sim.time < sim.end_time:
    sim.step(until=min(len(rows) * 0.005, sim.end_time))
    rows.append(sim.diagnostics())
print(sim.steps, sim.diagnostics()["front_99_m"])
"""


def instructions(arguments: list[str]) -> int:
    done = subprocess.run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null", *arguments],
                          capture_output=True, text=True, check=True)
    counted = re.search(r"I\s+refs:\s+([\d,]+)", done.stderr)
    print(done.stdout.strip() or "-", counted[1], flush=True)
    return int(counted[1].replace(",", ""))


def of_command(command: str, end: float) -> int:
    with tempfile.TemporaryDirectory() as folder:
        words = [w for k, v in {**SCENE, "scene.end_time": end}.items() for w in ("--set", f"{k}={v}")]
        return instructions([command, "run", "flat_mu_i", "-o", folder, "--quiet", "--no-plot", "--threads", "1", *words])


def of_script(end: float) -> int:
    return instructions([sys.executable, "-c", SCRIPT.format(changes={**SCENE, "scene.end_time": end})])


if __name__ == "__main__":
    command = of_command(sys.argv[1], END) - of_command(sys.argv[1], ONE_STEP)
    script = of_script(END) - of_script(ONE_STEP)
    print(f"the command's steps {command:.4g}, those from Python {script:.4g} instructions: {100 * (script / command - 1):+.2f} %")
