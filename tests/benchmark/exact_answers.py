"""Flows of ideal water with answers that are exact, or computed to all digits that are shown: references of cases.

usage: tests/benchmark/exact_answers.py [ANSWER]… [--keep DIR]     (default: all of them; needs numpy)
  plate      a rigid flat plate falls on water: the speed that contact leaves it, and how it goes on (cases/plate_drop.toml)
  cylinder   mean slamming coefficient of a cylinder by the formula of Campbell & Weynberg (cases/cylinder_entry.toml)
  release    added mass and first acceleration of a cylinder let go under water in a tank (cases/cylinder_release.toml)
  wave       a steep standing wave that starts at rest from a cosine (cases/standing_wave_steep.toml)
  drop       an elliptic drop without gravity, round at first and drawn out by its own motion (cases/elliptic_drop.toml)
  floating   heave of a cylinder and of a box that float in a tank, let go over their place of rest (cases/floating_cylinder.toml)
  wall       an elastic wall of a tank: its frequencies with water before it, and its rest (cases/elastic_wall.toml)
writes the curves of wave, drop and floating to DIR as CSV, with the head that files of cases/reference/ have."""
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
    print("\nElliptic drop, round at first, time in 1/A; its energy is pi/4 rho A(0)^2 R^4\n  t     a/R       b/R       A(t)/A    p in the middle/(rho A^2 R^2)")
    for n in range(2001):
        a, b, rate = state
        rows.append((n * 1e-3, a, b, rate, (rate * a * b) ** 2 / (a**2 + b**2)))
        if n % 250 == 0:
            print("  " + "  ".join(f"{v:.6f}" if k else f"{v:.2f}" for k, v in enumerate(rows[-1])))
        state = runge_kutta(drop_rates, state, 1e-3)
    columns = list(numpy.array(rows[::20]).T)
    columns[-1] = DENSITY * columns[-1]
    keep(folder, "elliptic_drop.csv", columns[0], columns[1:], ["time [s]", "a [m]", "b [m]", "A [1/s]", "p [Pa]"],
         ["Semi-axes of a drop of water, round at first with R = 1 m, u = A x, v = -A y with A = 1/s; p is the pressure in its middle.",
          "origin     own calculation: tests/benchmark/exact_answers.py; da/dt = A a, db/dt = -A b, dA/dt = A^2 (b^2 - a^2)/(a^2 + b^2)"])


def spaced(first, last, size, power=1, dense_end=False):
    """Points from first to last, about `size` apart; with the power 2 they crowd towards one end."""
    first, last = numpy.array(first), numpy.array(last)
    s = numpy.linspace(0, 1, max(4, round(math.hypot(*(last - first)) / size)) + 1)
    s = 1 - (1 - s) ** power if dense_end else s**power
    return first + s[:, None] * (last - first)


def half_box(half, draught, size):
    """Right half of a box from its waterline to its middle; points crowd at the corner, where the velocity has no bound."""
    return numpy.vstack([spaced((half, 0), (half, -draught), size, 2, True), spaced((half, -draught), (0, -draught), size, 2)[1:]])


def half_cylinder(radius, size):
    """The same of a cylinder whose axis lies in the level."""
    turn = line(0, -math.pi / 2, round(math.pi / 2 * radius / size))
    return radius * numpy.stack([numpy.cos(turn), numpy.sin(turn)], 1)


