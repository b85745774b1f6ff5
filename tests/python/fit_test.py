"""Fits and validation from Python."""

import os
import tempfile
import unittest

import numpy as np

import repose

ROOT = os.environ["REPOSE_SOURCE_DIR"]
KAOLIN = os.path.join(ROOT, "data/experiments/fit_kaolin.toml")


class Fits(unittest.TestCase):
    def test_finds_the_parameters_that_made_the_data(self):
        truth = {"M": 0.95, "lambda": 0.093}
        law = {"name": "modified_cam_clay", "compression": "v-ln_p", "kappa": 0.035, "nu": 0.3,
               "Gamma": 2.06}
        test = {"kind": "triaxial", "drainage": "drained", "axial_strain": 0.2, "points": 20}
        initial = {"p": 2e5, "ocr": 1.0}
        made = repose.point({"law": {**law, **truth}, "initial": initial, "test": test})
        noise = 1e3 * np.random.default_rng(1).standard_normal(made.rows)
        with tempfile.TemporaryDirectory() as folder:
            data = os.path.join(folder, "twin.csv")
            with open(data, "w", encoding="utf-8") as file:
                file.write("eps_a,q_Pa\n")
                for e, q in zip(made["eps_a"][1:], (made["q_Pa"] + noise)[1:]):
                    file.write(f"{float(e)!r},{float(q)!r}\n")
            heard = []
            fit = repose.fit({"law": law,
                              "fit": {"M": {"lower": 0.5, "upper": 1.5},
                                      "lambda": {"lower": 0.05, "upper": 0.4}},
                              "target": [{"name": "twin", "data": data, "x": "eps_a", "y": "q_Pa",
                                          "noise": {"q_Pa": 1e3}, "initial": initial,
                                          "test": {"kind": "triaxial", "drainage": "drained"}}],
                              "solver": {"starts": 3}},
                             progress=lambda start, starts, objective: heard.append((start, starts)))
        self.assertEqual(sorted(heard), [(0, 3), (1, 3), (2, 3)])
        self.assertEqual(fit.status, "done")
        for name, value in truth.items():
            # four standard errors of an unbiased fit: missed once in 16 000 draws; the draw is fixed
            self.assertLess(abs(fit.parameters[name] - value), 4 * fit.standard_errors[name], name)
            self.assertLess(fit.intervals[name][0], fit.parameters[name])
        self.assertEqual(fit.correlation.shape, (2, 2))
        self.assertEqual(fit.law.parameters["M"], fit.parameters["M"])
        self.assertEqual(fit.predictions.rows, 20)
        self.assertIn("objective", str(fit))

    def test_folder_has_what_memory_has(self):
        here = repose.fit(KAOLIN, solver={"starts": 1})
        with tempfile.TemporaryDirectory() as folder:
            there = repose.fit(KAOLIN, output=folder, quiet=True, plot=False, solver={"starts": 1})
            self.assertEqual(there.parameters, here.parameters)
            self.assertEqual(there.intervals, here.intervals)
            for name in here.predictions.names:
                np.testing.assert_array_equal(here.predictions[name], there.predictions[name])

    def test_progress_that_raises_ends_the_fit(self):
        def stop(*_):
            raise ZeroDivisionError("enough")
        with self.assertRaisesRegex(ZeroDivisionError, "enough"):
            repose.fit(KAOLIN, progress=stop, solver={"starts": 4})

    def test_mistakes(self):
        with self.assertRaisesRegex(repose.InputError, "startss.*did you mean 'starts'"):
            repose.fit(KAOLIN, solver={"startss": 4})
        with self.assertRaisesRegex(repose.InputError, r"\[fit\]"):
            repose.fit({"law": {"name": "mu_i"}})


class Verbs(unittest.TestCase):
    def test_validate(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(repose.InputError, "there is no case 'no_such_case'"):
                repose.validate("no_such_case", output=folder, quiet=True)
            result = repose.validate("mcc_undrained", laws=["mcc"], output=folder, quiet=True,
                                     plot=False)
            self.assertEqual(result.status, "done")
            self.assertEqual([case["name"] for case in result.summary["cases"]], ["mcc_undrained"])
            table = repose.Columns.read(os.path.join(folder, "mcc_undrained", "result.csv"))
            self.assertIn("inside", list(table["verdict"]))

    def test_command_line_mistakes_are_input_errors(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(repose.InputError, "there is no chart 'piont'.*did you mean 'point'"):
                repose.chart("piont", output=folder)


if __name__ == "__main__":
    unittest.main()
