"""Flows of ideal water with answers that are exact, or computed to all digits that are shown: references of cases.

usage: tests/benchmark/exact_answers.py [ANSWER]… [--keep DIR]     (default: all of them; needs numpy)
  plate      a rigid flat plate falls on water: the speed that contact leaves it, and how it goes on (cases/plate_drop.toml)
  cylinder   mean slamming coefficient of a cylinder by the formula of Campbell & Weynberg (cases/cylinder_entry.toml)
  release    added mass and first acceleration of a cylinder let go under water in a tank (cases/cylinder_release.toml)
  wave       a steep standing wave that starts at rest from a cosine (cases/standing_wave_steep.toml)
  drop       an elliptic drop without gravity, round at first and drawn out by its own motion (no case yet)
writes the curves of wave and drop to DIR as CSV, with the head that files of cases/reference/ have."""
import argparse
import math
import pathlib

try:
    import numpy
except ImportError:
    raise SystemExit("exact_answers.py: needs numpy\n  fix: install the package python3-numpy, and call the system's python3") from None

import linear_plate
import plate_edge

GRAVITY, DENSITY = 9.81, 1000.0  # m/s^2, kg/m^3
EDGE = 0.559                     # C of plate_edge.py


def runge_kutta(rates, state, step):
    one = rates(state)
    two = rates(state + step / 2 * one)
    three = rates(state + step / 2 * two)
    four = rates(state + step * three)
    return state + step / 6 * (one + 2 * two + 2 * three + four)


def plate_speed(mass, speed, times):
    """Speed left [m/s] at times after contact: m V = (m + M) v. M is the added mass of the half width a + D, where D = 2^(4/3) C a
    (z/a)^(2/3) at each edge (plate_edge.py) and z is the way since contact. D is that of constant speed: exact at contact only."""
    contact, growth = linear_plate.contact_growth()
    unit, way, now, result = DENSITY * linear_plate.HALF**2, 0.0, 0.0, []
    for time in times:
        while now < time - 1e-12:
            wider = 2 ** (4 / 3) * EDGE * (way / linear_plate.HALF) ** (2 / 3)
            way += 1e-7 * mass * speed / (mass + unit * (contact[1] + growth[1] * wider))
            now += 1e-7
        result.append(mass * speed / (mass + unit * (contact[1] + growth[1] * 2 ** (4 / 3) * EDGE * (way / linear_plate.HALF) ** (2 / 3))))
    return result


def plate(_):
    contact = math.sqrt(6.26**2 + 2 * GRAVITY * 0.012)
    times = [0.0, 1e-4, 2e-4, 3e-4]
    print("Flat plate of 0.4 m, 62.4 kg per metre, that meets the water of plate_entry's tank at "
          f"{contact:.3f} m/s: speed left\n  after  " + "  ".join(f"{1e6 * t:.0f} us: {v:.4f} m/s" for t, v in zip(times, plate_speed(62.4, contact, times))))


def cylinder(_):
    """Mean of Cs = F/(rho R V^2) = 5.15/(1 + 8.5 s) + 0.275 s over s = V t/R."""
    print("\nCylinder that enters water, Campbell & Weynberg 1980: mean of F/(rho R V^2)")
    for low, high in ((0.05, 0.2), (0.1, 0.5), (0.2, 1.0)):
        whole = 5.15 / 8.5 * math.log((1 + 8.5 * high) / (1 + 8.5 * low)) + 0.275 / 2 * (high**2 - low**2)
        print(f"  V t/R from {low:g} to {high:g}: {whole / (high - low):.4f}")


def line(first, last, count):
    return numpy.linspace(first, last, count + 1)


