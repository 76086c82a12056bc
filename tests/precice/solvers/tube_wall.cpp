// The wall of the elastic tube (tube.hpp): takes the pressure, sends the area. It has no state.
#include "tube.hpp"

#include <precice/precice.hpp>

int main(int argc, char** argv) {
  precice::Participant coupling("Wall", argc > 1 ? argv[1] : "tube.xml", 0, 1);
  std::vector<int> ids(tube::nodes);
  coupling.setMeshVertices("Wall-Nodes", tube::positions(), ids);
  tube::Values pressure(tube::nodes, 0.0), area(tube::nodes, 1.0);
  if (coupling.requiresInitialData()) coupling.writeData("Wall-Nodes", "CrossSection", ids, area);
  coupling.initialize();
  while (coupling.isCouplingOngoing()) {
    coupling.requiresWritingCheckpoint();
    const double dt = coupling.getMaxTimeStepSize();
    coupling.readData("Wall-Nodes", "Pressure", ids, dt, pressure);
    for (std::size_t i = 0; i < area.size(); ++i) area[i] = tube::area(pressure[i]);
    coupling.writeData("Wall-Nodes", "CrossSection", ids, area);
    coupling.advance(dt);
    coupling.requiresReadingCheckpoint();
  }
  coupling.finalize();
}
