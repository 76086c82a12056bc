"""Flat plate that meets the still water of a tank at constant speed: linear theory, rigid and clamped, with and without sound.

usage: tests/benchmark/linear_plate.py [--quick] [--keep DIR]
       (plate and tank of cases/plate_entry.toml; --quick: fewer terms and no cells, for a test; needs numpy)
Prints
  1. impulse of the rigid plate over rho V a (middle) and rho V a^2 (whole plate),
  2. first peak of the middle's deflection, effect by effect: tank, sound, stiffness of the plate as a body,
  3. the same for fewer and more terms of every sum, and by a second method with cells and steps of time, which also knows water
     that cannot pull by more than an atmosphere,
and writes to DIR the histories (linear_plate.csv). cases/VALIDATION.md has the figures, "Rigid plate: impulse and pressure".

The water has no viscosity and no weight, its surface stays level with p = 0 beside the plate, walls are rigid. With s the
variable of the Laplace transform, c the speed of sound, a half the plate, L half the tank, H the depth of the water:
    p = sum P_n cos(k_n x) cosh(K_n (y + H))/cosh(K_n H),   k_n = n pi/L,   K_n^2 = k_n^2 + s^2/c^2,
    rho s w_n = K_n tanh(K_n H) P_n,   w the velocity of the surface downwards.
Pressures on the plate are p = sum q_j f_j, f_j = sqrt(1 - x^2/a^2) U_2j(x/a) with Chebyshev's U, hence
    A(s) q = rho s <f, w>,   A_ij = sum over n of K_n tanh(K_n H) <f_i, cos k_n x> <f_j, cos k_n x>/<cos k_n x, cos k_n x>.
The plate's modes have the frequencies O_m [rad/s], deflections u_m upwards and amounts r_m; their mass is 1:
    w = V/s - s sum r_m u_m,   (s^2 + O_m^2) r_m = sum B_mj q_j,   B_mj = <u_m, f_j>,
    [A + rho s^2 B' (s^2 + O^2)^-1 B] q = rho V <f, 1>.
Impulses are q/s. Fourier's series on a line of constant Re s undoes the transform. For L, H and c without bounds A_ij is
pi/2 (2 j + 1) for i = j, else 0, and the impulse is rho V sqrt(a^2 - x^2)."""
import argparse
import csv
import math
import pathlib

try:
    import numpy
except ImportError:
    raise SystemExit("linear_plate.py: needs numpy\n  fix: install the package python3-numpy, and call the system's python3") from None

DENSITY, SOUND = 1000.0, 1500.0              # kg/m^3, m/s
HALF, THICKNESS = 0.2, 0.02                  # half the plate [m], m
TANK, DEPTH = 1.0, 0.5                       # half the tank [m], m
YOUNG, POISSON, STEEL = 2.1e11, 0.3, 7800.0  # Pa, 1, kg/m^3
SPEED = 6.26                                 # m/s
ATMOSPHERE = 1e5                             # Pa


def places(points):
    """Angles of the midpoint rule, x = HALF cos(angle): exact for cosines of fewer than 2 `points` waves."""
    return (numpy.arange(points) + 0.5) * math.pi / points


def shapes_at(count, angle):
    """f_j dx/HALF at each angle."""
    odd = 2 * numpy.arange(count) + 1
    return numpy.sin(angle)[:, None] * numpy.sin(odd * angle[:, None]) * math.pi / len(angle)


