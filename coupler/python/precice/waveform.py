"""A field in time inside one window, from its value at the begin and its samples."""
import numpy as np

from .errors import Error

SAME = 1e-10  # two times are one within this part of a window


class Waveform:
    """Values of one data that is read: arrays points × components. Between samples they follow a spline of `degree`."""

    def __init__(self, begin, degree):
        self.begin, self.degree = begin, degree  # value at the begin of the window
        self.times, self.values = [], []

    def take(self, t, dt, samples):
        """A new result for the window [t, t + dt]: pairs of time and array, ascending, the last at its end."""
        before = [value for time, value in samples if time <= t + SAME * dt]
        inside = [(time, value) for time, value in samples if time > t + SAME * dt]
        if before:
            self.begin = before[-1]
        self.times = [t, *(time for time, _ in inside)] if inside else [t, t + dt]
        self.values = [self.begin, *(value for _, value in inside)] if inside else [self.begin, self.begin]
        self.dt = dt

    def accept(self):
        """The window is committed: its last value is the begin of the next."""
        if self.values:
            self.begin = self.values[-1]

    def at(self, time):
        """The value at a time [s] of the window."""
        if self.degree == 0:
            later = [k for k, other in enumerate(self.times) if other >= time - SAME * self.dt and k > 0]
            return self.values[later[0] if later else -1]
        weights = spline_weights(np.array(self.times), min(self.degree, len(self.times) - 1), time)
        return sum(w * value for w, value in zip(weights, self.values) if w != 0)


def spline_weights(times, degree, time):
    """Share of each sample in the interpolating spline's value at a time; the knots are means of `degree` times."""
    exact = np.flatnonzero(np.abs(times - time) <= SAME * (times[-1] - times[0]))
    if exact.size:
        return np.eye(len(times))[exact[0]]
    scaled, x = (times - times[0]) / (times[-1] - times[0]), (time - times[0]) / (times[-1] - times[0])
    inner = [scaled[k:k + degree].mean() for k in range(1, len(times) - degree)]
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    rows = np.array([basis(knots, degree, s) for s in scaled])
    return np.linalg.solve(rows.T, basis(knots, degree, x))


def basis(knots, degree, x):
    """Values of all B-splines at x in [0, 1], by the recursion of Cox and de Boor."""
    n = len(knots) - degree - 1
    span = n - 1 if x >= 1 else int(np.searchsorted(knots, x, side="right")) - 1
    values = np.zeros(len(knots) - 1)
    values[span] = 1
    for d in range(1, degree + 1):
        for k in range(len(values) - d):
            left, right = knots[k + d] - knots[k], knots[k + d + 1] - knots[k + 1]
            values[k] = ((x - knots[k]) / left * values[k] if left > 0 else 0) + (
                (knots[k + d + 1] - x) / right * values[k + 1] if right > 0 else 0)
    return values[:n]


def check_time(function, relative, left, window):
    """Error where a time relative to now is not within what is left of the window."""
    if not -SAME * window <= relative <= left + SAME * window:
        raise Error(f"{function}(): relative_read_time = {relative:g} s is not between 0 and {left:g} s, the end of the window")
