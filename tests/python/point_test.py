"""Point tests from Python against the command, and what is wrong with them."""

import csv
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

import repose

COMMAND = os.environ["REPOSE_COMMAND"]


class AgainstTheCommand(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def driven(self, name, *sets):
        out = os.path.join(self.folder.name, name)
        words = [word for one in sets for word in ("--set", one)]
        subprocess.run([COMMAND, "point", name, "-o", out, "--no-plot", "--quiet", *words], check=True)
        return out

    def test_columns_are_those_of_curve_csv(self):
        for name in ("weald_clay_undrained", "london_clay_cycles", "glass_beads_constant_volume"):
            out = self.driven(name)
            with open(os.path.join(out, "curve.csv"), newline="", encoding="utf-8") as file:
                rows = list(csv.reader(file))
            test = repose.point(name)
            self.assertEqual(test.columns, rows[0])
            for k, column in enumerate(rows[0]):
                # the file has the digits that read back as the same numbers; -0 is written as 0
                np.testing.assert_array_equal(test[column], [float(r[k]) for r in rows[1:]], column)

    def test_changes_and_laboratory(self):
        out = self.driven("weald_clay_undrained", "initial.ocr=8")
        with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        for changes in ({"initial": {"ocr": 8}}, {"initial.ocr": 8}):
            test = repose.point("weald_clay_undrained", **changes)
            self.assertEqual(test.laboratory, summary["laboratory"])
            mine = test.summary
            for key in summary:
                if key not in ("wall_s", "cpu_s", "repose"):  # the program may be of another commit
                    self.assertEqual(mine[key], summary[key], key)

    def test_a_sweep_is_not_one_test(self):
        with self.assertRaisesRegex(repose.InputError, "repose.sweep drives them"):
            repose.point("clay_rates")

    def test_output_is_the_folder_of_the_command(self):
        out = os.path.join(self.folder.name, "mine")
        test = repose.point("weald_clay_undrained", output=out, plot=False)
        result = repose.Result(out)
        self.assertEqual(result.kind, "point_test")
        np.testing.assert_array_equal(result.curve["q_Pa"], test["q_Pa"])
        self.assertEqual(result.input["law"]["name"], "modified_cam_clay")


class Tests(unittest.TestCase):
    law = repose.Law("neo_hookean", E=1e6, nu=0.25, rho_0=1000.0)
    test = {"initial": {"p": 1e3}, "test": {"kind": "isotropic", "volumetric_strain": 0.01, "points": 4}}

    def test_dictionary_with_a_law(self):
        test = repose.point(self.test, self.law)
        self.assertEqual(test.rows, 5)
        self.assertTrue(test.ok)
        # p = p(0) + K ε_v to second order in the strain: K = 1e6/(3 (1 − 0.5)), ε_v = 0.01
        self.assertAlmostEqual(test["p"][-1] - 1e3, 1e6 / 1.5 * 0.01, delta=0.02 * 1e6 / 1.5 * 0.01)
        self.assertEqual(repose.point(dict(self.test, law=self.law))["p"][-1], test["p"][-1])

    def test_parameters_of_a_prepared_test(self):
        prepared = repose.PointTest("weald_clay_undrained")
        for M in (0.8, 1.0):
            whole = repose.point("weald_clay_undrained", law={"M": M})
            np.testing.assert_array_equal(prepared.run(M=M)["q_Pa"], whole["q_Pa"])
        with self.assertRaisesRegex(repose.InputError, "has no parameter 'MM'"):
            prepared.run(MM=1.0)

    def test_sensitivities_are_derivatives(self):
        prepared = repose.PointTest("weald_clay_undrained")
        slopes = prepared.sensitivities(["M", "lambda"], ["q_Pa", "u_Pa"])
        values = prepared.run().summary["input"]["law"]
        for k, name in enumerate(("M", "lambda")):
            h = 1e-5 * values[name]
            up = prepared.run(**{name: values[name] + h})
            down = prepared.run(**{name: values[name] - h})
            for column in ("q_Pa", "u_Pa"):
                difference = (up[column] - down[column]) / (2 * h)
                # the integrator's tolerance 1e-8 per step, some ten of them, over 2 h/value = 2e-5
                bound = 1e-8 * 30 * up[column].max() / (2 * h) + 1e-6 * np.abs(difference).max()
                np.testing.assert_allclose(slopes[column][:, k], difference, atol=bound)

    def test_mistakes(self):
        for changes, words in (({"initial": {"ocrr": 8}}, "initial.ocrr=8: unknown key 'ocrr'.*did you mean 'ocr'"),
                               ({"initial": {"ocr": 0.5}}, r"initial.ocr.*>= 1|initial.ocr.*\[1")):
            with self.assertRaisesRegex(repose.InputError, words):
                repose.point("weald_clay_undrained", **changes)
        with self.assertRaisesRegex(repose.InputError, "did you mean 'weald_clay_undrained'"):
            repose.point("weald_clay_undrainde")
        with self.assertRaisesRegex(repose.InputError, "point test, initial.x: unknown key 'x'"):
            repose.point({**self.test, "initial": {"p": 1e3, "x": 1}}, self.law)
        with self.assertRaisesRegex(repose.InputError, "None"):
            repose.point({**self.test, "initial": {"p": None}}, self.law)
        with self.assertRaises(OSError):
            repose.point("nowhere/test.toml")
        with self.assertRaises(TypeError):
            repose.point(3)
        with self.assertRaisesRegex(KeyError, "did you mean 'q_Pa'"):
            repose.point("weald_clay_undrained")["q_pa"]

    def test_what_cannot_be_finished(self):
        beyond = {"initial": {"p": 1e5, "ocr": 1.0},
                  "test": {"kind": "triaxial", "control": "stress", "q_end": 1e9, "drainage": "drained"},
                  "law": {"name": "modified_cam_clay", "compression": "v-ln_p", "M": 0.9,
                          "lambda": 0.16, "kappa": 0.06, "nu": 0.3, "Gamma": 2.76}}
        with self.assertRaisesRegex(repose.NumericalFailure, "strength|carry|beyond") as caught:
            repose.point(beyond)
        partial = caught.exception.result
        self.assertFalse(partial.ok)
        self.assertGreater(partial.rows, 1)
        self.assertEqual(repose.point(beyond, strict=False).status, partial.status)

    def test_text_with_quotes_and_newlines_survives(self):
        from repose.inputs import document
        import tomllib
        table = {"a": {"b c": 'say "x"\\\n', "n": [1, 2.5, True, -0.0]}, "e": 1e-300}
        self.assertEqual(tomllib.loads(document(table)), table)


if __name__ == "__main__":
    unittest.main()
