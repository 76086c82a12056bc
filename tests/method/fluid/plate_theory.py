"""The theories that flat plates are held to: tests/benchmark/linear_plate.py and plate_edge.py against limits that are known.

    tests/method/fluid/plate_theory.py ROOT      exits 1 where a figure is off
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "tests" / "benchmark"))
import numpy

import linear_plate
import plate_edge
from held import finish, held

# Contact with deep and wide water: rho V sqrt(a^2 - x^2), exact. A wide, deep tank adds in proportion to (a/L)^2.
middle, plate = linear_plate.contact(linear_plate.Water(16, 10, math.inf, False))
held("deep water, middle", middle, 1, 1e-12)
held("deep water, plate", plate, math.pi / 2, 1e-12)
near = [linear_plate.contact(linear_plate.Water(16, int(2000 * size), math.inf, True, size, size))[1] for size in (2.0, 4.0)]
held("a wide tank's excess falls with its size squared", (near[0] - plate) / (near[1] - plate), 4, 0.03)

# Until sound comes from the edges, a/c = 133.3 us, the middle of a rigid plate carries rho c V; the growth of a wide plate is its area's.
times = numpy.linspace(0, 4e-4, 401)
sums, _, _ = linear_plate.history(linear_plate.Water(32, 1000, linear_plate.SOUND), linear_plate.Rigid(), times, 1e6)
held("rho c V a/c", linear_plate.at(times, sums, 120e-6), linear_plate.SOUND * 120e-6 / linear_plate.HALF, 2e-3)
_, growth = linear_plate.contact_growth(False)
held("growth of the plate's impulse in deep water", growth[1], math.pi, 1e-6)

# The two plates: frequencies of cases/VALIDATION.md, "Strips: deflection and frequencies"; a static load bends both as it should.
beam, body = linear_plate.Beam(6), linear_plate.Body(6, 20)
held("beam, first frequency", beam.frequency[0] / (2 * math.pi), 698.89, 1e-4)
held("beam, third frequency", beam.frequency[1] / (2 * math.pi), 3776.76, 1e-4)
held("body, first frequency", body.frequency[0] / (2 * math.pi), 687.8, 2e-3)
places = linear_plate.HALF * (numpy.arange(4000) + 0.5) / 4000
for name, solid, expected in (("beam", beam, 4.33333e-5), ("body", body, 4.453e-5)):
    load = 1e5 * 2 * linear_plate.HALF * solid.at(places).mean(0)
    held(f"{name} under 1e5 Pa", solid.at(numpy.zeros(1))[0] @ (load / solid.frequency**2), expected, 5e-3)

# First peak of the beam on deep incompressible water: modal theory with exact added mass, 0.2596 mm per m/s, computed apart.
times = numpy.linspace(0, 1e-3, 501)
bent = linear_plate.history(linear_plate.Water(16, 10, math.inf, False), beam, times, 1e6)[2]
held("first peak, beam on deep water", linear_plate.peak(times, bent)[0], 0.2596e-3, 2e-3)
tank = linear_plate.Water(16, 1000, linear_plate.SOUND)
summed = linear_plate.peak(times, linear_plate.history(tank, body, times, 5e5)[2])[0]
cells, coarse = (linear_plate.history_by_cells(n, body, 7e-4) for n in (40, 20))
stepped = 2 * linear_plate.peak(cells[0], cells[3])[0] - linear_plate.peak(coarse[0], coarse[3])[0]
held("first peak in the tank with sound: cells against sums", stepped, summed, 3e-3)

# The flow round the edge rests where its pressure vanishes: P = -3/2 u^2 at the edge. C = 0.559 of fine points.
edge = plate_edge.follow(0.113, 10.0, 1.2, 4.0)
held("edge: potential at rest", edge.inner_p[-1], -1.5 * edge.edge_speed**2, 5e-3)
held("edge: C", edge.c, 0.559, 1e-2)
finish()
