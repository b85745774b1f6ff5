"""`pip install .` from the tree, offline and with build isolation, into an environment of its own; the
package there, its command, and a C++ program against the headers and libraries of the wheel."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.environ["REPOSE_SOURCE_DIR"]
BUILD = os.path.join(os.environ["REPOSE_BUILD_DIR"], "python_wheel")


class Install(unittest.TestCase):
    def test_from_the_tree(self):
        clean = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
        clean.update(REPOSE_WHEEL_BUILD_DIR=BUILD, PIP_DISABLE_PIP_VERSION_CHECK="1",
                     http_proxy="http://127.0.0.1:9", https_proxy="http://127.0.0.1:9")
        with tempfile.TemporaryDirectory() as folder:
            def run(*command, **more):
                done = subprocess.run(command, cwd=folder, env=clean, text=True, capture_output=True, **more)
                self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
                return done.stdout.strip()
            env = os.path.join(folder, "env")
            run(sys.executable, "-m", "venv", "--system-site-packages", env)
            python = os.path.join(env, "bin", "python")
            run(python, "-m", "pip", "install", "--no-index", ROOT)
            there = run(python, "-c", "import repose; print(repose.__file__)")
            self.assertTrue(there.startswith(env), there)
            said = run(python, "-c", "import repose; print(repose.point('weald_clay_undrained').status)")
            self.assertEqual(said, "completed")
            self.assertTrue(run(os.path.join(env, "bin", "repose"), "--version").startswith("repose "))
            prefix = run(python, "-c", "import repose; print(repose.cmake_dir())")
            with open(os.path.join(folder, "CMakeLists.txt"), "w", encoding="utf-8") as file:
                file.write("cmake_minimum_required(VERSION 3.25)\nproject(drive CXX)\n"
                           "find_package(repose REQUIRED)\nadd_executable(drive drive.cpp)\n"
                           "target_link_libraries(drive PRIVATE repose::pointdriver)\n")
            shutil.copy(os.path.join(ROOT, "examples/drive.cpp"), folder)
            run("cmake", "-S", ".", "-B", "out", f"-Drepose_DIR={prefix}")
            run("cmake", "--build", "out")
            self.assertIn("critical state", run(os.path.join(folder, "out", "drive")))
            run(python, "-m", "pip", "uninstall", "-y", "repose")
            left = [name for name in os.listdir(os.path.dirname(os.path.dirname(there)))
                    if name.startswith("repose")]
            self.assertEqual(left, [])


if __name__ == "__main__":
    unittest.main()
