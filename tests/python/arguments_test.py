"""Arguments of a wrong type, pickles, and result folders that are not finished."""

import copy
import json
import os
import pickle
import subprocess
import tempfile
import unittest

import numpy as np

import repose

COMMAND = os.environ["REPOSE_COMMAND"]
GRAINS = dict(mu_0=0.38, mu_d=0.57, I_0=0.28, d=0.0053, rho_p=2000, rho_0=1300, K=2.5e5)
COARSE = {"grid.h": 0.05, "scene.end_time": 0.2}
FIT = os.path.join(os.environ["REPOSE_SOURCE_DIR"], "data/experiments/fit_kaolin.toml")


class WrongTypes(unittest.TestCase):
    def refused(self, words, call, *args, **kwargs):
        """An InputError that is a TypeError as well, that names the argument and says nothing of pybind11."""
        with self.subTest(words):
            with self.assertRaisesRegex(repose.InputError, words) as caught:
                call(*args, **kwargs)
            self.assertIsInstance(caught.exception, TypeError)
            self.assertEqual(caught.exception.problems, [str(caught.exception)])
            self.assertNotIn("incompatible", str(caught.exception))

    def test_laws(self):
        law = repose.Law("mu_i", **GRAINS)
        a = law.points(16, 6, p=1e3)
        self.refused(r"laws: name must be a text; got 3, a int", repose.laws, 3)
        self.refused(r"update: dt must be a number; got 'x', a str", law.update, *a, a[0], "x")
        self.refused(r"update: in_place must be True or False", law.update, *a, a[0], 1.0, in_place="no")
        self.refused(r"tangent: dt must be a number; got None", law.tangent, *a, a[0], None)
        self.refused(r"density_at: p must be a number", law.density_at, "x")
        self.refused(r"density_at: ocr must be a number; got True", law.density_at, 1e3, True)
        self.refused(r"points: count must be a whole number; got 1.5", law.points, 1.5, p=1e3)
        with self.assertRaisesRegex(repose.InputError, "points: components = 5"):
            law.points(16, 5, p=1e3)
        self.refused("register_law: law must be a class", repose.register_law, 3)

    def test_point_tests(self):
        test = repose.PointTest("weald_clay_undrained")
        self.refused(r"test must be a dictionary, the path of a file or .* got 3", repose.PointTest, 3)
        self.refused(r"run: M must be a number; got 'x'", test.run, M="x")
        self.refused(r"run: strict must be True or False", test.run, strict=1)
        self.refused(r"parameters\[0\] must be a text; got 3", test.sensitivities, [3])
        self.refused(r"parameters must be a list of texts; got 'M'", test.sensitivities, "M")
        self.refused(r"columns must be a list of texts; got 3", test.sensitivities, ["M"], 3)
        self.refused(r"point: output must be a path", repose.point, "weald_clay_undrained", output=3)
        driven = test.run()
        self.refused(r"write: file must be a path", driven.write, 3)
        with self.assertRaisesRegex(KeyError, "a test has no column 3"):
            driven[3]
        self.assertNotIn(3, driven)

    def test_fits(self):
        self.refused(r"source must be a dictionary, the path", repose.fit, 3)
        self.refused(r"fit: seed must be a whole number", repose.fit, FIT, seed="x")
        self.refused(r"fit: threads must be a whole number; got 1.5", repose.fit, FIT, threads=1.5)
        self.refused(r"fit: progress must be a function or None", repose.fit, FIT, progress=3)
        self.refused(r"fit: output must be a path", repose.fit, FIT, output=3)

    def test_scenes(self):
        self.refused(r"scene must be a dictionary, the path", repose.Simulation, 3)
        self.refused(r"Simulation: threads must be a whole number", repose.Simulation, "flat_mu_i", threads="x")
        with self.assertRaisesRegex(repose.InputError, "threads = -1 must be >= 0"):
            repose.Simulation("flat_mu_i", threads=-1)
        sim = repose.Simulation("flat_mu_i", **COARSE)
        self.refused(r"step: until must be a number; got 'x'", sim.step, until="x")
        self.refused(r"step: until must be a number", sim.step, until=np.zeros(2))
        self.refused(r"step: steps must be a whole number; got 1.5", sim.step, steps=1.5)
        self.refused(r"gravity must be a number; got 'x'", setattr, sim, "gravity", "x")
        self.refused(r"tilt_deg must be a number; got None", setattr, sim, "tilt_deg", None)
        self.refused(r"set_wall: edge must be a text", sim.set_wall, 3, "slip")
        self.refused(r"set_wall: wall, unless a text, must be a dictionary; got 3", sim.set_wall, "left", 3)
        for call in (sim.save, repose.Simulation.load, sim.picture):
            self.refused(r": file must be a path; got 3", call, 3)
        # what is a number to Python is one here
        self.assertEqual(sim.step(until=np.float32(0.0)), 0.0)
        self.assertGreater(sim.step(steps=np.int64(1)), 0.0)

    def test_verbs_and_results(self):
        self.refused(r"run: threads must be a whole number", repose.run, "flat_mu_i", threads="x")
        self.refused(r"run: resume must be True or False", repose.run, "flat_mu_i", resume="yes")
        self.refused(r"output must be a path", repose.run, "flat_mu_i", 3)
        self.refused(r"sweep: source must be", repose.sweep, 3)
        self.refused(r"sensitivity: asked must be", repose.sensitivity, "flat_mu_i", 3)
        self.refused(r"sweep: list must be a list of dictionaries", repose.sweep, "flat_mu_i", list=3)
        self.refused(r"chart: what must be a path", repose.chart, 3)
        self.refused(r"validate: cases must be", repose.validate, 3)
        self.refused(r"Result: folder must be a path", repose.Result, 3)
        self.refused(r"keys: kind must be a text", repose.keys, 3)
        self.refused(r"json_schema: kind must be a text", repose.json_schema, 3)

    def test_a_mistyped_law_gets_the_answer_of_the_command(self):
        for name in ("mui", "muu", "modified_cam_clai"):
            said = subprocess.run([COMMAND, "models", name], capture_output=True, text=True)
            with self.assertRaises(repose.InputError) as caught:
                repose.laws(name)
            self.assertIn(str(caught.exception), said.stderr)
        with self.assertRaisesRegex(repose.InputError, 'did you mean "mu_i"'):
            repose.Law("mui", **GRAINS)


