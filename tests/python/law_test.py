"""Laws from Python: tables, updates of numpy arrays, tangents, errors."""

import unittest

import numpy as np

import repose

GRAINS = dict(mu_0=0.3819, mu_d=0.5718, I_0=0.279, d=0.0053, rho_p=2000.0, rho_0=1300.0, K=254800.0)
CLAY = dict(compression="v-ln_p", M=0.888, nu=0.3, Gamma=2.759, kappa=0.062, **{"lambda": 0.161})


def random_steps(points, components, size, seed=1):
    return size * np.random.default_rng(seed).uniform(-1.0, 1.0, (points, components))


class Tables(unittest.TestCase):
    def test_every_law_tells_its_parameters(self):
        for info in repose.laws():
            self.assertTrue(info.doc)
            for parameter in info.parameters.values():
                self.assertTrue(parameter["doc"] and parameter["unit"] and parameter["range"])
        self.assertEqual([i.option for i in repose.laws("mu_i")],
                         ["elastoviscoplastic", "regularised", "barker_gray"])

    def test_table_makes_the_law_again(self):
        law = repose.Law("modified_cam_clay", **CLAY)
        again = repose.Law(law.as_table())
        self.assertEqual(law.parameters, again.parameters)
        self.assertEqual(law.as_table(), again.as_table())
        self.assertEqual(eval(repr(repose.Law("mu_i", **GRAINS)), {"Law": repose.Law}).parameters,
                         repose.Law("mu_i", **GRAINS).parameters)

    def test_angle_stands_for_friction(self):
        # q/p = 6 sin φ/(3 − sin φ) in triaxial compression; mu_0 = that over √3
        sine = np.sin(np.radians(20.0))
        grains = {k: v for k, v in GRAINS.items() if k != "mu_0"}
        law = repose.Law("mu_i", phi_0=20.0, **grains)
        self.assertAlmostEqual(law.parameters["mu_0"], 6 * sine / (3 - sine) / np.sqrt(3), 14)

    def test_mistakes_are_told_with_the_nearest_name(self):
        with self.assertRaisesRegex(repose.InputError, r"did you mean 'mu_0'\?") as caught:
            repose.Law("mu_i", mu0=0.38)
        self.assertIn("needs K", "\n".join(caught.exception.problems))
        self.assertIsInstance(caught.exception, ValueError)
        with self.assertRaisesRegex(repose.InputError, 'did you mean "mu_i"'):
            repose.Law("mui")
        with self.assertRaisesRegex(repose.InputError, "> 0 Pa"):
            repose.Law("mu_i", **{**GRAINS, "K": -1.0})
        with self.assertRaisesRegex(repose.InputError, "leave ocr out"):
            repose.Law("mu_i", **GRAINS).initial(ocr=2)


