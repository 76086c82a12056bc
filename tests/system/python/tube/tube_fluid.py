#!/usr/bin/python3 -B
"""The flow in the elastic tube (tube.py), by the names of preCICE's Python bindings alone. It takes the area, and sends the pressure."""
import pathlib

import numpy as np
import precice
from tube import NODES, POINTS, step

MESH = "Fluid-Nodes"
participant = precice.Participant("Fluid", str(pathlib.Path(__file__).with_name("tube.xml")), 0, 1)
ids = participant.set_mesh_vertices(MESH, POINTS)
participant.initialize()
t, before = 0.0, (np.full(NODES, 10.0), np.zeros(NODES), np.ones(NODES))  # u, p, a
saved = t, before
while participant.is_coupling_ongoing():
    if participant.requires_writing_checkpoint():
        saved = t, before
    dt = participant.get_max_time_step_size()
    a = participant.read_data(MESH, "CrossSection", ids, dt)
    u, p = step(before, a, t + dt, dt)
    participant.write_data(MESH, "Pressure", ids, p)
    participant.advance(dt)
    t, before = t + dt, (u, p, a)
    if participant.requires_reading_checkpoint():
        t, before = saved
    else:
        print(f"{t:.2f} {a[NODES // 2]:.7f} {p[NODES // 2]:.4f}", flush=True)
participant.finalize()
