#!/usr/bin/python3 -B
"""The wall of the elastic tube (tube.py), by the names of preCICE's Python bindings alone. It takes the pressure, and sends the area."""
import pathlib

import numpy as np
import precice
from tube import NODES, POINTS, area_of

MESH = "Wall-Nodes"
participant = precice.Participant("Wall", str(pathlib.Path(__file__).with_name("tube.xml")), 0, 1)
ids = participant.set_mesh_vertices(MESH, POINTS)
if participant.requires_initial_data():
    participant.write_data(MESH, "CrossSection", ids, np.ones(NODES))
participant.initialize()
while participant.is_coupling_ongoing():
    participant.requires_writing_checkpoint()  # nothing changes in time
    dt = participant.get_max_time_step_size()
    participant.write_data(MESH, "CrossSection", ids, area_of(participant.read_data(MESH, "Pressure", ids, dt)))
    participant.advance(dt)
    participant.requires_reading_checkpoint()
participant.finalize()
