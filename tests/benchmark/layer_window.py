"""A thin layer of water on a light body: how long the coupling window may be where steps resolve sound.

usage: tests/benchmark/layer_window.py [--step S] [--shortest P]
       (default: S = 0.29, P = 1: c dt/l0, and the shortest projection in l0/c; needs numpy)
Prints, for windows T and masses m of the body, the largest factor by which anything grows from one window to the next, over layers
of 1 to 6 rows of particles and springs k. Units: l0 = rho = c = 1, so m is in rho l0 per area. coupler/THEORY.md, section 8.

The layer is a column of rows under a free surface, on fixed particles, stepped as the least-squares scheme does in the plane with
one neighbour on each side: (F33) to (F36), (F40) and (F74) of fluid/THEORY.md. The body is m v' = -k x - (mean pressure of the
window), by the trapezoidal rule, its velocity linear within the window; the iterations of the window have converged."""
import argparse
import math

try:
    import numpy
except ImportError:
    raise SystemExit("layer_window.py: needs numpy\n  fix: install the package python3-numpy, and call the system's python3") from None


class Layer:
    """rows particles at 1/2, 3/2, … over a wall; the state is velocity, pressure and -grad p of each."""

    def __init__(self, rows, dt, shortest):
        self.rows, self.dt, self.projection = rows, dt, max(dt, shortest)
        matrix = numpy.zeros((rows, rows))
        for i in range(rows):
            matrix[i, i] = 1 / (dt * self.projection) + (1 if i > 0 else 0) + (1 if i < rows - 1 else 2)
            if i > 0:
                matrix[i, i - 1] = matrix[i - 1, i] = -1
        self.inverse = numpy.linalg.inv(matrix)
        reach = 2 * dt
        self.share = reach * (1 - math.exp(-1 / reach))  # chi of (F36)

    def velocity_gradient(self, u):
        out = numpy.zeros(self.rows)
        if self.rows > 1:
            out[1:-1] = (u[2:] - u[:-2]) / 2
            out[0], out[-1] = u[1] - u[0], u[-1] - u[-2]
        return out

    def step(self, state, wall):
        """Returns the state after a step with the wall's velocity, and the pressure on the wall."""
        u, p, acceleration = numpy.split(state, 3)
        longer = u - (self.projection - self.dt) * acceleration
        right = p / (self.dt * self.projection) - self.velocity_gradient(longer) / self.projection
        right[0] -= (longer[0] - self.velocity_gradient(longer)[0] / 2 - wall) / self.projection
        p = self.inverse @ right
        slope = self.share * (u[0] - self.velocity_gradient(u)[0] / 2 - wall) / self.dt
        below = numpy.concatenate([[slope], p[1:] - p[:-1]])
        above = numpy.concatenate([p[1:] - p[:-1], [-2 * p[-1]]])
        gradient = (below + above) / 2
        return numpy.concatenate([u - self.dt * gradient, p, -gradient]), p[0] - slope / 2


def growth(layer, steps, mass, spring):
    """The largest factor per window of layer and body together."""
    dt, n = layer.dt, 3 * layer.rows
    window = steps * dt

    def follow(state, velocity, acceleration):
        mean = 0.0
        for k in range(1, steps + 1):
            state, on_wall = layer.step(state, velocity + acceleration * k * dt)
            mean += on_wall / steps
        return state, mean

    answer, load = follow(numpy.zeros(n), 0.0, 1.0)  # of a unit acceleration
    matrix = numpy.zeros((n + 2, n + 2))
    for column, unit in enumerate(numpy.eye(n + 2)):
        v, x = unit[n], unit[n + 1]
        state, free = follow(unit[:n], v, 0.0)
        a = -(free + spring * (x + v * window / 2)) / (mass + spring * window ** 2 / 4 + load)
        matrix[:, column] = [*(state + a * answer), v + a * window, x + v * window + a * window ** 2 / 2]
    return max(abs(numpy.linalg.eigvals(matrix)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--step", type=float, default=0.29)
    parser.add_argument("--shortest", type=float, default=1.0)
    arguments = parser.parse_args()
    if not arguments.step > 0 or not arguments.shortest >= 0:
        parser.error("--step must be positive and --shortest not negative")
    layers = [Layer(rows, arguments.step, arguments.shortest) for rows in range(1, 7)]
    masses = (0.5, 1, 2, 4)
    print("T c/l0   " + "".join(f"m = {mass:<7g}" for mass in masses))
    for steps in (4, 7, 10, 12, 13, 16, 20, 26):
        values = (max(growth(layer, steps, mass, k) for layer in layers for k in (0, 0.3, 3, 100)) for mass in masses)
        print(f"{steps * arguments.step:6.2f}   " + "".join(f"{value:<11.4f}" for value in values))


if __name__ == "__main__":
    main()
