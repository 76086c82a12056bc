// Participant Water of panel.xml makes the calls that are wrong for one of its two meshes. It goes on:
// a call that is refused changes nothing.
#include "refused.hpp"

#include <string>
#include <vector>

/// meshes CONFIG
int main(int argc, char** argv) {
  precice::Participant p("Water", argc > 1 ? argv[1] : "panel.xml", 0, 1);
  const std::string nodes = "Water-Nodes", faces = "Water-Faces";
  const std::vector<double> places{0, 0, 0.5, 0, 1, 0}, middles{0.25, 0, 0.75, 0};
  std::vector<double> moved(6, 0.0), force(4, 0.5);
  std::vector<int> node_ids(3), face_ids(2);
  p.setMeshVertices(nodes, places, node_ids);
  refused("initialize()", "mesh \"Water-Faces\": has no vertices", [&] { p.initialize(); });
  refused("writeData()", "has no vertex 0", [&] { p.writeData(faces, "Force", face_ids, force); });
  p.setMeshVertices(faces, middles, face_ids);
  refused("setMeshEdge()", "Water-Faces: an edge with vertex 2", [&] { p.setMeshEdge(faces, 0, 2); });
  refused("setMeshVertex()", "is the partner's", [&] { p.setMeshVertex("Panel-Nodes", {places.data(), 2}); });
  p.initialize();
  while (p.isCouplingOngoing()) {
    p.requiresWritingCheckpoint();
    const double dt = p.getMaxTimeStepSize();
    refused("writeData()", "it writes data \"Force\" of mesh \"Water-Faces\"",
            [&] { p.writeData(nodes, "Force", node_ids, moved); });
    refused("writeData()", "mesh \"Water-Faces\": has no vertex 2",
            [&] { p.writeData(faces, "Force", node_ids, moved); });
    refused("readData()", "it reads data \"Displacement\" of mesh \"Water-Nodes\"",
            [&] { p.readData(faces, "Displacement", face_ids, dt, force); });
    p.readData(nodes, "Displacement", node_ids, dt, moved);
    p.writeData(faces, "Force", face_ids, force);
    p.advance(dt);
    p.requiresReadingCheckpoint();
  }
  p.finalize();
  print_count();
}
