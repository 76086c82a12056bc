"""Water round the edge of a flat plate just after it has met the surface: how fast the plate's impulse goes on growing.

usage: tests/benchmark/plate_edge.py [--spacing D]… [--far R] [--cut Y] [--until TAU] [--quick]
       (default: spacings 0.113 0.08 0.056 at R = 10, Y = 1.2, TAU = 6: a quarter of an hour; --quick: 0.113 up to TAU = 3, for a
       test; needs numpy)
Prints C for each spacing, and what it means for the plate of cases/plate_entry.toml. cases/VALIDATION.md, "Rigid plate: impulse
and pressure", has the figures. The problem is that of Iafrati & Korobkin 2004 (Phys. Fluids 16, 2214); solved here anew.

A plate of half width a meets incompressible water with speed V. Its potential is -V sqrt(a^2 - x^2) on the plate, hence near
the edge, at the distance r and the angle A under the level,  phi = -B sqrt(r) sin(A/2),  B = V sqrt(2 a). The velocity there has
no bound, so the flow within the length d = (B t)^(2/3) follows its own law, with the plate at rest beside it:
    x = d X,   phi = B sqrt(d) P(X),   dX/dT = grad P - 2/3 X,   dP/dT = |grad P|^2/2 - P/3  on the surface,   T = ln t.
The plate's edge is the origin, the plate lies at x < 0, and the water leaves the edge smoothly: there dP/dT = -P/3 - u^2/2 with the
velocity u along the plate. Far away, with one unknown number C,
    P = -sqrt(R) sin(A/2) - C sin(A/2)/sqrt(R) - cos(A)/(8 R) - …,   surface at 1/(2 sqrt(X)) + 0.3 C X^(-3/2), P = 1/(8 X) + 0.15 C X^(-2).
The term with C is that of an edge further out by 2 C d: seen from afar the plate is wider by
    D = 2 C d = 2^(4/3) C a (V t/a)^(2/3)   at both edges,
and its impulse is that of contact with the half width a + D (next terms are of the order V t/a). The flow is followed in T until it
rests, by boundary elements with linear functions. Surface points move with the water and are spread anew at every step. The jet
is cut at the height Y, where the water passes with the velocity of its two surfaces."""
import argparse

try:
    import numpy
except ImportError:
    raise SystemExit("plate_edge.py: needs numpy\n  fix: install the package python3-numpy, and call the system's python3") from None

import linear_plate

CUT = 3  # elements across the jet


def along(points):
    """Length along a curve at each of its points."""
    return numpy.concatenate([[0.0], numpy.cumsum(numpy.hypot(*numpy.diff(points, axis=0).T))])


class Spline:
    """Cubic spline through the rows of `values` at the places s, third derivatives continuous beside both ends."""

    def __init__(self, s, values):
        self.s, self.values, self.h = s, values, numpy.diff(s)
        n, h = len(s), self.h
        matrix, right, inner = numpy.zeros((n, n)), numpy.zeros(values.shape), numpy.arange(1, n - 1)
        matrix[inner, inner - 1], matrix[inner, inner], matrix[inner, inner + 1] = h[:-1], 2 * (h[:-1] + h[1:]), h[1:]
        right[1:-1] = 6 * numpy.diff(numpy.diff(values, axis=0) / h[:, None], axis=0)
        matrix[0, :3], matrix[-1, -3:] = (h[1], -h[0] - h[1], h[0]), (h[-1], -h[-2] - h[-1], h[-2])
        self.bend = numpy.linalg.solve(matrix, right)

    def _pieces(self, x):
        k = numpy.clip(numpy.searchsorted(self.s, x) - 1, 0, len(self.h) - 1)
        return k, self.h[k][:, None], (x - self.s[k])[:, None]

    def at(self, x):
        k, h, t = self._pieces(x)
        u, bend, value = h - t, self.bend, self.values
        return (bend[k] * u**3 + bend[k + 1] * t**3) / (6 * h) + (value[k] / h - bend[k] * h / 6) * u + (value[k + 1] / h - bend[k + 1] * h / 6) * t

    def slope(self, x):
        k, h, t = self._pieces(x)
        u, bend, value = h - t, self.bend, self.values
        return (bend[k + 1] * t**2 - bend[k] * u**2) / (2 * h) + (value[k + 1] - value[k]) / h - (bend[k + 1] - bend[k]) * h / 6