def heave_operators(body, side, depth, size):
    """Linear operators of a body that heaves between walls at +-side; its right half by symmetry, elements of about `size`.
    Returns the surface's points; a matrix that gives dphi/dn there, and a row that gives the integral of phi n_y over the whole body,
    both of the potentials phi on the surface and, last, of the body's speed. Two points stand at each end of the surface."""
    walls = numpy.vstack([spaced(body[-1], (0, -depth), size), spaced((0, -depth), (side, -depth), size)[1:], spaced((side, -depth), (side, 0), size)[1:]])
    surface = spaced((side, 0), body[0], size)
    points = numpy.vstack([walls, surface, body[:-1]])
    start, end, count = len(walls), len(walls) + len(surface), len(points)
    first = numpy.delete(numpy.arange(count), [start - 1, end - 1])
    last = numpy.roll(numpy.arange(count), -1)[first]  # the last point is followed by the first: the curve is closed
    dipoles, sources = numpy.zeros((2, count, count))
    pieces = plate_edge.influences(points, points[first], points[last])
    for matrix, of_first, of_last in ((dipoles, *pieces[:2]), (sources, *pieces[2:])):
        numpy.add.at(matrix.T, first, of_first.T)
        numpy.add.at(matrix.T, last, of_last.T)
    dipoles[numpy.diag_indices(count)] -= dipoles.sum(1)
    wet = slice(len(first) - len(body) + 1, len(first))  # the body's elements
    lift = points[first[wet], 0] - points[last[wet], 0]  # length times n_y, n out of the water
    length = numpy.hypot(*(points[last[wet]] - points[first[wet]]).T)
    matrix = dipoles.copy()
    matrix[:, start:end] = -sources[:, start:end]
    right = numpy.hstack([-dipoles[:, start:end], ((pieces[2] + pieces[3])[:, wet] @ (lift / length))[:, None]])
    for row, of in ((start - 1, 0), (end, len(surface) - 1)):  # wall and body meet the surface: the same potential
        matrix[row], right[row] = 0, 0
        matrix[row, row] = right[row, of] = 1
    answer = numpy.linalg.solve(matrix, right)
    weight = numpy.zeros(count)
    numpy.add.at(weight, first[wet], lift)  # half of each element, and both halves of the body
    numpy.add.at(weight, last[wet], lift)
    return surface, answer[start:end], weight @ answer


def heave(heavier, body, side, depth, size, step, end):
    """Height z(t) over its start of a body that is let go under a level surface, h = 0, P = 0; linear theory. M is the water in its place, m = heavier M:
    dh/dt = dP/dn,  dP/dt = -g h,  m d2z/dt2 = (M - m) g - rho g b z - rho d/dt (integral of P n_y), b its width at the level.
    Returns times, z, the added mass under P = 0, and the water that rose at the surface over the water that the body pushed away."""
    surface, rises, force = heave_operators(body, side, depth, size)
    n, added, half = len(surface), DENSITY * force[-1], body[0, 0]
    in_place = DENSITY * (-body[:-1, 0] - body[1:, 0]) @ numpy.diff(body[:, 1])
    mass = heavier * in_place

    def rates(state):
        level, potential, place, speed = state[:n], state[n:-2], state[-2], state[-1]
        lift = GRAVITY * (in_place - mass + DENSITY * (force[:-1] @ level - 2 * half * place))
        return numpy.concatenate([rises @ numpy.append(potential, speed), -GRAVITY * level, [speed, lift / (mass + added)]])

    state, places = numpy.zeros(2 * n + 2), [0.0]
    for _ in range(round(end / step)):
        state = runge_kutta(rates, state, step)
        places.append(state[-2])
    gain = -((state[1:n] + state[:n - 1]) / 2 * numpy.diff(surface[:, 0])).sum()  # from the wall to the body
    return step * numpy.arange(len(places)), numpy.array(places), added, gain / (-half * state[-2])


def floating(folder):
    side, depth = 1.5, 0.6
    print(f"\nBodies let go under a level surface, in a tank {2 * side:g} m wide and {depth:g} m deep\n  "
          "size [m]  added mass [kg/m]  first acceleration [m/s^2]  lowest [mm]  at [s]  next highest [mm]  at [s]")
    curves = []
    for name in ("Cylinder of radius 0.2 m, its axis in the level, 5 % heavier than the water in its place", "Box 0.4 m wide and 0.2 m deep, likewise"):
        print(name)
        for size in (0.04, 0.02, 0.01):
            body = half_box(0.2, 0.2, size / 2) if curves else half_cylinder(0.2, size / 2)
            times, places, added, _ = heave(1.05, body, side, depth, size, 2e-3, 2.0)
            low = places.argmin()
            high = low + places[low:].argmax()
            print(f"  {size:8g}  {added:17.2f}  {2 * places[1] / times[1] ** 2:26.4f}  {1e3 * places[low]:11.3f}  {times[low]:6.3f}"
                  f"  {1e3 * places[high]:17.3f}  {times[high]:6.3f}", flush=True)
        curves.append(places[::10])
    keep(folder, "floating_body.csv", times[::10], curves, ["time [s]", "cylinder [m]", "box [m]"],
         ["Height over its start of a body that is let go in a tank 3 m wide and 0.6 m deep, 5 % heavier than the water in its place: a cylinder of",
          "radius 0.2 m with its axis in the level, and a box 0.4 m wide and 0.2 m deep.",
          "origin     own calculation: tests/benchmark/exact_answers.py, elements of 10 mm, steps of 2 ms; linear theory of ideal water"])