class Water:
    """What pressures f_j on the plate make of the surface under it: `resistance(s)` is A(s), without units."""

    def __init__(self, count, waves, sound, bounded=True, tank=TANK, depth=DEPTH):
        self.count, self.sound, self.bounded, self.depth = count, sound, bounded, depth
        self.middle, self.uniform = (-1.0) ** numpy.arange(count), numpy.zeros(count)
        self.uniform[0] = HALF * math.pi / 2                                  # <f_j, 1> [m]
        odd = 2 * numpy.arange(count) + 1
        self.k = numpy.arange(waves + 1) * math.pi / tank
        self.rest = numpy.diag(math.pi / 2 * odd)
        if not bounded:
            return
        self.weight = numpy.full(waves + 1, HALF**2 / tank)
        self.weight[0] /= 2
        angle = places(int(self.k[-1] * HALF + 2 * count + 60))
        f, self.transform = shapes_at(count, angle), numpy.empty((waves + 1, count))  # <f_j, cos k x>/HALF
        for first in range(0, waves + 1, 500):
            self.transform[first:first + 500] = numpy.cos(self.k[first:first + 500, None] * HALF * numpy.cos(angle)) @ f
        # Waves left out: transform = (2 j + 1) sqrt(2 pi) (k a)^(-3/2) cos(k a - 3 pi/4), up to sign; cos^2 is 1/2 in the mean.
        left = (1.0 / numpy.arange(waves + 1, 40 * waves) ** 2.0).sum() + 1 / (40 * waves)
        self.rest = numpy.outer(odd, odd) * tank / (math.pi * HALF) * left

    def resistance(self, s):
        if not self.bounded:
            return self.rest
        k = self.k if self.sound == math.inf else numpy.sqrt(self.k**2 + (s / self.sound) ** 2)
        fall = numpy.exp(-2 * k * self.depth)
        return (self.transform.T * (self.weight * k * (1 - fall) / (1 + fall))) @ self.transform + self.rest


class Rigid:
    """A plate without modes. `at(x)`: deflection of each mode at places x; `frequency` in rad/s."""
    frequency = numpy.zeros(0)

    def at(self, x):
        return numpy.zeros((len(x), 0))


class Beam:
    """Clamped strip of Euler and Bernoulli: cos(b x)/cos(b a) - cosh(b x)/cosh(b a), where tan(b a) + tanh(b a) = 0."""

    def __init__(self, modes):
        z = (numpy.arange(modes) + 0.75) * math.pi
        for _ in range(20):
            z = z - (numpy.tan(z) + numpy.tanh(z)) / (1 / numpy.cos(z) ** 2 + 1 / numpy.cosh(z) ** 2)
        bending = YOUNG * THICKNESS**3 / 12 / (1 - POISSON**2)
        self.z, self.frequency = z, (z / HALF) ** 2 * math.sqrt(bending / (STEEL * THICKNESS))
        self.size = numpy.ones(modes)
        angle = places(400 * modes)
        squares = (self.at(HALF * numpy.cos(angle)) ** 2).T @ numpy.sin(angle) * HALF * math.pi / len(angle)
        self.size = numpy.sqrt(STEEL * THICKNESS * squares)

    def at(self, x):
        z = numpy.abs(numpy.asarray(x))[:, None] * self.z / HALF
        cosh = numpy.exp(z - self.z) * (1 + numpy.exp(-2 * z)) / (1 + numpy.exp(-2 * self.z))
        return (numpy.cos(z) / numpy.cos(self.z) - cosh) / self.size


