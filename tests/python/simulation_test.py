"""Scenes from Python: stepping, arrays, changes while running, checkpoints, result folders."""

import copy
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
import unittest

import numpy as np

import repose

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
COMMAND = os.environ["REPOSE_COMMAND"]
COARSE = {"grid.h": 0.025, "scene.end_time": 0.2}


class Stepping(unittest.TestCase):
    def test_points_and_nodes_hold_the_same_mass_and_momentum(self):
        for name, changes in (("flat_mu_i", COARSE), ("flat_mu_i", {**COARSE, "domain.floor": "slip"})):
            sim = repose.Simulation(name, **changes)
            before = sim.points
            sim.step(until=0.1)
            points, row = sim.points, sim.diagnostics()
            self.assertEqual(points.position.shape, (len(before), 2))
            # sums of some hundred positive terms in another order
            self.assertAlmostEqual(points.mass.sum() / row["mass_kg_per_m"], 1.0, delta=1e-13)
            nodes = sim.nodes
            self.assertEqual(nodes.velocity.shape, (*nodes.mass.shape, 2))
            self.assertAlmostEqual(nodes.mass.sum() / points.mass.sum(), 1.0, delta=1e-13)
            np.testing.assert_array_equal(nodes.momentum[..., 0], nodes.mass * nodes.velocity[..., 0])
            momentum = (points.mass[:, None] * points.velocity).sum(axis=0)
            self.assertAlmostEqual(momentum[0], row["momentum_x"], delta=1e-12 * abs(momentum[0]))

    def test_arrays_are_copies(self):
        sim = repose.Simulation("flat_mu_i", **COARSE)
        sim.points.position[:] = 0.0
        self.assertGreater(sim.points.position.max(), 0.1)

    def test_ends_in_the_bits_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([COMMAND, "run", "flat_mu_i", "-o", folder, "--quiet", "--no-plot",
                            *(w for k, v in COARSE.items() for w in ("--set", f"{k}={v}"))], check=True)
            there = repose.Result(folder)
            # the command stops at every row and frame: here as well
            sim = repose.Simulation("flat_mu_i", **COARSE)
            for t in there.series["time_s"][1:]:
                sim.step(until=t)
            self.assertEqual(sim.time, 0.2)
            for key, value in sim.diagnostics().items():
                self.assertEqual(value, there.series[key][-1], key)
            np.testing.assert_array_equal(sim.profile()["depth_m"], there.profile["depth_m"])
            frame = there.frames[-1]
            self.assertEqual(frame.time_s, 0.2)
            # frames hold single precision
            np.testing.assert_allclose(frame["position_m"][:, :2], sim.points.position, rtol=1e-7)

    def test_goes_on_from_a_checkpoint_with_the_same_bits(self):
        sim = repose.Simulation("flat_mu_i", **COARSE)
        sim.step(steps=20)
        sim.gravity = 4.0
        sim.set_wall("right", {"friction": 0.3})
        sim.set_wall("floor", [{"from": 0.15, "to": 0.4, "kind": "open"}, {"kind": "no_slip"}])
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "state.h5")
            sim.save(file)
            again = repose.Simulation.load(file, threads=1)
            self.assertEqual(again.gravity, 4.0)
            for one in (sim, again):
                one.step(until=0.1)
            np.testing.assert_array_equal(again.points.stress, sim.points.stress)
            self.assertEqual(again.diagnostics(), sim.diagnostics())
            with open(file, "r+b") as damaged:
                damaged.seek(1000)
                damaged.write(b"xxxx")
            with self.assertRaises(OSError):
                repose.Simulation.load(file)
        with self.assertRaises(OSError):
            repose.Simulation.load("nowhere.h5")

    def test_a_save_that_fails_leaves_what_was_there(self):
        sim = repose.Simulation("flat_mu_i", **COARSE)
        sim.step(steps=5)
        with tempfile.TemporaryDirectory() as folder:
            for name, gravity in (("run_0.1", 9.0), ("run_0.2", 8.0)):
                sim.gravity = gravity
                sim.save(os.path.join(folder, name))
            self.assertEqual(repose.Simulation.load(os.path.join(folder, "run_0.1")).gravity, 9.0)
            before = sorted(os.listdir(folder))
            with self.assertRaises(OSError):
                sim.save(folder)
            sim.gravity = 1e5
            with self.assertRaises(repose.NumericalFailure):
                sim.step(until=1.0)
            with self.assertRaises(RuntimeError):
                sim.save(os.path.join(folder, "run_0.1"))
            self.assertEqual(sorted(os.listdir(folder)), before)
            self.assertEqual(repose.Simulation.load(os.path.join(folder, "run_0.1")).gravity, 9.0)

    def test_a_step_that_leads_nowhere_is_refused(self):
        sim = repose.Simulation("flat_mu_i", **COARSE)
        sim.step(until=0.02)
        for wrong in (dict(until=float("nan")), dict(until=0.01), dict(steps=-1), dict(until=0.03, steps=1)):
            with self.assertRaisesRegex(repose.InputError, "step: "):
                sim.step(**wrong)
        with self.assertRaisesRegex(TypeError, "save"):
            copy.copy(sim)

    def test_a_law_stands_in_for_that_of_every_body(self):
        with open(os.path.join(ROOT, "data/scenes/flat_mu_i.toml"), "rb") as file:
            scene = tomllib.load(file)
        scene["grid"]["h"] = 0.05
        second = {**scene["body"][0], "origin": [0.4, 0.0]}
        scene["body"].append(second)
        water = {"name": "newtonian", "rho_0": 1000.0, "K": 2.5e5, "eta": 1.0}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "two.toml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(repose.inputs.document(scene))
            for source in (scene, path):
                density = repose.Simulation(source, law=water).points.density
                np.testing.assert_array_equal(density, 1000.0)
                stiff = repose.Simulation(source, law={"K": 1e9})
                soft = repose.Simulation(source)
                # the signal grows with √K, so the step falls by √(1e9/254800) = 63
                self.assertLess(stiff.next_dt, soft.next_dt / 50)

    def test_gravity_may_turn_and_the_ledger_still_closes(self):
        sim = repose.Simulation("flat_mu_i", **COARSE)
        sim.step(until=0.1)
        sim.gravity, sim.tilt_deg = 0.0, 0.0
        before = sim.points
        # no step yet, and all as it was
        np.testing.assert_array_equal(before.position, sim.points.position)
        sim.gravity = 9.8
        sim.tilt_deg = 20.0
        sim.step(until=0.2)
        row = sim.diagnostics()
        # as in a run without a change: below 1 % of the energy that moved (0.05 % there)
        self.assertLess(abs(row["energy_residual_J_per_m"]),
                        0.01 * (row["kinetic_J_per_m"] + row["dissipated_J_per_m"]))
        self.assertGreater(row["momentum_x"], 0.0)

    def test_free_fall_has_the_gravity_that_was_set(self):
        law = repose.Law("neo_hookean", E=1e4, nu=0.3, rho_0=1000.0)
        sim = repose.Simulation({"scene": {"name": "fall", "end_time": 1.0, "gravity": 0.0},
                                 "domain": {"size": [1.0, 1.0]}, "grid": {"h": 0.1},
                                 "body": [{"origin": [0.4, 0.6], "size": [0.2, 0.2], "law": law}]})
        sim.step(until=0.01)
        sim.gravity = 2.0
        sim.step(until=0.11)
        # v = g t, to round-off of some hundred steps
        np.testing.assert_allclose(sim.points.velocity[:, 1], -2.0 * 0.1, rtol=1e-11)

    def test_mistakes(self):
        with self.assertRaisesRegex(repose.InputError, "grid.hh=1: unknown key 'hh'.*did you mean 'h'"):
            repose.Simulation("flat_mu_i", grid={"hh": 1})
        with self.assertRaisesRegex(repose.InputError, "did you mean 'flat_mu_i'"):
            repose.Simulation("flat_mui")
        sim = repose.Simulation("flat_mu_i", **COARSE)
        for edge, wall, words in (("rigt", "open", "did you mean 'right'"), ("right", "opne", "must be one of"),
                                  ("right", "periodic", "does not become periodic")):
            with self.assertRaisesRegex(repose.InputError, words):
                sim.set_wall(edge, wall)
        with self.assertRaisesRegex(repose.InputError, "gravity"):
            sim.gravity = -1.0
        self.assertEqual(sim.gravity, 9.8)

    def test_failure_is_told_once_and_for_all(self):
        sim = repose.Simulation("flat_mu_i", **COARSE, **{"step.dt": 0.02})
        with self.assertRaisesRegex(repose.NumericalFailure, "dt"):
            sim.step(until=0.2)
        with self.assertRaisesRegex(RuntimeError, "cannot go on"):
            sim.step()

    def test_other_threads_of_python_run_meanwhile(self):
        sim = repose.Simulation("flat_mu_i", threads=1, **{**COARSE, "grid.h": 0.0125})
        counted = []
        stop = threading.Event()

        def count():
            while not stop.wait(0.001):
                counted.append(1)
        thread = threading.Thread(target=count)
        thread.start()
        begun = time.perf_counter()
        sim.step(until=0.1)
        seconds = time.perf_counter() - begun
        during = len(counted)
        stop.set()
        thread.join()
        # a thread that has the lock wakes every millisecond or a few; without it, never
        self.assertGreater(during, 20 * seconds)


