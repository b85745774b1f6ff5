"""A fit: friction and compressibility of a clay from a drained triaxial test. The measured values
are made here, by the law itself and noise of 1 kPa, so that the answer is known."""

import os
import tempfile

import numpy as np

import repose

truth = {"M": 0.95, "lambda": 0.093}
clay = {"name": "modified_cam_clay", "compression": "v-ln_p", "kappa": 0.035, "nu": 0.3, "Gamma": 2.06}
drained = {"kind": "triaxial", "drainage": "drained", "axial_strain": 0.2}
initial = {"p": 200e3, "ocr": 1.0}

made = repose.point({"law": {**clay, **truth}, "initial": initial, "test": {**drained, "points": 40}})
measured = made["q_Pa"][1:] + 1e3 * np.random.default_rng(1).standard_normal(40)
data = os.path.join(tempfile.mkdtemp(), "drained.csv")
np.savetxt(data, np.column_stack([made["eps_a"][1:], measured]), delimiter=",", header="eps_a,q_Pa",
           comments="")

fit = repose.fit(
    {"law": clay,
     "fit": {"M": {"lower": 0.5, "upper": 1.5}, "lambda": {"lower": 0.05, "upper": 0.4, "scale": "log"}},
     "target": [{"name": "drained", "data": data, "x": "eps_a", "y": "q_Pa", "noise": {"q_Pa": 1e3},
                 "initial": initial, "test": drained}],
     "solver": {"starts": 2 if "REPOSE_SHORT" in os.environ else 8}},
    progress=lambda start, starts, objective: print(f"start {start + 1} of {starts}: {objective:.4g}"))
print(fit)
for name, value in truth.items():
    print(f"{name}: {fit.parameters[name]:.4f} +- {fit.standard_errors[name]:.4f}, made with {value}")
fit.plot().savefig("fit.png", dpi=110)
