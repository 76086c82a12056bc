"""The exact answers of tests/benchmark/exact_answers.py against limits that are known.

    tests/method/fluid/exact_flows.py ROOT      exits 1 where a figure is off
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "tests" / "benchmark"))
import numpy

import exact_answers

wrong = []


def held(name, value, expected, tolerance):
    fits = abs(value / expected - 1) <= tolerance
    print(f"{'pass' if fits else 'FAIL'}  {name}: {value:.6g}, expected {expected:.6g} within {100 * tolerance:g} %")
    if not fits:
        wrong.append(name)


# A plate at contact: the classical added mass of this tank, 64.94 kg/m. A heavy plate keeps its speed.
held("plate at contact", exact_answers.plate_speed(62.4, 1.0, [0.0])[0], 62.4 / (62.4 + 64.94), 1e-4)
held("heavy plate after 300 us", exact_answers.plate_speed(1e9, 1.0, [3e-4])[0], 1, 1e-6)

# A small cylinder far from everything has the added mass of the water in its place; near the surface (p = 0) less, by 1 - R^2/2d^2.
held("cylinder without bounds", exact_answers.added_mass(0.02, 0.8, 0.8, 0.4, 80), 1, 3e-3)
held("cylinder under a surface", exact_answers.added_mass(0.1, 4.0, 4.0, 0.5, 80), 1 - 0.1**2 / (2 * 0.5**2), 3e-3)

# A small standing wave has the linear period; one of 0.03 m keeps its energy.
flow = exact_answers.StandingWave(1e-4, 0.5, 8)
times, near, _ = flow.follow(4e-3, 4.2)
held("small standing wave", exact_answers.period(times, near), 2 * math.pi / math.sqrt(9.81 * 2 * math.pi * math.tanh(math.pi)), 2e-5)
flow = exact_answers.StandingWave(0.03, 0.5, 12)
before = flow.energy()
held("energy of a wave at rest", before, 9.81 * 0.03**2 / 8, 1e-9)
times, near, _ = flow.follow(4e-3, 4.2)
held("energy of the wave at the end", flow.energy(), before, 1e-5)
held("period at 0.03 m", exact_answers.period(times, near), 0.8034, 1e-4)

# The drop keeps its area and its energy, A^2 (a^2 + b^2).
state = numpy.array([1.0, 1.0, 1.0])
for _ in range(1000):
    state = exact_answers.runge_kutta(exact_answers.drop_rates, state, 1e-3)
held("area of the drop", state[0] * state[1], 1, 1e-9)
held("energy of the drop", state[2] ** 2 * (state[0] ** 2 + state[1] ** 2), 2, 1e-9)
sys.exit(bool(wrong))