def added_mass(radius, half_width, depth, below, count):
    """Of a cylinder that heaves `below` the surface (p = 0) of a tank, over rho pi R^2: phi = 0 above, dphi/dn = n_y on it, 0 on walls.
    Boundary elements with linear functions; two points at each corner between surface and walls."""
    turn = line(2 * math.pi, 0, count)  # the water lies to the left
    body = numpy.stack([radius * numpy.cos(turn), radius * numpy.sin(turn) - below], 1)
    body[-1] = body[0]
    wide = half_width / depth
    walls = numpy.vstack([line((-half_width, 0.0), (-half_width, -depth), count), line((-half_width, -depth), (half_width, -depth), int(2 * wide * count))[1:],
                          line((half_width, -depth), (half_width, 0.0), count)[1:]])
    parts = [body[:-1], walls, line((half_width, 0.0), (-half_width, 0.0), int(2 * wide * count))]
    start = numpy.cumsum([0] + [len(part) for part in parts])
    points = numpy.vstack(parts)
    ring = numpy.roll(numpy.arange(start[1]), -1)
    first = numpy.concatenate([numpy.arange(start[1]), numpy.arange(start[1], start[2] - 1), numpy.arange(start[2], start[3] - 1)])
    last = numpy.concatenate([ring, first[start[1]:] + 1])
    dipoles, sources = numpy.zeros((2, start[3], start[3]))
    pieces = plate_edge.influences(points, points[first], points[last])
    for matrix, of_first, of_last in ((dipoles, *pieces[:2]), (sources, *pieces[2:])):
        numpy.add.at(matrix.T, first, of_first.T)
        numpy.add.at(matrix.T, last, of_last.T)
    dipoles[numpy.diag_indices(start[3])] -= dipoles.sum(1)
    normal = -(body[:-1] + [0, below]) / radius  # out of the water
    matrix = dipoles.copy()
    matrix[:, start[2]:] = -sources[:, start[2]:]
    right = sources[:, :start[1]] @ normal[:, 1]
    for row in (start[1], start[2] - 1):         # wall points of the corners: phi = 0
        matrix[row], right[row] = 0, 0
        matrix[row, row] = 1
    potential = numpy.linalg.solve(matrix, right)[:start[1]]
    piece = 2 * radius * math.sin(math.pi / count)
    return (potential * normal[:, 1]).sum() * piece / (math.pi * radius**2)


def release(_):
    """(m + m_a) a = (m_d - m) g, m_d the mass of the water in the cylinder's place."""
    print("\nCylinder of 0.1 m let go 0.5 m under the surface of a tank 1.6 m wide and 1 m deep")
    for count in (40, 80, 160):
        share = added_mass(0.1, 0.8, 1.0, 0.5, count)
        print(f"  {count:4d} elements: added mass {share:.4f} of the water in its place; first acceleration "
              + ", ".join(f"{(1 - light) / (light + share) * GRAVITY:+.3f} m/s^2 at {light:g} of its density" for light in (0.5, 3.0)))


class StandingWave:
    """Surface h(x) and its potential P(x) of one wave of length 1 m in water H deep, even about both antinodes.
    phi = sum c_n cosh(k_n (y + H))/cosh(k_n H) cos(k_n x); c_n from P by least squares at twice as many points each time;
    dh/dt = phi_y - h_x phi_x,   dP/dt = -g h - (phi_x^2 + phi_y^2)/2 + phi_y dh/dt,   both kept to the same waves."""

    def __init__(self, amplitude, depth, count):
        self.k, self.depth = 2 * math.pi * numpy.arange(count + 1), depth
        self.x = numpy.arange(2 * count + 1) / (4 * count)
        self.cosine, self.sine = numpy.cos(self.k * self.x[:, None]), numpy.sin(self.k * self.x[:, None])
        self.weight = numpy.full(len(self.x), self.x[1])
        self.weight[[0, -1]] /= 2
        self.waves = (self.cosine * self.weight[:, None]).T * 4  # from points to waves
        self.waves[0] /= 2
        self.fading = (self.cosine * numpy.exp(-36 * (numpy.arange(count + 1) / count) ** 12)) @ self.waves  # the shortest waves fade
        self.state = numpy.concatenate([amplitude * self.cosine[:, 1], numpy.zeros(len(self.x))])

    def _parts(self, surface, potential):
        up = numpy.exp(self.k * surface[:, None])
        down = numpy.exp(-self.k * (surface[:, None] + 2 * self.depth))
        high = (up + down) * self.cosine
        size = numpy.sqrt((high**2).sum(0))  # columns of equal size: the shortest waves differ by orders of magnitude
        c = numpy.linalg.lstsq(high / size, potential, rcond=None)[0] / size
        return -((up + down) * self.sine) @ (c * self.k), ((up - down) * self.cosine) @ (c * self.k)

    def rates(self, state):
        surface, potential = numpy.split(state, 2)
        along, upwards = self._parts(surface, potential)
        rise = upwards + (self.sine @ (self.k * (self.waves @ surface))) * along
        gain = -GRAVITY * surface - (along**2 + upwards**2) / 2 + upwards * rise
        return numpy.concatenate([self.fading @ rise, self.fading @ gain])

    def energy(self):
        """Per metre of depth and over the density: int P dh/dt /2 + g h^2 /2 over half the wave."""
        surface, potential = numpy.split(self.state, 2)
        return self.weight @ (0.5 * potential * self.rates(self.state)[:len(self.x)] + 0.5 * GRAVITY * surface**2)

    def follow(self, step, end):
        """Times and the heights over the mean level at both antinodes."""
        rows = [(0.0, self.state[0], self.state[len(self.x) - 1])]
        for n in range(1, round(end / step) + 1):
            self.state = runge_kutta(self.rates, self.state, step)
            rows.append((n * step, self.state[0], self.state[len(self.x) - 1]))
        return numpy.array(rows).T


