"""A field in time inside one window, from its value at the begin and its samples."""
import numpy as np

from .errors import Error

SAME = 1e-9  # two times are one within this part of a window: sums of time steps miss its end by round-off


class Waveform:
    """Values of one data that is read: arrays points × components. Between samples they follow a polynomial of `degree`."""

    def __init__(self, begin, degree):
        self.begin, self.degree = begin, degree  # value at the begin of the window
        self.times, self.values, self.dt = [], [], 0.0

    def take(self, t, dt, samples):
        """Takes a new result for the window [t, t + dt]: pairs of time and array, ascending. The last is of its end."""
        times, values = [time for time, _ in samples], [value for _, value in samples]
        times[-1] = t + dt
        if times[0] > t + SAME * dt:
            times, values = [t, *times], [self.begin, *values]
        self.times, self.values, self.dt = times, values, dt

    def accept(self):
        """The window is committed: its last value is the begin of the next."""
        if self.values:
            self.begin = self.values[-1]

    def at(self, time):
        """The value at a time [s] of the window: exact at samples, between them by the samples on either side."""
        times, last = self.times, len(self.times) - 1
        next_one = next((k for k, other in enumerate(times) if other > time + SAME * self.dt), last)
        if last == 0 or time >= times[-1] - SAME * self.dt:
            return self.values[-1]
        if self.degree == 0:  # constant up to each sample
            return self.values[next(k for k in range(1, last + 1) if times[k] >= time - SAME * self.dt)]
        count = min(self.degree + 1, last + 1)
        first = min(max(0, next_one - (count + 1) // 2), last + 1 - count)
        return polynomial(np.array(times[first:first + count]), self.values[first:first + count], time)


def polynomial(times, values, time):
    """Lagrange's polynomial through all samples, at a time."""
    total = 0
    for k, value in enumerate(values):
        others = np.delete(times, k)
        total = total + np.prod((time - others) / (times[k] - others)) * value
    return total


def check_time(function, relative, left, window):
    """Error where a time relative to now is not within what is left of the window."""
    if not -SAME * window <= relative <= left + SAME * window:
        raise Error(f"{function}(): relative_read_time = {relative:g} s is not between 0 and {left:g} s, the end of the window")