class Updates(unittest.TestCase):
    def setUp(self):
        self.law = repose.Law("modified_cam_clay", **CLAY)

    def test_arrays_that_are_copied_give_the_same_bits_in_every_method(self):
        for points in (5, 16, 37, 1000):
            stress, state, density = self.law.points(points, 6, p=1e5, ocr=1.5)
            stress[:, :3] -= np.linspace(0.0, 1e4, points)[:, np.newaxis]
            strain = random_steps(points, 6, 1e-3)
            copied = (np.ascontiguousarray(stress), np.ascontiguousarray(state), density.copy())
            lists = tuple(a.tolist() for a in copied)
            for given in (copied, lists):
                for method in ("modulus", "wave_speed", "stored_energy"):
                    np.testing.assert_array_equal(getattr(self.law, method)(*given),
                                                  getattr(self.law, method)(stress, state, density))
                np.testing.assert_array_equal(self.law.tangent(*given, strain, 1e-3),
                                              self.law.tangent(stress, state, density, strain, 1e-3))

    def test_memory_that_numbers_do_not_fit_into_is_not_written(self):
        stress, state, density = self.law.points(16, 6, p=1e5, ocr=1.5)
        odd = np.ndarray((16, 6), float, buffer=np.zeros((16 * 8 + 4) * 6, np.uint8), strides=(8, 16 * 8 + 4))
        odd[:] = stress
        with self.assertRaisesRegex(repose.InputError, "cannot be updated in place"):
            self.law.update(odd, state, density, np.zeros((16, 6)), 1e-3, in_place=True)

    def test_memory_layout_changes_no_bit(self):
        for components in (4, 6):
            stress, state, density = self.law.points(37, components, p=1e5, ocr=1.5)
            strain = random_steps(37, components, 1e-3)
            spin = random_steps(37, 3, 1e-3)
            spin = spin[:, 0] if components == 4 else spin
            want = self.law.update(stress, state, density, strain, 1.0, spin)
            rows = [np.ascontiguousarray(a) for a in (stress, state, density, strain, spin)]
            for a, b in zip(want, self.law.update(*rows[:4], 1.0, rows[4])):
                np.testing.assert_array_equal(a, b)
            many = np.arange(64) % 37
            columns = [np.asfortranarray(a[many]) for a in rows]
            for a, b in zip(want, self.law.update(*columns[:4], 1.0, columns[4])):
                np.testing.assert_array_equal(a[many], b)
            lists = [a.tolist() for a in rows]
            for a, b in zip(want, self.law.update(*lists[:4], 1.0, lists[4])):
                np.testing.assert_array_equal(a, b)

    def test_inputs_stay_as_they_are_unless_in_place(self):
        arrays = self.law.points(20, 6, p=1e5)
        before = [a.copy() for a in arrays]
        strain = random_steps(20, 6, 1e-3)
        after = self.law.update(*arrays, strain, 1.0)
        for a, b in zip(arrays, before):
            np.testing.assert_array_equal(a, b)
        same = self.law.update(*arrays, strain, 1.0, in_place=True)
        for a, b, c in zip(arrays, same, after):
            self.assertIs(a, b)
            np.testing.assert_array_equal(a, c)
        # ρ after a step is ρ exp(−tr Δε), to a few eps of exp
        np.testing.assert_allclose(arrays[2], before[2] * np.exp(-strain[:, :3].sum(axis=1)),
                                   rtol=1e-15 * 8)

    def test_in_place_refuses_memory_of_another_order(self):
        stress, state, density = self.law.points(20, 6, p=1e5)
        with self.assertRaisesRegex(repose.InputError, 'order "F"'):
            self.law.update(np.ascontiguousarray(stress), state, density, np.zeros((20, 6)), 1.0,
                            in_place=True)
        with self.assertRaisesRegex(repose.InputError, "in place"):
            self.law.update(stress[:10], state[:10], density[:10], np.zeros((10, 6)), 1.0,
                            in_place=True)

    def test_wrong_shapes_are_told(self):
        stress, state, density = self.law.points(20, 6, p=1e5)
        with self.assertRaisesRegex(repose.InputError, r"strain must have the shape \(20, 6\); it has \(3, 6\)"):
            self.law.update(stress, state, density, np.zeros((3, 6)), 1.0)
        with self.assertRaisesRegex(repose.InputError, r"\(points, 4\)"):
            self.law.update(stress[:, :5], state, density, np.zeros((20, 5)), 1.0)
        with self.assertRaisesRegex(repose.InputError, "dt = -1"):
            self.law.update(stress, state, density, np.zeros((20, 6)), -1.0)
        with self.assertRaisesRegex(repose.InputError, "no array of real numbers"):
            self.law.update(stress, state, density, "strain", 1.0)

    def test_no_number_is_a_failure_that_names_the_point(self):
        stress, state, density = self.law.points(20, 6, p=1e5)
        strain = np.zeros((20, 6))
        strain[7, 2] = np.nan
        with self.assertRaisesRegex(repose.NumericalFailure, "point 7 "):
            self.law.update(stress, state, density, strain, 1.0)

    def test_no_points(self):
        stress, state, density = self.law.points(0, 6, p=1e5)
        after = self.law.update(stress, state, density, np.zeros((0, 6)), 1.0)
        self.assertEqual([a.shape for a in after], [(0, 6), state.shape, (0,)])

    def test_wave_speed(self):
        # of the elastic law: √((K + 4G/3)/ρ), E = 1 MPa, ν = 0.3
        law = repose.Law("neo_hookean", E=1e6, nu=0.3, rho_0=1000.0)
        E, nu = 1e6, 0.3
        M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
        # the modulus of the strained state at rest differs by p/K < 1e-9
        arrays = law.points(5, 6, p=1e-4)
        np.testing.assert_allclose(law.wave_speed(*arrays), np.sqrt(M / arrays[2]), rtol=1e-8)


class Tangents(unittest.TestCase):
    def test_is_the_derivative_of_the_update(self):
        for law, p, size, dt in ((repose.Law("modified_cam_clay", **CLAY), 1e5, 5e-3, 1.0),
                                 (repose.Law("mu_i", **GRAINS), 1e3, 1e-3, 1e-3),
                                 (repose.Law("neo_hookean", E=1e6, nu=0.3, rho_0=1e3), 1e3, 1e-2, 1.0)):
            for components in (4, 6):
                arrays = law.points(8, components, p=p)
                strain = random_steps(8, components, size)
                spin = random_steps(8, 3, 1e-2)
                spin = spin[:, 0] if components == 4 else spin
                exact = law.tangent(*arrays, strain, dt, spin)
                h = 1e-5 * size
                for b in range(components):
                    step = np.zeros_like(strain)
                    step[:, b] = h
                    up = law.update(*arrays, strain + step, dt, spin)[0]
                    down = law.update(*arrays, strain - step, dt, spin)[0]
                    # (h/size)² of a third derivative of some times the first over size², and σ/h
                    # of the update's own error: a return stops some hundred eps short
                    bound = 1e-9 * np.abs(exact).max() + 1000 * 2.2e-16 * np.abs(up).max() / h
                    np.testing.assert_allclose(exact[:, :, b], (up - down) / (2 * h), atol=bound)


if __name__ == "__main__":
    unittest.main()