class Folders(unittest.TestCase):
    def test_run_failure_and_resume(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "run")
            result = repose.run("flat_mu_i", out, quiet=True, plot=False, **COARSE)
            self.assertEqual((result.status, result.kind), ("done", "run"))
            self.assertEqual(result.series["time_s"][-1], 0.2)
            self.assertIn("front_99_m", result.series)
            self.assertEqual(repose.run("flat_mu_i", out, quiet=True, plot=False, resume=True, **COARSE).status,
                             "done")
            with self.assertRaisesRegex(repose.InputError, "resumed with the input"):
                changed = {**COARSE, "scene.gravity": 5.0}
                os.remove(os.path.join(out, "manifest.json"))
                repose.run("flat_mu_i", out, quiet=True, plot=False, resume=True, **changed)
            bad = os.path.join(folder, "bad")
            with self.assertRaisesRegex(repose.NumericalFailure, "dt") as caught:
                repose.run("flat_mu_i", bad, quiet=True, plot=False, **COARSE, **{"step.dt": 0.02})
            self.assertEqual(caught.exception.result.status, "failed")
            with self.assertRaises(FileNotFoundError):
                repose.Result(os.path.join(folder, "nothing"))
            with self.assertRaisesRegex(KeyError, "did you mean 'series'"):
                result.table("seris")

    def test_maps_of_a_terrain(self):
        law = dict(name="mu_i", mu_0=0.38, mu_d=0.57, I_0=0.28, d=0.05, rho_p=2000, rho_0=1300, K=1e6)
        with tempfile.TemporaryDirectory() as folder:
            rows, columns, cell = 12, 20, 3.0
            header = f"ncols {columns}\nnrows {rows}\nxllcorner 100\nyllcorner 200\ncellsize {cell}\n"

            def write(name, values):
                path = os.path.join(folder, name)
                with open(path, "w", encoding="utf-8") as out:
                    out.write(header)
                    np.savetxt(out, values, fmt="%.3f")
                return path
            east = np.tile(500.0 - 1.2 * np.arange(columns), (rows, 1))
            depth = np.zeros((rows, columns))
            depth[4:8, 3:7] = 2.0  # 12 m by 12 m
            scene = {"scene": {"end_time": 1.5}, "terrain": {
                        "ground": write("ground.asc", east), "release": write("release.asc", depth), "friction": 0.2},
                     "body": [{"shape": "release", "law": law}], "grid": {"h": 1.5}}
            sim = repose.Simulation(scene, threads=1)
            start = sim.maps()["deposit"]
            self.assertEqual(start.values.shape, (rows, columns))
            self.assertEqual((start.west, start.south, start.cell), (100.0, 200.0, cell))
            self.assertEqual(start.extent, (100.0, 160.0, 200.0, 236.0))
            self.assertEqual(start.transform, (100.0, 3.0, 0.0, 236.0, 0.0, -3.0))
            # the release is 288 m³, two metres deep within it; it lies around x = 115, y = 218
            self.assertAlmostEqual(start.values.sum() * cell**2, 288.0, delta=288.0 * 1e-12)
            self.assertAlmostEqual(start.at(115.0, 218.0), 2.0, delta=1e-12)
            self.assertAlmostEqual((start.values * start.x).sum() / start.values.sum(), 115.0, delta=1e-9)
            self.assertAlmostEqual((start.values.sum(axis=1) * start.y).sum() / start.values.sum(), 218.0, delta=1e-9)
            self.assertTrue(np.isnan(start.at(0.0, 0.0)))
            sim.run()
            result = repose.run(scene, os.path.join(folder, "out"), quiet=True, plot=False, threads=1)
            self.assertEqual(list(result.maps), ["largest_depth", "largest_speed", "arrival_time", "deposit"])
            for name, now in sim.maps().items():  # files keep three digits after the point
                np.testing.assert_allclose(result.maps[name].values, now.values, atol=0.5e-3 + 1e-12, err_msg=name)
            self.assertEqual(sim.diagnostics()["runout_99_m"], result.series["runout_99_m"][-1])
            self.assertGreater(result.maps["largest_speed"].values.max(), 0.3)
            self.assertEqual(repose.Map.read(os.path.join(folder, "ground.asc")).at(101.0, 201.0), 500.0)
            with self.assertRaisesRegex(KeyError, "did you mean 'deposit'"):
                result.maps["depositt"]
            with self.assertRaisesRegex(repose.InputError, "no key of an ESRI ASCII grid|nor a raster"):
                broken = os.path.join(folder, "broken.txt")
                with open(broken, "w", encoding="utf-8") as out:
                    out.write("nothing\n")
                repose.Map.read(broken)
            with self.assertRaises(OSError):
                repose.Map.read(os.path.join(folder, "nothing.asc"))
            self.assertEqual(len(result.plot().axes), 6)  # series, energies, two maps with their colour bars
        with self.assertRaisesRegex(repose.InputError, "only a scene with a terrain"):
            repose.Simulation("flat_mu_i", threads=1, **COARSE).maps()

    def test_interrupt_leaves_a_checkpoint_that_a_run_goes_on_from(self):
        program = ("import repose, sys\n"
                   "try:\n"
                   "    repose.run('flat_mu_i', sys.argv[1], quiet=True, plot=False, threads=1, **{'grid.h': 0.0125})\n"
                   "except KeyboardInterrupt as stop:\n"
                   "    print('stopped:', stop)\n")
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "run")
            child = subprocess.Popen([sys.executable, "-c", program, out], stdout=subprocess.PIPE, text=True)
            series = os.path.join(out, "series.csv")
            for _ in range(2000):
                if os.path.exists(series) and os.path.getsize(series) > 2000:
                    break
                time.sleep(0.01)
            child.send_signal(signal.SIGINT)
            said, _ = child.communicate(timeout=60)
            self.assertIn("stopped:", said)
            self.assertEqual(repose.Result(out).status, "interrupted")
            self.assertTrue(os.path.exists(os.path.join(out, "checkpoint.h5")))

    def test_interrupt_between_steps(self):
        program = ("import repose\n"
                   "sim = repose.Simulation('flat_mu_i', threads=1)\n"
                   "print('begun', flush=True)\n"
                   "try:\n"
                   "    sim.run()\n"
                   "except KeyboardInterrupt:\n"
                   "    t = sim.time\n"
                   "    print('stopped', 0.0 < sim.step() and sim.time > t)\n")
        child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "begun\n")
        time.sleep(0.3)
        child.send_signal(signal.SIGINT)
        said, _ = child.communicate(timeout=60)
        self.assertEqual(said, "stopped True\n")

    def test_sweeps(self):
        with tempfile.TemporaryDirectory() as folder:
            tests = repose.sweep("weald_clay_undrained", grid={"initial.ocr": [1, 2], "law.M": [0.9, 1.0]},
                                 output=os.path.join(folder, "tests"), quiet=True, plot=False)
            self.assertEqual(tests.sweep.rows, 4)
            np.testing.assert_array_equal(tests.sweep["initial.ocr"], [1, 1, 2, 2])
            one = repose.point("weald_clay_undrained", **{"initial.ocr": 2, "law.M": 0.9})
            self.assertEqual(tests.sweep["S_u_Pa"][2], one.laboratory["S_u_Pa"])
            scenes = repose.sweep("flat_mu_i", list=[{"grid.h": 0.025}, {"grid.h": 0.05}],
                                  output=os.path.join(folder, "scenes"), quiet=True, plot=False,
                                  scene={"end_time": 0.05})
            self.assertEqual([run.status for run in scenes.runs], ["done", "done"])

    def test_sensitivities(self):
        asked = {"samples": 40, "output": "S_u_Pa",
                 "input": [{"key": "law.M", "lower": 0.9, "upper": 1.0},
                           {"key": "initial.p", "mean": 207e3, "sd": 10e3}]}
        with tempfile.TemporaryDirectory() as folder:
            found = repose.sensitivity("weald_clay_undrained", asked, output=folder, quiet=True, plot=False)
            self.assertEqual(found.kind, "sensitivity")
            self.assertEqual(found.samples.rows, 40)
            # S_u = M p ...: the shares are those of two products, which add up nearly to one
            self.assertAlmostEqual(sum(found.table("sensitivity")["first"]), 1.0, delta=0.01)
            self.assertGreater(found.summary["outputs"][0]["surrogate"]["q2"], 0.999)
        with self.assertRaisesRegex(repose.InputError, "did you mean 'S_u_Pa'"):
            repose.sensitivity("weald_clay_undrained", asked | {"output": "S_u"}, output=folder, quiet=True)


if __name__ == "__main__":
    unittest.main()
