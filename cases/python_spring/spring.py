#!/usr/bin/python3 -B
"""A rigid floor on a spring, m y'' + k y = F, as a participant of a run. coupler/python/README.md explains it."""
import numpy as np
import strake


class Spring(strake.Participant):
    def build(self, key):  # key: the table [structure.spring]
        self.m, self.k, depth, n = key["mass"], key["stiffness"], key["thickness"], key["points"]
        x = np.linspace(-key["width"] / 2, key["width"] / 2, n) + key.get("middle", 0)
        self.points = [(a, -depth) for a in x] + [(a, 0) for a in x[::-1]]  # the outline, counter-clockwise
        self.faces = [(i, (i + 1) % (2 * n)) for i in range(2 * n)]  # (a, b) along t: normal (t_y, -t_x), into the fluid
        self.state = np.zeros(2)  # all that changes in time: y [m] and v [m/s]
        self.columns = {"floor.y": "m"}
        self.lines = [f"spring   m {self.m:g} kg/m   k {self.k:g} N/m per metre of depth"]

    def advance(self, t, dt, load):  # the trapezoidal rule, with the mean force over the window
        (y, v), a, force = self.state, self.k * dt**2 / (4 * self.m), load["force"][:, 1].sum()
        end = ((1 - a) * v + dt * (force - self.k * y) / self.m) / (1 + a)
        self.state = np.array((y + dt * (v + end) / 2, end))
        self.monitor["floor.y"] = self.state[0]
        return 0, self.state[0]  # the displacement of every point [m]


Spring.main()
