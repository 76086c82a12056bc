"""Force on a cone and on a sphere that enter water at constant speed, by the theory of Wagner with the body's true shape.

usage: round_entry.py [--panels 40] [--steps 16]    (two minutes; twice as many change the forces by 0.2 %)
Potential flow without weight. The condition of the body is met on its true shape, and phi = 0 on the level plane through the contact line, as in Zhao
and Faltinsen 1993, J. Fluid Mech. 246:593 (in the plane; recalled). In the mirror of that plane the flow is that of a closed body, twice the wetted part: rings of
sources. With c the radius of the contact line, h the height of the body over its lowest point, and w the water's rise at the radius r for V = 1,
  h(c) = integral from 0 to c of (1 + w(c; c')) V dt/dc' dc'
gives the time at which the contact line is at c. The pressure is that of Bernoulli, p = -rho (phi_t + u^2/2), and counts where it is positive.
Checked with the half sphere, whose added mass is pi/3 rho R^3, and with the disc, 4/3 rho c^3."""
import argparse

import numpy as np

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)
SPHERE = dict(radius=0.2, speed=5.0, density=1000.0, largest=0.11)  # cases/sphere_entry_3d.toml; m, m/s, kg/m^3, m


def elliptic(m):
    """K(m) and E(m), by the arithmetic-geometric mean."""
    a, b, c = np.ones_like(m), np.sqrt(1 - m), np.sqrt(m)
    total, factor = 0.5 * c * c, 0.5
    for _ in range(12):
        a, b, c = (a + b) / 2, np.sqrt(a * b), (a - b) / 2
        factor *= 2
        total = total + factor * c * c
    k = np.pi / (2 * a)
    return k, k * (1 - total)


def ring(r, z, at_r, at_z):
    """phi, u_r and u_z at (r, z) of a ring of sources -1/(4 pi distance) of unit strength."""
    dz = z - at_z
    far, near = (r + at_r) ** 2 + dz**2, (r - at_r) ** 2 + dz**2
    k, e = elliptic(np.minimum(4 * r * at_r / far, 1 - 1e-15))
    root, r = np.sqrt(far), np.maximum(r, 1e-12)
    return np.array([-at_r * k / (np.pi * root),
                     -at_r / (2 * np.pi) / (r * root) * ((at_r**2 - r**2 + dz**2) / near * e - k),
                     at_r / np.pi * dz * e / (root * near)])


def of_panel(r, z, ends, parts):
    """The same of a panel and its image in the plane z = 0, which has the opposite sign. parts: its parts, as fractions."""
    total = np.zeros((3,) + np.shape(r))
    for a, b in zip(parts[:-1], parts[1:]):
        for x, weight in zip(POINTS, WEIGHTS):
            q = ends[0] + (ends[1] - ends[0]) * ((a + b) / 2 + (b - a) / 2 * x)
            length = (b - a) / 2 * np.hypot(*(ends[1] - ends[0]))
            total += weight * length * (ring(r, z, q[0], q[1]) - ring(r, z, q[0], -q[1]))
    return total


class Flow:
    """The flow about a body that sinks with V = 1 and is wet up to the radius c."""

    ONCE, NEAR = np.array([0, 1.0]), np.linspace(0, 1, 8)
    OWN = np.concatenate([[0], 0.5 - 0.5**np.arange(2, 15), [0.5], 0.5 + 0.5**np.arange(14, 1, -1), [1]])

    def __init__(self, height, c, panels, grading=3):
        r = c * (1 - (1 - np.linspace(0, 1, panels + 1)) ** grading)  # finest at the contact line
        self.nodes, self.c = np.stack([r, height(r) - height(c)], 1), c
        self.middle, step = (self.nodes[:-1] + self.nodes[1:]) / 2, np.diff(self.nodes, axis=0)
        self.length = np.hypot(step[:, 0], step[:, 1])
        self.along = step / self.length[:, None]
        self.normal = np.stack([self.along[:, 1], -self.along[:, 0]], 1)  # into the water
        x = self.middle
        fields = np.zeros((3, panels, panels))
        for j in range(panels):
            off = np.abs(np.arange(panels) - j)
            for mask, parts in ((off > 3, self.ONCE), ((off > 0) & (off < 4), self.NEAR), (off == 0, self.OWN)):
                fields[:, mask, j] = of_panel(x[mask, 0], x[mask, 1], self.nodes[j:j + 2], parts)
        n, t = self.normal, self.along
        flux = fields[1] * n[:, :1] + fields[2] * n[:, 1:] + 0.5 * np.eye(panels)
        self.source = np.linalg.solve(flux, -n[:, 1])
        self.phi = fields[0] @ self.source
        self.slip = (fields[1] * t[:, :1] + fields[2] * t[:, 1:]) @ self.source  # dphi/ds
        self.u = self.slip[:, None] * t - n[:, 1:] * n
        self.area = 2 * np.pi * x[:, 0] * self.length
        self.added_mass = (self.phi * n[:, 1] * self.area).sum()

    def rise(self, r):
        """w on the level plane, r > c."""
        return sum(s * of_panel(r, 0 * r, self.nodes[j:j + 2], np.linspace(0, 1, 4))[2] for j, s in enumerate(self.source))

    def force(self, pressure):
        return (np.maximum(pressure, 0) * -self.normal[:, 1] * self.area).sum()


