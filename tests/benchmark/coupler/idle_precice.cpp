// The same by the names of preCICE: idle_precice Water|Floor CONFIG (library_overhead.py).
#include <precice/precice.hpp>

#include <cstdlib>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string name = argv[1], mesh = name + "-Mesh", own = name == "Water" ? "Force" : "Displacement",
                    other = name == "Water" ? "Displacement" : "Force";
  const char* points = std::getenv("STRAKE_POINTS");
  const int n = points ? std::atoi(points) : 41;
  precice::Participant coupling(name, argv[2], 0, 1);
  std::vector<double> positions(2 * static_cast<std::size_t>(n), 0.0), values(positions.size());
  std::vector<int> ids(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) positions[2 * static_cast<std::size_t>(k)] = static_cast<double>(k) / (n - 1);
  coupling.setMeshVertices(mesh, positions, ids);
  for (int k = 0; k + 1 < n; ++k)
    coupling.setMeshEdge(mesh, ids[static_cast<std::size_t>(k)], ids[static_cast<std::size_t>(k) + 1]);
  coupling.initialize();
  while (coupling.isCouplingOngoing()) {
    const double dt = coupling.getMaxTimeStepSize();
    coupling.readData(mesh, other, ids, dt, values);
    for (double& value : values) value += 1;
    coupling.writeData(mesh, own, ids, values);
    coupling.advance(dt);
  }
  coupling.finalize();
  return 0;
}
