"""A square of four points in a preCICE configuration, and three windows of its load."""
import numpy as np

CONFIG = """<?xml version="1.0"?>
<precice-configuration>
  <data:vector name="Force"/>
  <data:vector name="Displacement"/>
  <data:scalar name="Gap"/>
  <mesh name="Solid-Mesh" dimensions="2"> <use-data name="Force"/> <use-data name="Displacement"/> <use-data name="Gap"/> </mesh>
  <mesh name="Fluid-Mesh" dimensions="2"> <use-data name="Force"/> <use-data name="Displacement"/> </mesh>
  <participant name="Fluid"> <provide-mesh name="Fluid-Mesh"/> </participant>
  <participant name="Solid">
    <provide-mesh name="Solid-Mesh"/>
    <receive-mesh name="Fluid-Mesh" from="Fluid"/>
    <read-data name="Force" mesh="Solid-Mesh"/>
    <write-data name="Displacement" mesh="Solid-Mesh"/>
    <mapping:nearest-neighbor direction="read" from="Fluid-Mesh" to="Solid-Mesh" constraint="conservative"/>
  </participant>
  <coupling-scheme:serial-implicit>
    <participants first="Fluid" second="Solid"/>
    <exchange data="Displacement" mesh="Solid-Mesh" from="Solid" to="Fluid"/>
    <exchange data="Force" mesh="Solid-Mesh" from="Fluid" to="Solid"/>
  </coupling-scheme:serial-implicit>
</precice-configuration>
"""
TWO_MESHES = CONFIG.replace('  <participant name="Fluid">', '  <mesh name="Solid-Tip" dimensions="2"> <use-data name="Displacement"/> </mesh>\n  <participant name="Fluid">').replace(
    '<provide-mesh name="Solid-Mesh"/>', '<provide-mesh name="Solid-Mesh"/> <provide-mesh name="Solid-Tip"/>').replace(
    '<write-data name="Displacement" mesh="Solid-Mesh"/>', '<write-data name="Displacement" mesh="Solid-Tip"/>')
# Strake does not know the quantity that is written; it keeps its sum.
PULL = CONFIG.replace('<write-data name="Displacement"', '<write-data name="Pull"').replace('<use-data name="Gap"/>', '<use-data name="Pull"/>').replace(
    '<data:scalar name="Gap"/>', '<data:vector name="Pull"/>').replace(
    '"conservative"/>', '"conservative"/> <mapping:nearest-neighbor direction="write" from="Solid-Mesh" to="Fluid-Mesh" constraint="conservative"/>')
MESH, READ, WRITE = "Solid-Mesh", "Force", "Displacement"
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
LOAD = np.array([[0, 1.0, 0]] * 4)
WINDOWS = [(0, "NOTHING", 1.0), (0, "REWIND", 2.0), (1, "COMMIT", 5.0)]  # begin [s], what becomes of the one before, load
