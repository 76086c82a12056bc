"""Wedge at constant speed into still water without gravity: the exact self-similar flow.

usage: tests/benchmark/similarity.py [DEADRISE]… (default: 4 5 7.5 10 15 20 30 40 45 60 degrees; needs numpy)

Prints K = F/(rho V^3 t), the largest Cp = p/(rho V^2/2) and its height over the still level, Cp at the apex, the jet's tip
(heights in V t) and the contact angle. The same figures of Dobrovol'skaya 1969 stand beside, as Zhao & Faltinsen 1993 tabulate them.

All lengths in V t, velocities in V, complex velocity W'. On walls W'' dz^2 is real, on the free surface (constant pressure,
so acceleration is normal to it) it is imaginary: dh = sqrt(W'') dz maps the water on a right isosceles triangle (Wagner),
    h' = C [l (1 - l)]^(-3/4),   l in the upper half plane: l < 0 the axis, 0 < l < 1 free surface from afar to the jet's tip,
                                                     l > 1 the face, from the tip to the apex at infinity.
The direction of z' is known on axis and face and turns by -pi f dl on the free surface, hence
    |z'| = B g,   g = |l|^(-3/2) |l - 1|^(c/pi - 1) exp int f(m) ln|l - m| dm,   int f = 1 - (deadrise + c)/pi, c contact angle.
Water moves along the surface at the arc length S from the tip in similarity coordinates, and turns with it:
    pi f = k [l (1 - l)]^(-3/2) / (g S),   S = int_l^1 g dm,   k = C^2/B^2.
The water stays at the face's end: int_face |h'|^2/|z'| = int_face |z'| gives k, velocity V at the apex gives B. Solved by
Newton in ln f over even steps of ln(l/(1 - l)), where all decays exponentially; ends are powers, taken exactly."""
import sys

try:
    import numpy
except ImportError:
    raise SystemExit("similarity.py: needs numpy\n  fix: install the package python3-numpy, and call the system's python3") from None

# deadrise [deg]: largest Cp, its z/(V t), F/(rho V^3 t); Zhao & Faltinsen 1993 (from memory)
TABULATED = {4: (503.030, 0.5695, 1503.638), 7.5: (140.587, 0.5623, 399.816), 10: (77.847, 0.5556, 213.980),
             15: (33.271, 0.5361, 85.522), 20: (17.774, 0.5087, 42.485), 30: (6.927, 0.4243, 14.139), 40: (3.266, 0.2866, 5.477)}


def integrals_from_right(h, n):
    """The matrix that takes values at n even places to their integrals from each place to the last, cubics exactly."""
    piece = numpy.zeros((n - 1, n))
    for k in range(1, n - 2):
        piece[k, k - 1:k + 3] = numpy.array([-1, 13, 13, -1]) * h / 24
    for k in (0, n - 2):
        piece[k, k:k + 2] = h / 2
    return numpy.vstack([numpy.cumsum(piece[::-1], axis=0)[::-1], numpy.zeros(n)])


