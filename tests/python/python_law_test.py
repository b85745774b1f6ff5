"""Laws written in Python: against exact results, in points, scenes and fits, and when they fail."""

import os
import tempfile
import traceback
import unittest

import numpy as np

import repose

K, G = 1e6, 6e5


class Elastic(repose.PythonLaw):
    name = "python_elastic"
    doc = "isotropic, hypoelastic"
    parameters = {"K": repose.Parameter("bulk modulus", "Pa", lower=0),
                  "G": repose.Parameter("shear modulus", "Pa", lower=0),
                  "rho_0": repose.Parameter("density", "kg/m3", default=1500.0, lower=0)}
    state = {"volume": "volume strain so far [-]"}

    def update(self, P, stress, state, density, strain, dt):
        volume = strain[:, :3].sum(axis=1, keepdims=True)
        new = stress + 2 * P.G * strain
        new[:, :3] += (P.K - 2 * P.G / 3) * volume
        return new, state + volume

    def modulus(self, P, stress, state, density):
        return P.K + 4 * P.G / 3

    def complete(self, P):
        if P.G > P.K:
            raise repose.InputError("G must be at most K here")


repose.register_law(Elastic)
LAW = {"name": "python_elastic", "K": K, "G": G}
SCENE = {"scene": {"name": "drop", "end_time": 0.02}, "domain": {"size": [0.2, 0.2]},
         "grid": {"h": 0.02}, "body": [{"origin": [0.0, 0.0], "size": [0.1, 0.1], "law": LAW}]}


class Points(unittest.TestCase):
    def test_is_listed_and_updates(self):
        law = repose.Law(LAW)
        self.assertIn("python_elastic", [info.name for info in repose.laws()])
        self.assertEqual(law.state, ["volume"])
        arrays = law.points(5, 6, p=1e3)
        strain = np.full((5, 6), 1e-3)
        stress, state, density = law.update(*arrays, strain, 1.0)
        # one step of the formula above: a handful of roundings
        np.testing.assert_allclose(stress[:, 0], -1e3 + 3e-3 * K, rtol=1e-14)
        np.testing.assert_allclose(stress[:, 3], 2e-3 * G, rtol=1e-14)
        np.testing.assert_allclose(state[:, 0], 3e-3, rtol=1e-15)
        # a linear update: differences over 2e-7 of stresses of 3e3 Pa err by eps σ/δ = 3e-6 Pa
        C = law.tangent(*arrays, strain, 1.0)[0]
        np.testing.assert_allclose(C[0, :3], [K + 4 * G / 3, K - 2 * G / 3, K - 2 * G / 3], rtol=1e-9)
        self.assertAlmostEqual(C[3, 3], 2 * G, delta=1e-9 * G)

    def test_drained_triaxial_test(self):
        test = {"law": LAW, "initial": {"p": 1e4},
                "test": {"kind": "triaxial", "drainage": "drained", "axial_strain": 0.01, "points": 10}}
        curve = repose.point(test)
        E, nu = 9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G))
        # exact whatever the step: the control is met to 1e-12 of the stress
        np.testing.assert_allclose(curve["q_Pa"], E * curve["eps_a"], atol=1e-11 * 1e4)
        np.testing.assert_allclose(curve["eps_v"], (1 - 2 * nu) * curve["eps_a"], atol=1e-13)
        slopes = repose.PointTest(test).sensitivities(["K", "G"], ["q_Pa"])["q_Pa"][-1]
        exact = 0.01 * np.array([9 * G * G, 27 * K * K]) / (3 * K + G) ** 2
        # differences over 1e-5: their square, and 1e-12 of 2e4 Pa over 2e-5 of a parameter
        np.testing.assert_allclose(slopes, exact, rtol=1e-7)

    def test_is_fitted_side_by_side(self):
        E = 9 * K * G / (3 * K + G)
        with tempfile.TemporaryDirectory() as folder:
            data = os.path.join(folder, "drained.csv")
            with open(data, "w", encoding="utf-8") as file:
                file.write("eps_a,q_Pa\n" + "".join(f"{e},{E * e}\n" for e in (0.002, 0.004, 0.006)))
            fit = repose.fit({"law": {"name": "python_elastic", "K": K},
                              "fit": {"G": {"lower": 1e5, "upper": 9e5}},
                              "target": [{"name": "drained", "data": data, "x": "eps_a", "y": "q_Pa",
                                          "noise": {"q_Pa": 10.0}, "initial": {"p": 1e4},
                                          "test": {"kind": "triaxial", "drainage": "drained"}}],
                              "solver": {"starts": 3}}, progress=lambda *_: None)
        # data without noise, met to the square of the search's last step
        self.assertAlmostEqual(fit.parameters["G"] / G, 1.0, delta=1e-6)

    def test_mistakes(self):
        with self.assertRaisesRegex(repose.InputError, "at most K"):
            repose.Law({**LAW, "G": 2 * K})
        with self.assertRaisesRegex(repose.InputError, "> 0 Pa"):
            repose.Law({**LAW, "K": -1.0})
        with self.assertRaisesRegex(repose.InputError, "registered already"):
            repose.register_law(Elastic)


