"""A simulation coupled explicitly to a body that pushes back, through a mock of preCICE's calls (docs/coupling.md).

The left edge of a box is a vertical belt that slides along itself, with a block of thick fluid on it. The other solver drives the belt by a
given force: it takes the fluid's drag and gives the belt's speed. preCICE itself is not needed and not used.
"""

import repose


class Mock:
    """The four calls of preCICE that an explicit coupling needs, with the other solver inside: a belt of mass
    per depth `mass` [kg/m] that a force per depth `motor` [N/m] drives up, and the fluid holds back."""

    def __init__(self, mass: float, motor: float, window: float, end: float) -> None:
        self.mass, self.motor, self.window, self.end = mass, motor, window, end
        self.time, self.speed, self.drag = 0.0, 0.0, 0.0
        self.history: list[tuple[float, float, float]] = []

    def is_coupling_ongoing(self) -> bool:
        return self.time < self.end

    def read_data(self) -> float:
        """The belt's speed, m/s."""
        return self.speed

    def write_data(self, drag: float) -> None:
        """The fluid's force on the belt along it, N/m, upwards."""
        self.drag = drag

    def advance(self, dt: float) -> float:
        """The other solver's window; returns the length of the next one."""
        self.speed += dt * (self.motor + self.drag) / self.mass
        self.time += dt
        self.history.append((self.time, self.speed, self.drag))
        return min(self.window, self.end - self.time)


def vertical_momentum(sim: repose.Simulation) -> float:
    """Of all points, kg m/s per metre of depth."""
    points = sim.points
    return float((points.mass * points.velocity[:, 1]).sum())


def run(end: float = 0.05) -> tuple[Mock, repose.Simulation]:
    """Couples a block of fluid without weight to the belt, window by window."""
    oil = repose.Law("newtonian", eta=50.0, K=1e5, rho_0=1000.0)
    sim = repose.Simulation({
        "scene": {"name": "belt", "end_time": end, "gravity": 0.0},
        "domain": {"size": [0.2, 0.2], "floor": "slip", "top": "slip", "left": "no_slip", "right": "slip"},
        "grid": {"h": 0.02},
        "body": [{"origin": [0.0, 0.06], "size": [0.1, 0.08], "law": oil}]})
    other = Mock(mass=20.0, motor=40.0, window=0.002, end=end)
    window = other.window
    while other.is_coupling_ongoing():
        sim.set_wall("left", {"speed": other.read_data()})
        before, began = vertical_momentum(sim), sim.time
        sim.step(until=other.time + window)
        # the belt alone acts on the block: three cells lie between it and floor and top, and a
        # node reaches two
        drag = -(vertical_momentum(sim) - before) / (sim.time - began)
        other.write_data(drag)
        window = other.advance(window)
    return other, sim


if __name__ == "__main__":
    other, sim = run()
    for time, speed, drag in other.history[::5]:
        print(f"{time:.3f} s  belt {speed:.4f} m/s, the fluid's drag {drag:.2f} N/m")
