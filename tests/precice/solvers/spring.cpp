// A rigid floor on a spring, m y'' + k y = F, under a column of water (cases/python_spring). It knows
// preCICE's functions alone. Trapezoidal rule with the force at the window's end.
#include <precice/precice.hpp>

#include <cstdio>
#include <string>
#include <vector>

/// spring CONFIG [MESH [bare]]: prints the floor's height after each window. MESH: the force comes to a mesh
/// of its own, the middles of the edges. bare: the edges are not told.
int main(int argc, char** argv) {
  constexpr double m = 200, k = 1e8, width = 1, thickness = 0.05;  // kg and N/m per metre of depth; m
  constexpr int n = 21;  // points on its upper face, and on its lower one
  precice::Participant coupling("Floor", argc > 1 ? argv[1] : "spring.xml", 0, 1);
  std::vector<double> positions;
  for (int i = 0; i < 2 * n; ++i) {
    const double x = width * (i < n ? i : 2 * n - 1 - i) / (n - 1) - width / 2;
    positions.insert(positions.end(), {x, i < n ? -thickness : 0.0});
  }
  std::vector<int> ids(2 * n), edges;
  coupling.setMeshVertices("Floor-Mesh", positions, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) edges.insert(edges.end(), {ids[i], ids[(i + 1) % ids.size()]});
  if (argc < 4 && coupling.requiresMeshConnectivityFor("Floor-Mesh"))
    coupling.setMeshEdges("Floor-Mesh", edges);
  const std::string of_force = argc > 2 ? argv[2] : "Floor-Mesh";
  std::vector<int> force_ids = ids;
  if (argc > 2) {
    std::vector<double> middles(positions.size());
    for (std::size_t i = 0; i < middles.size(); ++i)
      middles[i] = (positions[i] + positions[(i + 2) % positions.size()]) / 2;
    coupling.setMeshVertices(of_force, middles, force_ids);
  }
  coupling.initialize();
  double y = 0, v = 0, saved_y = 0, saved_v = 0;
  std::vector<double> force(positions.size()), displacement(positions.size(), 0.0);
  while (coupling.isCouplingOngoing()) {
    if (coupling.requiresWritingCheckpoint()) saved_y = y, saved_v = v;
    const double dt = coupling.getMaxTimeStepSize();
    coupling.readData(of_force, "Force", force_ids, dt, force);
    double sum = 0;
    for (std::size_t i = 1; i < force.size(); i += 2) sum += force[i];
    const double a = k * dt * dt / (4 * m), end = ((1 - a) * v + dt * (sum - k * y) / m) / (1 + a);
    y += dt * (v + end) / 2;
    v = end;
    for (std::size_t i = 1; i < displacement.size(); i += 2) displacement[i] = y;
    coupling.writeData("Floor-Mesh", "Displacement", ids, displacement);
    coupling.advance(dt);
    if (coupling.requiresReadingCheckpoint()) y = saved_y, v = saved_v;
    if (coupling.isTimeWindowComplete()) std::printf("%.9g\n", y);
  }
  coupling.finalize();
}
