#!/usr/bin/python3 -B
"""A rigid floor on a spring, m y'' + k y = F, written against the names of preCICE's Python bindings alone."""
import pathlib

import numpy as np
import precice

MASS, STIFFNESS, WIDTH, THICKNESS, N = 200.0, 1.0e8, 1.0, 0.05, 21  # kg/m, N/m per metre of depth, m, m, points on a face

participant = precice.Participant("Floor", str(pathlib.Path(__file__).with_name("precice-config.xml")), 0, 1)
mesh = "Floor-Mesh"
x = np.linspace(-WIDTH / 2, WIDTH / 2, N)
outline = [(a, -THICKNESS) for a in x] + [(a, 0) for a in x[::-1]]  # counter-clockwise
ids = participant.set_mesh_vertices(mesh, outline)
if participant.requires_mesh_connectivity_for(mesh):
    participant.set_mesh_edges(mesh, np.stack([ids, np.roll(ids, -1)], 1))
participant.initialize()
y, v = saved = 0.0, 0.0
while participant.is_coupling_ongoing():
    if participant.requires_writing_checkpoint():
        saved = y, v
    dt = participant.get_max_time_step_size()
    force = participant.read_data(mesh, "Force", ids, dt)[:, 1].sum()
    a = STIFFNESS * dt**2 / (4 * MASS)  # the trapezoidal rule, with the mean force over the window
    end = ((1 - a) * v + dt * (force - STIFFNESS * y) / MASS) / (1 + a)
    y, v = y + dt * (v + end) / 2, end
    participant.write_data(mesh, "Displacement", ids, np.tile((0, y), (len(ids), 1)))
    participant.advance(dt)
    if participant.requires_reading_checkpoint():
        y, v = saved
participant.finalize()