def influences(points, first, last):
    """Integrals of d(ln r)/dn and of ln r over straight elements first-last, times the linear functions of both ends."""
    edge = last - first
    length = numpy.hypot(edge[:, 0], edge[:, 1])
    tangent = edge / length[:, None]
    normal = numpy.stack([tangent[:, 1], -tangent[:, 0]], 1)  # out of the water, which lies to the left
    from_first = points[:, None, :] - first[None]
    s, d = (from_first * tangent).sum(-1), (from_first * normal).sum(-1)
    d[numpy.abs(d) < 1e-11] = 0
    u, v, apart = -s, length - s, numpy.where(d == 0, 1.0, d)
    r1, r2 = numpy.maximum(numpy.hypot(u, d), 1e-300), numpy.maximum(numpy.hypot(v, d), 1e-300)
    angle = numpy.where(d == 0, 0.0, numpy.arctan(v / apart) - numpy.arctan(u / apart))
    ln1, ln2 = numpy.log(r1), numpy.log(r2)
    whole = v * ln2 - u * ln1 - length + d * angle
    dipole_last = (-d * (ln2 - ln1) - s * angle) / length
    source_last = (0.5 * (r2**2 * ln2 - r1**2 * ln1) - 0.25 * (r2**2 - r1**2) + s * whole) / length
    return -angle - dipole_last, dipole_last, whole - source_last, source_last