def graded(function):
    """Integral of function over 0 … 1, singular at 0."""
    ends = np.concatenate([[0], 2.0 ** np.arange(-12, 1)])
    return sum((function((a + b) / 2 + (b - a) / 2 * POINTS) * WEIGHTS).sum() * (b - a) / 2 for a, b in zip(ends[:-1], ends[1:]))


def cone(deadrise, panels):
    """F/(rho V^4 t^2), and c/(V t). The flow is that of one instant, scaled with c = k V t."""
    slope = np.tan(np.radians(deadrise))
    flow = Flow(lambda r: slope * r, 1.0, panels)
    k = (1 + graded(lambda v: flow.rise(1 / (1 - v)))) / slope  # the integral of w/s^2 from s = c/c' = 1 on
    phi_t = k * (flow.phi - (flow.middle * flow.u).sum(1)) - (k * slope - 1) * flow.u[:, 1]
    return flow.force(-phi_t - (flow.u**2).sum(1) / 2) * k * k, k


def sphere(panels, steps, radius, speed, density, largest):
    """Time [s] and force [N] while the contact line goes to the radius `largest`."""
    height = lambda r: radius - np.sqrt(np.maximum(radius**2 - r**2, 0))
    c = np.linspace(0, largest, steps + 1)
    middle, width = (c[1:] + c[:-1]) / 2, c[1]
    flows = [Flow(height, m, panels) for m in middle]
    pace = np.zeros(steps)  # V dt/dc
    for k in range(steps):
        known = 0
        for m in range(k):
            at = c[m] + width * (1 + POINTS) / 2
            known += pace[m] * ((1 + flows[m].rise(middle[m] * c[k + 1] / at)) * WEIGHTS).sum() * width / 2
        own = graded(lambda y: 1 + flows[k].rise(middle[k] * c[k + 1] / (c[k + 1] - width * y))) * width
        pace[k] = (height(c[k + 1]) - known) / own
    time = (np.cumsum(pace) - pace / 2) * width / speed
    force = np.zeros(steps)
    for k in range(1, steps - 1):
        flow = flows[k]
        change = (flows[k + 1].phi - flows[k - 1].phi) / (2 * width)  # at the same r/c
        moving = (change - flow.middle[:, 0] / flow.c * flow.slip / flow.along[:, 0]) / pace[k]  # d phi/dt on the body
        force[k] = density * speed**2 * flow.force(-moving - flow.u[:, 1] - (flow.u**2).sum(1) / 2)
    return time[1:-1], force[1:-1]


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--panels", type=int, default=40)
    options.add_argument("--steps", type=int, default=16)
    chosen = options.parse_args()
    round_body = Flow(lambda r: 1 - np.sqrt(np.maximum(1 - r * r, 0)), 1 - 1e-9, chosen.panels, grading=1)
    flat = Flow(lambda r: 1e-3 * r, 1.0, chosen.panels)
    print(f"half sphere {round_body.added_mass / (np.pi / 3):.4f} of pi/3 rho R^3, disc {flat.added_mass / (4 / 3):.4f} of 4/3 rho c^3")
    for deadrise in (20, 30):
        (force, k), least = cone(deadrise, chosen.panels), 4 / np.tan(np.radians(deadrise)) ** 3  # von Karman's
        print(f"cone of {deadrise} degrees: F/(rho V^4 t^2) {force:.2f}, von Karman {least:.2f}, Wagner {least * (4 / np.pi)**3:.2f}; c/(V t) {k:.3f}")
    time, force = sphere(chosen.panels, chosen.steps, **SPHERE)
    depth = SPHERE["speed"] * time / SPHERE["radius"]
    fine = np.linspace(0, 0.09, 2000)
    on_fine = np.interp(fine, np.concatenate([[0], depth]), np.concatenate([[0], force]))
    mean = lambda low, high: on_fine[(fine >= low) & (fine <= high)].mean()
    print(f"sphere, V t/R from 0.02 to 0.08: mean {mean(0.02, 0.08):.0f} N, in thirds {mean(0.02, 0.04):.0f}, {mean(0.04, 0.06):.0f}, "
          f"{mean(0.06, 0.08):.0f} N; impulse to 0.09: {mean(0, 0.09) * 0.09 * SPHERE['radius'] / SPHERE['speed']:.3f} N s")


if __name__ == "__main__":
    main()
