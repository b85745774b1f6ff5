"""The package as a whole: stubs, documentation, figures, examples."""

import inspect
import os
import subprocess
import sys
import tempfile
import unittest

import repose

ROOT = os.environ["REPOSE_SOURCE_DIR"]


class Package(unittest.TestCase):
    def test_stub_is_what_the_module_has(self):
        subprocess.run([sys.executable, os.path.join(ROOT, "python/tools/make_stub.py"), "--check"], check=True)

    def test_everything_public_is_documented(self):
        for name in repose.__all__:
            thing = getattr(repose, name)
            if name in ("version", "instruction_set"):
                continue
            self.assertTrue(inspect.getdoc(thing), name)
            if inspect.isclass(thing) and thing.__module__.startswith("repose"):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{member}")

    def test_matplotlib_is_not_imported_before_it_is_needed(self):
        subprocess.run([sys.executable, "-c", "import sys, repose; repose.point('weald_clay_undrained');"
                        "assert 'matplotlib' not in sys.modules"], check=True)

    def test_versions_agree(self):
        said = subprocess.run([os.environ["REPOSE_COMMAND"], "--version"], capture_output=True, text=True,
                              check=True).stdout
        self.assertTrue(said.startswith(f"repose {repose.__version__}"), said)

    def test_command_of_the_package(self):
        said = subprocess.run([sys.executable, "-m", "repose", "models", "mui"], capture_output=True, text=True)
        self.assertEqual(said.returncode, 2)
        self.assertIn('did you mean "mu_i"', said.stderr)


class Examples(unittest.TestCase):
    def test_run_and_draw(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, pictures in (("drive", ["drive.png"]), ("fit", ["fit.png"]),
                                   ("collapse", ["collapse.png"])):
                script = os.path.join(ROOT, "python/examples", f"{name}.py")
                done = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True,
                                      env={**os.environ, "REPOSE_SHORT": "1"})
                self.assertEqual(done.returncode, 0, done.stderr)
                for picture in pictures:
                    self.assertGreater(os.path.getsize(os.path.join(folder, picture)), 5000)


if __name__ == "__main__":
    unittest.main()