class SimilarFlow:
    """The flow about a wedge. Members: `force`, `largest` (Cp and its height), `apex` Cp, `tip` height, `contact` [rad], and the
    curve `height`, `pressure` (Cp) along the face from the tip to the apex."""

    def __init__(self, deadrise, h=0.1):
        start = None
        # Newton starts from the flow of a neighbouring angle, the first from a guess that does at 60 degrees.
        count = max(1, round(abs(numpy.log(deadrise / 60.0)) / 0.25))
        for angle in 60.0 * (deadrise / 60.0) ** (numpy.arange(count + 1) / count):
            start = self._solve(numpy.radians(angle), h, start)
        self._evaluate(numpy.radians(deadrise), h, start)

    def _grid(self, h):
        x = numpy.arange(-20, 40 + h / 2, h)                                   # ln(l/(1 - l)) on the free surface
        low, high = -numpy.logaddexp(0, -x), -numpy.logaddexp(0, x)            # ln l, ln(1 - l)
        away, half = numpy.abs(x[:, None] - x[None, :]), 0.5 * (low + high)
        with numpy.errstate(divide="ignore"):
            near = away / 2 + numpy.log1p(-numpy.exp(-away)) + half[:, None] + half[None, :]  # ln|l - m|
        # The trapezoidal rule over ln|x| without x = 0 lacks h ln(h/2 pi).
        numpy.fill_diagonal(near, numpy.log(h / (2 * numpy.pi)) + 2 * half)
        y = numpy.arange(-45, 60 + h / 2, h)                                   # ln(l - 1) on the face, ln(-l) on the axis
        return x, low, high, h * near, y, numpy.logaddexp(0, y)

    def _face(self, deadrise, contact, f, h):
        """|z'|/B and |h'|^2/(B k |z'|) per step of y, and the powers of their decay to tip and apex."""
        _, _, high, _, y, sum_y = self._grid(h)
        reach = h * numpy.logaddexp(y[:, None], high[None, :])
        ln_g = -1.5 * sum_y + (contact / numpy.pi - 1) * y + reach @ f
        length, speed = numpy.exp(ln_g + y), numpy.exp(-1.5 * sum_y - 0.5 * y - ln_g)
        powers = (contact / numpy.pi, 0.5 + deadrise / numpy.pi), (0.5 - contact / numpy.pi, 0.5 - deadrise / numpy.pi)
        return y, reach, length, speed, powers

    def _solve(self, deadrise, h, start):
        x, low, high, near, y, _ = self._grid(h)
        n, right = len(x), integrals_from_right(h, len(x))
        weight = numpy.full(len(y), h)
        weight[[0, -1]] = h / 2
        if start is None:
            contact, ln_k = 0.11, 0.0
            f = numpy.exp(1.5 * low + 0.45 * high)
            ln_f = numpy.log(f * (1 - (deadrise + contact) / numpy.pi) / (f.sum() * h))
        else:
            ln_f, contact, ln_k = start
        for _ in range(60):
            f = numpy.exp(ln_f)
            ln_g = -1.5 * low + (contact / numpy.pi - 1) * high + near @ f
            g = numpy.exp(ln_g + low + high)
            tail = g[-1] * numpy.pi / contact
            arc = right @ g + tail
            _, reach, length, speed, ((p0, p1), (q0, q1)) = self._face(deadrise, contact, f, h)
            whole = weight @ length + length[0] / p0 + length[-1] / p1
            gained = weight @ speed + speed[0] / q0 + speed[-1] / q1
            residual = numpy.concatenate([ln_f + 0.5 * (low + high) + ln_g + numpy.log(arc) - ln_k + numpy.log(numpy.pi),
                                          [numpy.pi * (1 - h * f.sum()) - deadrise - contact],
                                          [ln_k - numpy.log(whole) + numpy.log(gained)]])
            # Derivatives with ln f, ln(contact), ln k.
            jacobian = numpy.zeros((n + 2, n + 2))
            by_f, by_c = near * f, high / numpy.pi * contact
            jacobian[:n, :n] = numpy.eye(n) + by_f + (right @ (g[:, None] * by_f) + tail * by_f[-1]) / arc[:, None]
            jacobian[:n, n] = by_c + (right @ (g * by_c) + tail * (by_c[-1] - 1)) / arc
            jacobian[:n, n + 1] = -1
            jacobian[n, :n], jacobian[n, n] = -numpy.pi * h * f, -contact
            by_f, by_c = reach * f, y / numpy.pi * contact
            sums = lambda a, b0, b1, by: (weight * a) @ by + a[0] / b0 * by[0] + a[-1] / b1 * by[-1]
            jacobian[n + 1, :n] = -sums(length, p0, p1, by_f) / whole - sums(speed, q0, q1, by_f) / gained
            jacobian[n + 1, n] = (-(sums(length, p0, p1, by_c) - length[0] / p0) / whole
                                  - (sums(speed, q0, q1, by_c) - speed[0] / q0**2 * contact / numpy.pi) / gained)
            jacobian[n + 1, n + 1] = 1
            change = numpy.linalg.solve(jacobian, -residual)
            counts = numpy.abs(change[:n])[f > 1e-6 * f.max()]
            share = min(1.0, 0.7 / max(abs(change[n]), counts.max()))
            ln_f, contact, ln_k = ln_f + share * change[:n], contact * numpy.exp(share * change[n]), ln_k + share * change[n + 1]
            if share == 1 and numpy.abs(change).max() < 1e-9:
                return ln_f, contact, ln_k
        raise RuntimeError(f"no similarity flow found at {numpy.degrees(deadrise):g} degrees")

    def _evaluate(self, deadrise, h, solved):
        ln_f, contact, ln_k = solved
        f, k = numpy.exp(ln_f), numpy.exp(ln_k)
        _, low, _, _, y, sum_y = self._grid(h)
        # Axis: from rest afar to the wedge's own velocity at the apex, int |h'|^2/|z'| = 1.
        ln_g = -1.5 * y + (contact / numpy.pi - 1) * sum_y + h * numpy.logaddexp(y[:, None], low[None, :]) @ f
        gain = numpy.exp(-0.5 * y - 1.5 * sum_y - ln_g)
        b = 1 / (k * (h * (gain.sum() - 0.5 * (gain[0] + gain[-1])) + gain[0] + gain[-1] / (0.5 - deadrise / numpy.pi)))
        _, _, length, speed, ((p0, p1), (q0, q1)) = self._face(deadrise, contact, f, h)
        length, speed = b * length, b * k * speed
        right = integrals_from_right(h, len(y))
        s = right @ length + length[-1] / p1  # from the apex
        u = right @ speed + speed[-1] / q1    # along the face, over that at the apex
        # Bernoulli along the face: dp = rho (s - u) du. The pressure is zero at the tip, where s - u and its rest are
        # powers.
        ds, du = length[0] / p0, speed[0] / q0
        rises = right @ ((s - u) * speed)
        at_apex = -(rises[0] - ds * du * q0 / (p0 + q0) + 0.5 * du**2)
        self.pressure = 2 * (at_apex + rises)
        self.height = s * numpy.sin(deadrise) - 1
        self.force = numpy.cos(deadrise) * ((right @ (self.pressure * length))[0] + 2 * at_apex * length[-1] / p1)
        at = numpy.argmax(self.pressure)
        self.largest, self.apex = (self.pressure[at], self.height[at]), 2 * at_apex
        self.tip, self.contact = (s[0] + ds) * numpy.sin(deadrise) - 1, contact


if __name__ == "__main__":
    if sys.argv[1:] in (["-h"], ["--help"]):
        sys.exit(print(__doc__))
    print(f"{'deadrise':>8} {'K':>9} {'1993':>9} {'Cp':>8} {'1993':>8} {'z/Vt':>7} {'1993':>7} {'apex':>7} {'tip':>7} {'contact':>9}")
    for angle in [float(word) for word in sys.argv[1:]] or [4, 5, 7.5, 10, 15, 20, 30, 40, 45, 60]:
        flow = SimilarFlow(angle)
        cp, z, force = (f"{v:g}" for v in TABULATED[angle]) if angle in TABULATED else ("", "", "")
        print(f"{angle:8g} {flow.force:9.4f} {force:>9} {flow.largest[0]:8.3f} {cp:>8} {flow.largest[1]:7.4f} {z:>7} "
              f"{flow.apex:7.3f} {flow.tip:7.4f} {numpy.degrees(flow.contact):8.4f}°")