class Body:
    """The strip as an elastic body in plane strain: quadratic quadrilaterals of half of it, ends clamped on their whole face."""

    def __init__(self, modes, cells):
        self.along, across = cells, max(2, cells // 10)
        nodes = lambda i, j: i * (2 * across + 1) + j
        stiffness, mass = self._cell(HALF / cells, THICKNESS / across)
        size = 2 * (2 * cells + 1) * (2 * across + 1)
        k, m = numpy.zeros((size, size)), numpy.zeros((size, size))
        for i in range(cells):
            for j in range(across):
                own = [2 * nodes(2 * i + p, 2 * j + q) + d for p in range(3) for q in range(3) for d in range(2)]
                k[numpy.ix_(own, own)] += stiffness
                m[numpy.ix_(own, own)] += mass
        held = {2 * nodes(0, j) for j in range(2 * across + 1)} | {2 * nodes(2 * cells, j) + d for j in range(2 * across + 1) for d in range(2)}
        free = numpy.array([n for n in range(size) if n not in held])
        lower = numpy.linalg.cholesky(m[numpy.ix_(free, free)])
        scaled = numpy.linalg.solve(lower, numpy.linalg.solve(lower, k[numpy.ix_(free, free)]).T)
        squares, vectors = numpy.linalg.eigh((scaled + scaled.T) / 2)
        self.frequency = numpy.sqrt(squares[:modes])
        whole = numpy.zeros((size, modes))
        whole[free] = numpy.linalg.solve(lower.T, vectors[:, :modes])
        # The half's mass is 1 by now, the strip's is 2.
        self.bottom = whole[[2 * nodes(i, 0) + 1 for i in range(2 * cells + 1)]] / math.sqrt(2)

    def _cell(self, dx, dy):
        """Stiffness and mass of one cell dx x dy, unknowns node by node, nodes column by column."""
        gauss, weights = numpy.polynomial.legendre.leggauss(3)
        value = lambda t: numpy.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2])
        slope = lambda t: numpy.array([t - 0.5, -2 * t, t + 0.5])
        law = YOUNG / (1 + POISSON) / (1 - 2 * POISSON) * numpy.array(
            [[1 - POISSON, POISSON, 0], [POISSON, 1 - POISSON, 0], [0, 0, 0.5 - POISSON]])
        stiffness, mass = numpy.zeros((18, 18)), numpy.zeros((18, 18))
        for x, wx in zip(gauss, weights):
            for y, wy in zip(gauss, weights):
                n = numpy.outer(value(x), value(y)).ravel()
                nx, ny = numpy.outer(slope(x), value(y)).ravel() * 2 / dx, numpy.outer(value(x), slope(y)).ravel() * 2 / dy
                strain, move = numpy.zeros((3, 18)), numpy.zeros((2, 18))
                strain[0, ::2], strain[1, 1::2], strain[2, ::2], strain[2, 1::2] = nx, ny, ny, nx
                move[0, ::2], move[1, 1::2] = n, n
                stiffness += strain.T @ law @ strain * wx * wy * dx * dy / 4
                mass += STEEL * move.T @ move * wx * wy * dx * dy / 4
        return stiffness, mass

    def at(self, x):
        place = numpy.abs(numpy.asarray(x)) / HALF * self.along
        first = numpy.minimum(place.astype(int), self.along - 1)
        t = (2 * (place - first) - 1)[:, None]
        left, centre, right = (self.bottom[2 * first + n] for n in range(3))
        return t * (t - 1) / 2 * left + (1 - t * t) * centre + t * (t + 1) / 2 * right


def history(water, plate, times, highest):
    """Impulse at the middle over rho V a, of the plate over rho V a^2, deflection of the middle over V [s], at each time."""
    angle = places(2000 + 4 * water.count)
    load = HALF * plate.at(HALF * numpy.cos(angle)).T @ shapes_at(water.count, angle)  # B
    middle = plate.at(numpy.zeros(1))[0]
    # The series repeats itself after `period`; what it brings in from there is smaller by exp(-shift period) = 1e-7.
    period = 3 * times[-1]
    shift, count = math.log(1e7) / period, int(highest * period / (2 * math.pi))
    sums = numpy.zeros((3, len(times)))
    for n in range(count):
        s = complex(shift, 2 * math.pi * (n + 0.5) / period)
        answer = 1 / (s * s + plate.frequency**2)
        system = water.resistance(s) + DENSITY * s * s * (load.T * answer) @ load
        q = DENSITY * numpy.linalg.solve(system, water.uniform.astype(complex))
        values = numpy.array([water.middle @ q / (s * DENSITY * HALF), water.uniform @ q / (s * DENSITY * HALF**2),
                              middle @ (answer * (load @ q))])
        # The highest frequencies fade out, so that the end of the series leaves no ripples.
        sums += math.cos(math.pi / 2 * (n + 0.5) / count) ** 2 * (values[:, None] * numpy.exp(s * times)).real
    return 2 / period * sums