def wet_wall(height, depth, length, stiffness, mass, shapes, waves):
    """An upright beam, clamped at the floor and free above, is the wall of a tank of that length: stiffness w_yyyy + (mass + water) w_tt = load.
    w = sum of q_i (y/height)^2 L_i(2 y/height - 1), Legendre's polynomials. The water's potential, 0 on its surface:
    phi = sum of b_n cos(k_n y) cosh(k_n (length - x)), k_n = (n - 1/2) pi/depth, with dphi/dx of the wall at x = 0.
    Returns the dry and the wet frequencies [Hz] and the top's deflection at rest [m]. Gravity changes the wet ones by g/(omega^2 depth) or less."""
    points, weight = numpy.polynomial.legendre.leggauss(200)
    points, weight = (points + 1) / 2, weight / 2
    shape = [numpy.polynomial.Polynomial([0, 0, 1]) * numpy.polynomial.Legendre.basis(i, [0, 1]).convert(kind=numpy.polynomial.Polynomial)
             for i in range(shapes)]
    along = numpy.array([p(points) for p in shape])
    bend = numpy.array([p.deriv(2)(points) for p in shape]) / height**2
    wetted = numpy.array([p(points * depth / height) for p in shape])
    k = (numpy.arange(waves) + 0.5) * math.pi / depth
    parts = depth * (wetted * weight) @ numpy.cos(numpy.outer(points * depth, k))
    own = mass * height * (along * weight) @ along.T
    water = DENSITY * (parts * 2 / (depth * k * numpy.tanh(k * length))) @ parts.T
    spring = stiffness * height * (bend * weight) @ bend.T
    load = DENSITY * GRAVITY * depth**2 * (wetted * weight) @ (1 - points)
    inverse = numpy.linalg.inv(numpy.linalg.cholesky(spring))
    dry, wet = (1 / (2 * math.pi * numpy.sqrt(numpy.linalg.eigvalsh(inverse @ matter @ inverse.T)[::-1])) for matter in (own, own + water))
    return dry, wet, numpy.linalg.solve(spring, load) @ [p(1.0) for p in shape]


def wall(_):
    stiffness, mass = 7e10 * 0.015**3 / 12 / (1 - 0.33**2), 2700 * 0.015
    print("\nElastic wall 0.6 m high, 15 mm of aluminium, clamped below; 0.5 m of water before it, 0.5 m long"
          "\n  shapes  waves  f1 dry [Hz]  f1 wet [Hz]  f2 wet [Hz]  top at rest [mm]")
    for shapes, waves in ((2, 80), (4, 80), (6, 80), (8, 10), (8, 20), (8, 40), (8, 80), (8, 160)):
        dry, wet, top = wet_wall(0.6, 0.5, 0.5, stiffness, mass, shapes, waves)
        print(f"  {shapes:6d}  {waves:5d}  {dry[0]:11.4f}  {wet[0]:11.4f}  {wet[1]:11.3f}  {1e3 * top:16.5f}")


def keep(folder, name, first, columns, names, head):
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"# {text}" for text in [*head, "licence    that of these sources"]] + [",".join(names)]
    lines += [",".join(f"{v:.6g}" for v in row) for row in zip(first, *columns)]
    (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")


ANSWERS = {"plate": plate, "cylinder": cylinder, "release": release, "wave": wave, "drop": drop, "floating": floating, "wall": wall}


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
