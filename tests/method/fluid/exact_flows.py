"""The exact answers of tests/benchmark/exact_answers.py against limits that are known.

    tests/method/fluid/exact_flows.py ROOT      exits 1 where a figure is off
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "tests" / "benchmark"))
import numpy

import exact_answers
from held import finish, held

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
# In deep water half a circle has the added mass pi/2 rho R^2, half a square 4.754/2 rho b^2 (Newman 1977); the part of the tank falls as 1/side^2.
for name, body, limit in (("circle", exact_answers.half_cylinder(0.2, 0.01), math.pi / 2), ("square", exact_answers.half_box(0.2, 0.2, 0.01), 4.754 / 2)):
    near, far = (exact_answers.heave_operators(body, side, side, 0.02)[2][-1] for side in (3, 6))
    held(f"floating {name}", (4 * far - near) / 3 / 0.2**2, limit, 2e-3)
for name, body, water in (("cylinder", exact_answers.half_cylinder(0.2, 0.01), 20 * math.pi), ("box", exact_answers.half_box(0.2, 0.2, 0.01), 80.0)):
    times, places, added, gain = exact_answers.heave(1.05, body, 1.5, 0.6, 0.02, 2e-3, 1.0)
    held(f"water that a floating {name} pushes up", gain, 1, 2e-3)
    held(f"first acceleration of the {name}", 2 * places[5] / times[5] ** 2, -0.05 * 9.81 / (1.05 + added / water), 5e-3)

# A wall without water has the frequency of a cantilever. Bent by rho g (H - y) it has rho g H^5/(30 EI) at the level.
dry, wet, top = exact_answers.wet_wall(0.5, 0.5, 0.5, 2e4, 40.0, 8, 80)
held("dry wall", dry[0], 1.8751041**2 / (2 * math.pi * 0.5**2) * math.sqrt(2e4 / 40.0), 1e-6)
held("wall at rest", top, 9810 * 0.5**5 / (30 * 2e4), 1e-6)
# In a narrow tank the water moves along the wall alone: w = (y/H)^2 has the added mass rho H^3/(63 length).
dry, wet, top = exact_answers.wet_wall(0.5, 0.5, 1e-3, 2e4, 40.0, 1, 400)
held("wall of a narrow tank", wet[0], math.sqrt(4 * 2e4 / 0.5**3 / (40.0 * 0.5 / 5 + 1000 * 0.5**3 / (63 * 1e-3))) / (2 * math.pi), 1e-3)
finish()