def history_by_cells(across, plate, end, tension=math.inf):
    """Time [s] and the figures of `history`, by a second method: square cells, `across` of them over half the plate.
    Pressures sit in the cells' middles, velocities on their sides, half a step later. Its error is of first order: the edge.
    Water may be let go where it would pull by more than `tension` [Pa for V = 1 m/s]: its volume then grows at that pressure."""
    size = HALF / across
    step = 0.65 * size / SOUND
    p = numpy.zeros((round(DEPTH / size), round(TANK / size)))  # as if water could pull without bound
    u, v = numpy.zeros((p.shape[0], p.shape[1] + 1)), numpy.zeros((p.shape[0] + 1, p.shape[1]))  # v downwards, row 0 the surface
    modes, middle = plate.at((numpy.arange(across) + 0.5) * size), plate.at(numpy.zeros(1))[0]
    amount, rate = numpy.zeros(len(middle)), numpy.zeros(len(middle))
    face, borne, rows, sums = numpy.zeros(across), p, [], numpy.zeros(2)
    for n in range(1, math.ceil(end / step) + 1):
        u[:, 1:-1] -= step / (DENSITY * size) * (borne[:, 1:] - borne[:, :-1])
        v[1:-1] -= step / (DENSITY * size) * (borne[1:] - borne[:-1])
        v[0, across:] -= step / (DENSITY * size / 2) * borne[0, across:]
        rate += step * (2 * size * (modes.T @ face) - plate.frequency**2 * amount)
        amount += step * rate
        v[0, :across] = 1 - modes @ rate
        p -= step * DENSITY * SOUND**2 / size * (u[:, 1:] - u[:, :-1] + v[1:] - v[:-1])
        borne = p if tension == math.inf else numpy.maximum(p, -tension)
        face = numpy.maximum(1.5 * borne[0, :across] - 0.5 * borne[1, :across], -tension)
        sums += step * numpy.array([face[0] / (DENSITY * HALF), 2 * size * face.sum() / (DENSITY * HALF**2)])
        rows.append([n * step, *sums, middle @ amount])
    return numpy.array(rows).T


def at(times, values, when):
    return float(numpy.interp(when, times, values))


def peak(times, values):
    """The largest value between samples and its time, by a parabola through three of them."""
    k = int(numpy.argmax(values))
    below, top, above = values[k - 1:k + 2]
    place = 0.5 * (below - above) / (below - 2 * top + above)
    return top - 0.25 * (below - above) * place, times[k] + place * (times[1] - times[0])


def contact(water):
    """Impulse of the contact with incompressible water: middle over rho V a, plate over rho V a^2."""
    q = numpy.linalg.solve(water.resistance(0), water.uniform)
    return water.middle @ q / HALF, water.uniform @ q / HALF**2


def contact_growth(bounded=True, count=16, waves=2000, share=1e-3):
    """The same, and how it grows with the half width, d(I a)/da and d(I a^2)/da: a wider plate is a smaller tank."""
    least, most = (contact(Water(count, waves, math.inf, bounded, TANK / a, DEPTH / a)) for a in (1 - share, 1 + share))
    growth = [(high * (1 + share) ** n - low * (1 - share) ** n) / (2 * share) for n, low, high in zip((1, 2), least, most)]
    return contact(Water(count, waves, math.inf, bounded)), growth


def rigid_table(times, count, waves, highest):
    deep, tank = contact(Water(count, waves, math.inf, False)), contact(Water(count, waves, math.inf))
    print("Rigid plate, impulse over rho V a (middle) and rho V a^2 (plate)")
    print(f"  incompressible, deep and wide     {deep[0]:.4f}  {deep[1]:.4f}   (1 and pi/2)")
    print(f"  incompressible, this tank         {tank[0]:.4f}  {tank[1]:.4f}   ({tank[1] * DENSITY * HALF**2:.2f} V N s/m)")
    middle, whole, _ = history(Water(count, waves, SOUND), Rigid(), times, highest)
    for when in (133e-6, 300e-6, 600e-6):
        print(f"  c = 1500 m/s, after {1e6 * when:3.0f} us          {at(times, middle, when):.4f}  {at(times, whole, when):.4f}")
    return middle, whole


