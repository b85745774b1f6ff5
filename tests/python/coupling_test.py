"""The sketch of an explicit coupling (docs/coupling.md) with the mock of its other side."""

import importlib.util
import os
import tempfile
import unittest

import numpy as np

import repose

ROOT = os.environ["REPOSE_SOURCE_DIR"]


def example():
    spec = importlib.util.spec_from_file_location("coupling", os.path.join(ROOT, "python/examples/coupling.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Coupling(unittest.TestCase):
    def test_what_the_motor_gives_is_shared_by_belt_and_fluid(self):
        other, sim = example().run()
        self.assertAlmostEqual(sim.time, other.end, delta=1e-12 * other.end)
        windows = len(other.history)
        self.assertEqual(windows, 25)
        points = sim.points
        momenta = points.mass * points.velocity[:, 1]
        given = other.motor * other.time
        # The force is the change of the momentum over the window by construction, whatever the
        # error of either solver; each window adds two sums over the points and some ten roundings
        # of numbers no larger than what was given or moves.
        size = max(given, np.abs(momenta).sum())
        bound = windows * (2 * len(points) + 10) * 2.0**-53 * size
        # time of a window is a difference of times: eps of the time over the window's length
        bound += windows * 2.0**-52 * other.end / other.window * size
        self.assertAlmostEqual(other.mass * other.speed + momenta.sum(), given, delta=bound)
        # the fluid is dragged along and holds the belt back
        self.assertGreater(momenta.sum(), 0.01 * given)
        self.assertLess(other.speed, other.motor * other.time / other.mass)

    def test_a_window_repeated_from_its_checkpoint_is_the_same(self):
        _, sim = example().run(end=0.01)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "window.h5")
            sim.save(file)
            velocities = []
            for _ in range(2):
                sim = repose.Simulation.load(file)
                sim.set_wall("left", {"speed": 0.1})
                sim.step(until=0.012)
                velocities.append(sim.points.velocity)
        np.testing.assert_array_equal(*velocities)


if __name__ == "__main__":
    unittest.main()
