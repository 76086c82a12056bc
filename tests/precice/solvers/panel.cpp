// One side of a panel on springs under a load that follows it. The water has two meshes: it takes the
// displacement on its nodes, and gives the force in the middle of its faces. The panel has one mesh, or two
// of its own. Both know preCICE's functions alone.
#include <precice/precice.hpp>

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace {

using Values = std::vector<double>;  // x, y of each point
constexpr double pi = 3.14159265358979323846;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// n + 1 nodes on the line from 0 to 1.
Values nodes(int n) {
  Values place;
  for (int i = 0; i <= n; ++i) place.insert(place.end(), {static_cast<double>(i) / n, 0.0});
  return place;
}

/// The middles of the n faces between them.
Values middles(int n) {
  Values place;
  for (int i = 0; i < n; ++i) place.insert(place.end(), {(i + 0.5) / n, 0.0});
  return place;
}

double sum_y(const Values& values) {
  double sum = 0;
  for (std::size_t i = 1; i < values.size(); i += 2) sum += values[i];
  return sum;
}

/// A mesh of a participant, and the data on it.
struct Mesh {
  precice::Participant& coupling;
  std::string name;
  std::vector<int> ids;
  Values values;
  Mesh(precice::Participant& c, const std::string& n, const Values& place, bool joined)
      : coupling(c), name(n), ids(place.size() / 2), values(place.size(), 0.0) {
    coupling.setMeshVertices(name, place, ids);
    for (std::size_t i = 1; joined && i < ids.size(); ++i) coupling.setMeshEdge(name, ids[i - 1], ids[i]);
  }
  void read(const std::string& data) {
    coupling.readData(name, data, ids, coupling.getMaxTimeStepSize(), values);
  }
  void write(const std::string& data) { coupling.writeData(name, data, ids, values); }
};

/// Each face of length h has the force h (1 + sin 2πt − 5 w). w: the mean displacement of its ends.
void water(precice::Participant& coupling) {
  constexpr int n = 20;
  Mesh moved(coupling, "Water-Nodes", nodes(n), true), loading(coupling, "Water-Faces", middles(n), false);
  coupling.initialize();
  double t = 0;
  while (coupling.isCouplingOngoing()) {
    coupling.requiresWritingCheckpoint();
    const double dt = coupling.getMaxTimeStepSize();
    moved.read("Displacement");
    for (int j = 0; j < n; ++j) {
      const double w = (moved.values[index(2 * j + 1)] + moved.values[index(2 * j + 3)]) / 2;
      loading.values[index(2 * j + 1)] = (1 + std::sin(2 * pi * (t + dt)) - 5 * w) / n;
    }
    loading.write("Force");
    coupling.advance(dt);
    if (coupling.requiresReadingCheckpoint()) continue;
    t += dt;
    std::printf("%.17g %.17g\n", sum_y(loading.values), moved.values.back());
  }
}

/// Eleven points without mass, each with the spring k = 3: u = f/k. `middles_take`: the force comes to the
/// middles of the faces, and half of it goes to each end.
void panel(precice::Participant& coupling, bool middles_take) {
  constexpr int n = 10;
  constexpr double k = 3;
  Mesh moving(coupling, "Panel-Nodes", nodes(n), true);
  std::unique_ptr<Mesh> own;
  if (middles_take) own = std::make_unique<Mesh>(coupling, "Panel-Faces", middles(n), false);
  Mesh& loaded = own ? *own : moving;
  coupling.initialize();
  while (coupling.isCouplingOngoing()) {
    coupling.requiresWritingCheckpoint();
    const double dt = coupling.getMaxTimeStepSize();
    loaded.read("Force");
    const double sum = sum_y(loaded.values);
    const Values force = loaded.values;
    moving.values.assign(moving.values.size(), 0.0);
    for (int i = 0; i < static_cast<int>(force.size()) / 2; ++i) {
      const double f = force[index(2 * i + 1)];
      if (own) {
        moving.values[index(2 * i + 1)] += f / 2 / k;
        moving.values[index(2 * i + 3)] += f / 2 / k;
      } else {
        moving.values[index(2 * i + 1)] = f / k;
      }
    }
    const double last = moving.values.back();
    moving.write("Displacement");
    coupling.advance(dt);
    if (!coupling.requiresReadingCheckpoint()) std::printf("%.17g %.17g\n", sum, last);
  }
}

}  // namespace

/// panel Water|Panel CONFIG [middles]: prints after each window the force's sum and the displacement of the
/// end.
int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string side = argv[1];
  precice::Participant coupling(side, argv[2], 0, 1);
  if (side == "Water")
    water(coupling);
  else
    panel(coupling, argc > 3);
  coupling.finalize();
}