def plate_table(times, count, waves, highest, plates):
    print("\nClamped plate, first peak of the middle\n  water                             plate     mm per m/s   at 6.26 m/s    time")
    kept = []
    for name, water in (("incompressible, deep and wide", Water(count, waves, math.inf, False)),
                        ("incompressible, this tank", Water(count, waves, math.inf)),
                        ("c = 1500 m/s, this tank", Water(count, waves, SOUND))):
        for kind, plate in plates.items():
            bent = history(water, plate, times, highest)[2]
            largest, when = peak(times, bent)
            print(f"  {name:<33} {kind:<9} {1e3 * largest:9.5f}   {1e3 * SPEED * largest:9.4f} mm   {1e3 * when:.3f} ms")
            kept.append(bent)
    return kept[-1]


def terms_table(times):
    print("\nConvergence, c = 1500 m/s, this tank: impulse of the rigid plate, first peak of the plate as a body at 6.26 m/s\n"
          "  shapes  waves  highest s  modes  cells  133 us   300 us   plate 300 us   first peak")
    for count, waves, highest, modes, cells in ((8, 500, 2.5e5, 3, 20), (16, 1000, 5e5, 6, 20), (32, 2000, 1e6, 12, 40), (64, 4000, 2e6, 24, 60)):
        water = Water(count, waves, SOUND)
        middle, whole, _ = history(water, Rigid(), times, highest)
        bent = history(water, Body(modes, cells), times, highest)[2]
        print(f"  {count:6d}  {waves:5d}  {highest:9.2g}  {modes:5d}  {cells:5d}  {at(times, middle, 133e-6):.4f}   "
              f"{at(times, middle, 300e-6):.4f}   {at(times, whole, 300e-6):.4f}         {1e3 * SPEED * peak(times, bent)[0]:.4f} mm", flush=True)


def cells_table():
    print("\nThe second method: cells and steps, order 1; the last row goes on to size 0. First peak of the plate as a body, for water\n"
          "that pulls without bound, and for water that pulls by one atmosphere at most, at four speeds, times 6.26 m/s over V (where\n"
          "water lets go the order is not 1: read the finest row)\n"
          "  cells  size [mm]  133 us   300 us   plate 300 us   peak [mm]   6.26     4.23     3.13     1.98 m/s")
    rows = []
    for across in (20, 40, 80, 160):
        time, middle, whole, _ = history_by_cells(across, Rigid(), 3.1e-4)
        rows.append([at(time, middle, 133e-6), at(time, middle, 300e-6), at(time, whole, 300e-6)])
        for tension in (math.inf, *(ATMOSPHERE / speed for speed in (6.26, 4.23, 3.13, 1.98))):
            time, _, _, bent = history_by_cells(across, Body(6, 40), 7e-4, tension)
            rows[-1].append(1e3 * SPEED * peak(time, bent)[0])
        print(f"  {across:5d}  {1e3 * HALF / across:9g}  " + "   ".join(f"{v:.4f}" for v in rows[-1]), flush=True)
    print("      -          0  " + "   ".join(f"{2 * b - a:.4f}" for a, b in zip(*rows[-2:])))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path, metavar="DIR")
    arguments = parser.parse_args()
    times = numpy.linspace(0, 1e-3, 1001)
    sums = (16, 1000, 5e5) if arguments.quick else (32, 4000, 2e6)
    middle, whole = rigid_table(times, *sums)
    plates = {"beam": Beam(6), "body": Body(6, 20) if arguments.quick else Body(24, 40)}
    bent = plate_table(times, *sums, plates)
    if not arguments.quick:
        terms_table(times)
        cells_table()
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        with (arguments.keep / "linear_plate.csv").open("w", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["time [s]", "rigid: middle over rho V a [1]", "rigid: plate over rho V a^2 [1]", "clamped: deflection over V [s]"])
            table.writerows([f"{v:.6g}" for v in row] for row in zip(times, middle, whole, bent))


if __name__ == "__main__":
    main()