class Pickles(unittest.TestCase):
    def test_a_law_comes_back_with_its_parameters(self):
        law = repose.Law("mu_i", **GRAINS)
        for again in (pickle.loads(pickle.dumps(law)), copy.deepcopy(law), copy.copy(law)):
            self.assertEqual(again.as_table(), law.as_table())
            self.assertEqual(again.parameters, law.parameters)

    def test_a_point_test_comes_back_and_drives_the_same(self):
        test = repose.PointTest("weald_clay_undrained", {"M": 0.9}, initial={"ocr": 2})
        again = pickle.loads(pickle.dumps(test))
        np.testing.assert_array_equal(again.run()["q_Pa"], test.run()["q_Pa"])
        with self.assertRaisesRegex(TypeError, "dict\\(result\\)"):
            pickle.dumps(test.run())

    def test_a_running_simulation_says_what_to_do_instead(self):
        sim = repose.Simulation("flat_mu_i", **COARSE)
        with self.assertRaisesRegex(TypeError, "save\\(\\) it"):
            pickle.dumps(sim)
        self.assertEqual(len(pickle.loads(pickle.dumps(sim.points))), len(sim.points))


class Unfinished(unittest.TestCase):
    def folder_of(self, parent):
        out = os.path.join(parent, "run")
        repose.run("flat_mu_i", out, quiet=True, plot=False, **COARSE)
        return out

    def test_a_result_is_pickled_by_its_folder(self):
        with tempfile.TemporaryDirectory() as parent:
            result = repose.Result(self.folder_of(parent))
            result.frames  # what it keeps does not travel
            again = pickle.loads(pickle.dumps(result))
            self.assertEqual((again.folder, again.status), (result.folder, "done"))
            np.testing.assert_array_equal(again.series["time_s"], result.series["time_s"])

    def test_a_run_that_was_killed_is_read_as_far_as_it_was_written(self):
        with tempfile.TemporaryDirectory() as parent:
            out = self.folder_of(parent)
            whole = repose.Result(out).series["time_s"]
            for name in ("manifest.json", "summary.json"):
                os.remove(os.path.join(out, name))
            series = os.path.join(out, "series.csv")
            with open(series, encoding="utf-8") as file:
                lines = file.read().splitlines(keepends=True)
            # the fifth row stopped within a number
            with open(series, "w", encoding="utf-8") as file:
                file.write("".join(lines[:5]) + lines[5][:len(lines[5]) // 2])
            result = repose.Result(out)
            self.assertEqual(result.status, "interrupted")
            self.assertIn("interrupted", repr(result))
            self.assertEqual(result.summary, {})
            np.testing.assert_array_equal(result.series["time_s"], whole[:4])
            self.assertEqual(result.input["scene"]["name"], "flat_mu_i")
            # killed after its first checkpoint, whose summary says that it is running
            with open(os.path.join(out, "summary.json"), "w", encoding="utf-8") as file:
                json.dump({"status": "running", "name": "flat_mu_i"}, file)
            self.assertEqual(repose.Result(out).status, "interrupted")
            # and while a process has the folder
            lock = os.path.join(out, ".repose-lock")
            with open(lock, "w", encoding="utf-8") as file:
                file.write(f"{os.getpid()}\n")
            self.assertEqual(repose.Result(out).status, "running")
            ended = subprocess.Popen(["true"])
            ended.wait()
            for left in (f"{ended.pid}\n", "", "no number"):
                with open(lock, "w", encoding="utf-8") as file:
                    file.write(left)
                self.assertEqual(repose.Result(out).status, "interrupted", left)


if __name__ == "__main__":
    unittest.main()
