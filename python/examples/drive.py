"""One material point along a path: undrained triaxial compression of Weald clay, normally
consolidated and overconsolidated, and how its strength depends on the parameters of the law."""

import repose

prepared = repose.PointTest("weald_clay_undrained")
for ocr in (1, 2, 8):
    test = repose.point("weald_clay_undrained", initial={"ocr": ocr})
    print(f"OCR {ocr}: S_u = {test.laboratory['S_u_Pa'] / 1e3:.1f} kPa at eps_a = "
          f"{100 * test.laboratory['S_u_strain']:.1f} %, {test.reason}")
    for note in test.notes:
        print("  note:", note)

# The derivative of the last row with respect to parameters of the law, exact.
slopes = prepared.sensitivities(["M", "lambda", "kappa"], ["q_Pa"])["q_Pa"][-1]
print("dq/dM, dq/dlambda, dq/dkappa at the end:", ", ".join(f"{s / 1e3:.1f} kPa" for s in slopes))

# The law alone, on arrays: 1000 points sheared by different amounts in one call.
clay = repose.Law(prepared.run().summary["input"]["law"])
stress, state, density = clay.points(1000, 6, p=207e3, ocr=1.0)
strain = repose.batch_array(1000, 6)
strain[:, 3] = [1e-5 * i for i in range(1000)]
stress, state, density = clay.update(stress, state, density, strain, dt=1.0)
print(f"the most strained carries tau = {stress[-1, 3] / 1e3:.1f} kPa")

test.plot().savefig("drive.png", dpi=110)
