"""A column of grains collapses; its box is tilted on the way, and its points looked at."""

import os

import numpy as np

import repose

short = "REPOSE_SHORT" in os.environ
sim = repose.Simulation("flat_mu_i", grid={"h": 0.025 if short else 0.0125})
print(sim)

end = 0.3 if short else sim.end_time
for t in np.linspace(0.0, end, 7)[1:]:
    sim.step(until=t)
    now = sim.diagnostics()
    fastest = np.linalg.norm(sim.points.velocity, axis=1).max()
    print(f"t = {sim.time:.2f} s: front {now['front_99_m']:.3f} m, fastest point {fastest:.2f} m/s")

sim.save("heap.h5")  # with heap.h5.toml; repose.Simulation.load("heap.h5") goes on from here

sim.tilt_deg = 25.0
sim.step(until=end + 0.3)
print(f"tilted by 25 degrees: front {sim.diagnostics()['front_99_m']:.3f} m")
sim.plot(colour="pressure").savefig("collapse.png", dpi=110)