class Edge:
    """The flow in X. `outer`: surface from afar to the jet's cut; `inner`: from the cut to the plate's edge; potentials beside."""

    def __init__(self, spacing, far, cut):
        self.spacing, self.far, self.top, self.c = spacing, far, cut, 0.5
        y = numpy.linspace(0.5 / numpy.sqrt(far - 0.65), cut, 4000)
        turn = numpy.linspace(0, numpy.pi / 2, 200)
        bow = numpy.stack([0.5 * numpy.sin(turn), 0.5 - 0.5 * numpy.cos(turn)], 1)
        rise = numpy.linspace(0.5, cut, 200)[1:]
        self.outer = self._spread(numpy.stack([0.65 + 0.25 / y**2, y], 1))
        self.inner = self._spread(numpy.vstack([bow, numpy.stack([0.5 + 0 * rise, rise], 1)])[::-1])
        self._first_potentials()
        x = [0.0]
        while x[-1] > -far:
            x.append(x[-1] - self._size(numpy.array([[x[-1], 0.0]]))[0])
        self.plate = numpy.stack([numpy.array(x) * far / abs(x[-1]), 0 * numpy.array(x)], 1)
        self.mean, self.half_gap = numpy.array([0.5, 1.4]), numpy.zeros(2)  # of the velocities of the jet's two surfaces at the cut

    def _size(self, points):
        r = numpy.hypot(points[:, 0], points[:, 1])
        return self.spacing * numpy.minimum(0.35 + 1.3 * r, 1) + 0.12 * numpy.maximum(r - 2, 0)

    def _spread(self, rows):
        """The curve (and further columns) at points as far apart as `_size` says."""
        s, size = along(rows[:, :2]), self._size(rows)
        count = numpy.concatenate([[0.0], numpy.cumsum(numpy.diff(s) * 0.5 * (1 / size[1:] + 1 / size[:-1]))])
        new = Spline(s, rows).at(numpy.interp(numpy.linspace(0, count[-1], max(int(round(count[-1])), 6) + 1), count, s))
        new[[0, -1]] = rows[[0, -1]]
        return new

    def _first_potentials(self):
        """Of a flow at rest with this surface: S = P - R^2/3 has |dS/ds|^2 = 2/9 R^2 - 2/3 S. It is only a start."""
        def march(points, value, sign):
            values = [value]
            for here, there in zip(points[:-1], points[1:]):
                for part in (numpy.arange(40) + 0.5) / 40:
                    square = ((here + (there - here) * part) ** 2).sum()
                    value += sign * numpy.sqrt(max(2 / 9 * square - 2 / 3 * value, 0)) * numpy.hypot(*(there - here)) / 40
                values.append(value)
            return numpy.array(values)
        outer = march(self.outer, 1 / (8 * self.far) - (self.outer[0] ** 2).sum() / 3, 1)
        inner = march(self.inner, outer[-1], -1)
        self.outer_p, self.inner_p = outer + (self.outer**2).sum(1) / 3, inner + (self.inner**2).sum(1) / 3

    def velocities(self):
        """Of the water at the points of both surfaces; `edge_speed` at the plate's edge; C."""
        cut = numpy.linspace(self.outer[-1], self.inner[0], CUT + 1)
        turn = numpy.linspace(-numpy.pi, numpy.arctan2(*self.outer[0, ::-1]), 41)
        rim = numpy.stack([numpy.cos(turn), numpy.sin(turn)], 1) * numpy.linspace(self.far, numpy.hypot(*self.outer[0]), 41)[:, None]
        rim[0], rim[-1] = self.plate[-1], self.outer[0]
        parts = [self.outer, cut, self.inner, self.plate, rim]
        start = numpy.cumsum([0] + [len(part) for part in parts])
        outer, across, inner, plate, afar = (slice(start[k], start[k + 1]) for k in range(5))
        one = numpy.concatenate([numpy.arange(start[k], start[k + 1] - 1) for k in range(5)])
        dipoles, sources = numpy.zeros((2, start[-1], start[-1]))
        pieces = influences(numpy.vstack(parts), numpy.vstack([p[:-1] for p in parts]), numpy.vstack([p[1:] for p in parts]))
        for matrix, of_first, of_last in ((dipoles, *pieces[:2]), (sources, *pieces[2:])):
            matrix[:, one] += of_first
            matrix[:, one + 1] += of_last
        dipoles[numpy.diag_indices(start[-1])] -= dipoles.sum(1)
        # Unknown: dP/dn on the surfaces, P elsewhere. Afar all but the known terms falls as 1/sqrt(R).
        r, a = numpy.hypot(*rim.T), -turn
        known = -numpy.sqrt(r) * numpy.sin(a / 2) - numpy.cos(a) / (8 * r)
        known_slope = -0.5 / numpy.sqrt(r) * numpy.sin(a / 2) + numpy.cos(a) / (8 * r**2)
        side = (cut[-1] - cut[0]) / numpy.hypot(*(cut[-1] - cut[0]))
        through = numpy.linspace(self.mean - self.half_gap, self.mean + self.half_gap, CUT + 1) @ numpy.array([side[1], -side[0]])
        matrix = dipoles.copy()
        matrix[:, outer], matrix[:, inner], matrix[:, afar] = -sources[:, outer], -sources[:, inner], dipoles[:, afar] + sources[:, afar] * (0.5 / r)
        right = (sources[:, across] @ through + sources[:, afar] @ (known_slope + 0.5 / r * known)
                 - dipoles[:, outer] @ self.outer_p - dipoles[:, inner] @ self.inner_p)
        for row, value in ((start[1], self.outer_p[-1]), (start[2] - 1, self.inner_p[0]), (start[3], self.inner_p[-1]), (start[5] - 1, self.outer_p[0])):
            matrix[row], right[row] = 0, value
            matrix[row, row] = 1
        matrix[start[4]], right[start[4]] = 0, 0
        matrix[start[4], start[4]], matrix[start[4], start[4] - 1] = 1, -1
        found = numpy.linalg.solve(matrix, right)
        share = numpy.sin(a / 2)[2:30]
        self.c = -((found[afar] - known) * numpy.sqrt(r))[2:30] @ share / (share @ share)
        return self._at_surfaces(found[outer], found[inner], found[plate])

    def _at_surfaces(self, out_of_outer, out_of_inner, on_plate):
        result = []
        for points, potential, out in ((self.outer, self.outer_p, out_of_outer), (self.inner, self.inner_p, out_of_inner)):
            s = along(points)
            slope = Spline(s, numpy.column_stack([points, potential])).slope(s)
            length = numpy.hypot(slope[:, 0], slope[:, 1])
            tangent = slope[:, :2] / length[:, None]
            result.append(tangent * (slope[:, 2] / length)[:, None] + numpy.stack([tangent[:, 1], -tangent[:, 0]], 1) * out[:, None])
        # At the cut a mean of three points and of some steps: its corners would feed on their own noise.
        self.mean = 0.9 * self.mean + 0.05 * (result[0][-4:-1].mean(0) + result[1][1:4].mean(0))
        self.half_gap = 0.9 * self.half_gap + 0.05 * (result[1][1:4].mean(0) - result[0][-4:-1].mean(0))
        result[0][-1], result[1][0] = self.mean - self.half_gap, self.mean + self.half_gap
        one, two = -self.plate[1:3, 0]
        self.edge_speed = (on_plate[0] * (one + two) / (one * two) - on_plate[1] * two / (one * (two - one))
                           + on_plate[2] * one / (two * (two - one)))
        return result

    def _rates(self):
        outer, inner = self.velocities()
        move = [outer - 2 / 3 * self.outer, inner - 2 / 3 * self.inner]
        gain = [0.5 * (v**2).sum(1) - p / 3 for v, p in ((outer, self.outer_p), (inner, self.inner_p))]
        move[0][0], move[1][-1], gain[0][0] = 0, 0, 0
        gain[1][-1] = -self.inner_p[-1] / 3 - 0.5 * self.edge_speed**2
        return move[0], gain[0], move[1], gain[1]

    def step(self, length):
        """Heun's step of T, then new points."""
        before = self.outer, self.outer_p, self.inner, self.inner_p
        first = self._rates()
        self.outer, self.outer_p, self.inner, self.inner_p = (b + length * f for b, f in zip(before, first))
        second = self._rates()
        outer, outer_p, inner, inner_p = (b + length / 2 * (f + g) for b, f, g in zip(before, first, second))
        far = self.far
        outer[0], outer_p[0] = (far, 0.5 / numpy.sqrt(far) + 0.3 * self.c / far**1.5), 1 / (8 * far) + 0.15 * self.c / far**2
        outer = self._smooth(self._spread(self._shorten(numpy.column_stack([outer, outer_p]))))
        inner = self._smooth(self._spread(self._shorten(numpy.column_stack([inner, inner_p])[::-1])[::-1]))
        self.outer, self.outer_p, self.inner, self.inner_p = outer[:, :2], outer[:, 2], inner[:, :2], inner[:, 2]

    def _shorten(self, rows):
        """The curve up to where it first passes the height of the cut."""
        above = rows[:, 1] > self.top
        if not above.any():
            return rows
        k, s = int(numpy.argmax(above)), along(rows[:, :2])
        spline, low, high = Spline(s, rows), s[k - 1], s[k]
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (low, middle) if spline.at(numpy.array([middle]))[0, 1] > self.top else (middle, high)
        return numpy.vstack([rows[:k], spline.at(numpy.array([low]))])

    def _smooth(self, rows):
        """Three tenths of the mean over five points that leaves cubics as they are."""
        mean = rows.copy()
        mean[2:-2] = (-rows[:-4] + 4 * rows[1:-3] + 10 * rows[2:-2] + 4 * rows[3:-1] - rows[4:]) / 16
        return 0.7 * rows + 0.3 * mean


