// The wall of the elastic tube (tube.hpp): takes the pressure, sends the area. It has no state.
#include "tube.hpp"

#include <precice/precice.hpp>

#include <algorithm>
#include <string>

/// tube_wall CONFIG [MESH]. MESH: the pressure has a mesh of its own, whose points go backwards.
int main(int argc, char** argv) {
  precice::Participant coupling("Wall", argc > 1 ? argv[1] : "tube.xml", 0, 1);
  const bool two = argc > 2;
  const std::string of_pressure = two ? argv[2] : "Wall-Nodes";
  std::vector<int> ids(tube::nodes), pressure_ids(tube::nodes);
  coupling.setMeshVertices("Wall-Nodes", tube::positions(), ids);
  if (two) coupling.setMeshVertices(of_pressure, tube::positions_backwards(), pressure_ids);
  tube::Values pressure(tube::nodes, 0.0), area(tube::nodes, 1.0);
  if (coupling.requiresInitialData()) coupling.writeData("Wall-Nodes", "CrossSection", ids, area);
  coupling.initialize();
  while (coupling.isCouplingOngoing()) {
    coupling.requiresWritingCheckpoint();
    const double dt = coupling.getMaxTimeStepSize();
    coupling.readData(of_pressure, "Pressure", two ? pressure_ids : ids, dt, pressure);
    if (two) std::reverse(pressure.begin(), pressure.end());
    for (std::size_t i = 0; i < area.size(); ++i) area[i] = tube::area(pressure[i]);
    coupling.writeData("Wall-Nodes", "CrossSection", ids, area);
    coupling.advance(dt);
    coupling.requiresReadingCheckpoint();
  }
  coupling.finalize();
}