def period(times, heights):
    """Mean time between upward crossings of the mean, as `strake compare` counts it."""
    about = heights - heights.mean()
    up = numpy.nonzero((about[:-1] < 0) & (about[1:] >= 0))[0]
    crossed = times[up] - about[up] * (times[1] - times[0]) / (about[up + 1] - about[up])
    return (crossed[-1] - crossed[0]) / (len(crossed) - 1)


def wave(folder):
    print("\nStanding wave of 1 m in 0.5 m of water, at rest as a cosine at first\n  amplitude [m]  waves  step [s]  period [s]  crest after two periods [m]  energy lost")
    for amplitude, count, step in ((0.03, 12, 2e-3), (0.03, 24, 2e-3), (0.05, 12, 2e-3), (0.05, 16, 2e-3), (0.05, 24, 1e-3), (0.05, 32, 1e-3)):
        flow = StandingWave(amplitude, 0.5, count)
        before = flow.energy()
        times, near, middle = flow.follow(step, 4.2)
        late = (times > 1.2) & (times < 2.0)
        print(f"  {amplitude:13g}  {count:5d}  {step:8g}  {period(times, near):10.4f}  {near[late].max():27.5f}  {1 - flow.energy() / before:.1e}", flush=True)
    keep(folder, "standing_wave_steep.csv", times[::10], [0.5 + near[::10], 0.5 + middle[::10]], ["time [s]", "crest first [m]", "trough first [m]"],
         ["Height of the water at both antinodes of a standing wave: length 1 m, depth 0.5 m, 0.05 m high, at rest as a cosine at first.",
          "origin     own calculation: tests/benchmark/exact_answers.py, 32 waves, steps of 1 ms; ideal water"])


def drop_rates(state):
    """Of the semi-axes and A in u = A x, v = -A y: da/dt = A a, db/dt = -A b, dA/dt = A^2 (b^2 - a^2)/(a^2 + b^2)."""
    a, b, rate = state
    return numpy.array([rate * a, -rate * b, rate**2 * (b**2 - a**2) / (a**2 + b**2)])


def drop(folder):
    """In its middle p = rho A^2 a^2 b^2/(a^2 + b^2). Time in 1/A(0), lengths in the radius at first."""
    state, rows = numpy.array([1.0, 1.0, 1.0]), []
    print("\nElliptic drop, round at first, time in 1/A\n  t     a/R       b/R       A(t)/A    p in the middle/(rho A^2 R^2)")
    for n in range(2001):
        a, b, rate = state
        rows.append((n * 1e-3, a, b, rate, (rate * a * b) ** 2 / (a**2 + b**2)))
        if n % 250 == 0:
            print("  " + "  ".join(f"{v:.6f}" if k else f"{v:.2f}" for k, v in enumerate(rows[-1])))
        state = runge_kutta(drop_rates, state, 1e-3)
    columns = list(numpy.array(rows[::20]).T)
    keep(folder, "elliptic_drop.csv", columns[0], columns[1:], ["time [1]", "a [1]", "b [1]", "A [1]", "p [1]"],
         ["Semi-axes of a drop, round at first, u = A x, v = -A y; time in 1/A(0), lengths in the radius, p in rho A(0)^2 R^2, in the middle.",
          "origin     own calculation: tests/benchmark/exact_answers.py; da/dt = A a, db/dt = -A b, dA/dt = A^2 (b^2 - a^2)/(a^2 + b^2)"])


def keep(folder, name, first, columns, names, head):
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"# {text}" for text in [*head, "licence    that of these sources"]] + [",".join(names)]
    lines += [",".join(f"{v:.6g}" for v in row) for row in zip(first, *columns)]
    (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")


ANSWERS = {"plate": plate, "cylinder": cylinder, "release": release, "wave": wave, "drop": drop}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("answer", nargs="*", metavar="ANSWER")
    parser.add_argument("--keep", type=pathlib.Path, metavar="DIR")
    arguments = parser.parse_args()
    for name in arguments.answer:
        if name not in ANSWERS:
            parser.error(f"{name}: expected {', '.join(ANSWERS)}")
    for name in arguments.answer or ANSWERS:
        ANSWERS[name](arguments.keep)


if __name__ == "__main__":
    main()