def follow(spacing, far, cut, until):
    edge = Edge(spacing, far, cut)
    length = 0.05 * spacing
    edge.velocities()
    for _ in range(round(until / length)):
        edge.step(length)
    return edge


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spacing", type=float, action="append", metavar="D")
    parser.add_argument("--far", type=float, default=10.0, metavar="R")
    parser.add_argument("--cut", type=float, default=1.2, metavar="Y")
    parser.add_argument("--until", type=float, default=6.0, metavar="TAU")
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.spacing, arguments.until = [0.113], 3.0
    print("spacing   far   cut   until   C        speed at the edge")
    for spacing in arguments.spacing or [0.113, 0.08, 0.056]:
        edge = follow(spacing, arguments.far, arguments.cut, arguments.until)
        print(f"{spacing:7g}  {arguments.far:4g}  {arguments.cut:4g}  {arguments.until:6g}   {edge.c:.4f}   {edge.edge_speed:.4f}", flush=True)
    wider = 2 ** (4 / 3) * edge.c
    print(f"\nEach edge acts {wider:.3f} a (V t/a)^(2/3) further out")
    for name, bounded in (("deep and wide water", False), ("the tank of plate_entry", True)):
        contact, growth = linear_plate.contact_growth(bounded)
        print(f"{name}: impulse over rho V a (middle) {contact[0]:.4f} + {wider * growth[0]:.3f} (V t/a)^(2/3), "
              f"over rho V a^2 (plate) {contact[1]:.4f} + {wider * growth[1]:.3f} (V t/a)^(2/3)")
    share = (linear_plate.SPEED * 300e-6 / linear_plate.HALF) ** (2 / 3)
    print(f"plate_entry, 6.26 m/s, 300 us: {contact[0] + wider * growth[0] * share:.3f} rho V a, "
          f"{contact[1] + wider * growth[1] * share:.3f} rho V a^2")


if __name__ == "__main__":
    main()