class Scenes(unittest.TestCase):
    def test_falls_freely_and_rests_alike_on_any_number_of_threads(self):
        falling = {**SCENE, "domain": {"size": [0.4, 0.4]},
                   "body": [{"origin": [0.16, 0.16], "size": [0.08, 0.08], "law": LAW}]}
        sim = repose.Simulation(falling)
        sim.run()
        # m g t with a mass of 1500 × 0.08² kg/m, to round-off of some ten steps
        self.assertAlmostEqual(sim.diagnostics()["momentum_y"] / (-9.6 * 9.8 * 0.02), 1.0, delta=1e-12)
        sim, one = repose.Simulation(SCENE), repose.Simulation(SCENE, threads=1)
        for each in (sim, one):
            each.run()
        self.assertGreater(sim.points.pressure.max(), 0.0)
        np.testing.assert_array_equal(one.points.stress, sim.points.stress)

    def failing(self, name, update):
        class Failing(Elastic):
            pass
        Failing.name = name
        Failing.update = update
        repose.register_law(Failing)
        return {**SCENE, "body": [{**SCENE["body"][0], "law": {**LAW, "name": name}}]}

    def test_exception_ends_the_run_with_its_traceback(self):
        def update(self, P, stress, state, density, strain, dt):
            raise LookupError("deliberate")
        sim = repose.Simulation(self.failing("python_raising", update))
        try:  # assertRaises would take the traceback away
            sim.run()
            self.fail("nothing was raised")
        except LookupError as error:
            self.assertIn('raise LookupError("deliberate")', "".join(traceback.format_exception(error)))
        with self.assertRaisesRegex(RuntimeError, "cannot go on"):
            sim.step()

    def test_wrong_shape_and_nan(self):
        scene = self.failing("python_shape", lambda self, P, s, v, r, e, dt: (s[:1], v))
        with self.assertRaisesRegex(ValueError, "python_shape.update must return an array of the shape"):
            repose.Simulation(scene).run()
        scene = self.failing("python_nan", lambda self, P, s, v, r, e, dt: (s * np.nan, v))
        with self.assertRaises(repose.NumericalFailure):
            repose.Simulation(scene).run()

    def test_a_modulus_that_makes_no_step_is_refused(self):
        for k, wrong in enumerate((np.inf, np.nan, 0.0, -1.0)):
            class Stepless(Elastic):
                name = f"python_stepless_{k}"

                def modulus(self, P, stress, state, density):
                    return wrong
            repose.register_law(Stepless)
            scene = {**SCENE, "body": [{**SCENE["body"][0], "law": {**LAW, "name": Stepless.name}}]}
            with self.assertRaisesRegex(repose.InputError, "modulus must return finite numbers > 0"):
                repose.Simulation(scene).step(until=0.01)

    def test_more_than_four_state_variables_at_a_point(self):
        class Many(Elastic):
            name = "python_many"
            state = {**{f"s{i}": "volume strain so far [-]" for i in range(8)}, "p_c": "likewise [-]"}
        repose.register_law(Many)
        test = {"law": {**LAW, "name": "python_many"}, "initial": {"p": 1e4},
                "test": {"kind": "triaxial", "drainage": "drained", "axial_strain": 0.01, "points": 10}}
        curve = repose.point(test)
        self.assertEqual(curve.state.shape[1], 4)  # the first four of nine
        self.assertNotIn("p_c_Pa", curve.columns)  # which is the ninth
        # each adds up what the test reports, of the other sign
        for i in range(4):
            np.testing.assert_allclose(curve.state[:, i], -curve["eps_v"], atol=1e-13)

    def test_what_makes_no_law(self):
        def update(answer):
            return lambda self, P, s, v, r, e, dt: answer(s, v)
        for name, answer, told in (("complex", lambda s, v: (s + 0j, v), "real numbers"),
                                   ("bare", lambda s, v: s, "the law has state"),
                                   ("three", lambda s, v: (s, v, 3), "3 things")):
            with self.assertRaisesRegex(ValueError, told):
                repose.Simulation(self.failing(f"python_{name}", update(answer))).run()
        for key, p in (("K", repose.Parameter("", lower=2, upper=1)), ("name", repose.Parameter("")),
                       ("K", repose.Parameter("", default=-1.0, lower=0)), ("a b", repose.Parameter("")),
                       ("K", repose.Parameter("", default=float("nan")))):
            class Bad(Elastic):
                name = "python_bad"
                parameters = {key: p}
            with self.assertRaises(repose.InputError):
                repose.register_law(Bad)

    def test_averaging_is_refused(self):
        with self.assertRaisesRegex(repose.InputError, "pressure_averaging"):
            repose.Simulation(SCENE, step={"pressure_averaging": 50.0}).step()


if __name__ == "__main__":
    unittest.main()
