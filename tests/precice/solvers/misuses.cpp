// Participant One of dummies.xml makes every call that preCICE refuses, and goes on: a call that is refused
// changes nothing.
#include "refused.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace {

using precice::Participant;
const std::string mesh = "One-Mesh";
const std::vector<double> place{0, 0, 0, 1, 0, 0, 2, 0, 0};
std::vector<int> ids(3);
std::vector<double> values(9, 1.0);

void of_the_constructor() {
  refused("Participant()", "did you mean \"One\"", [] { Participant("Onr", "dummies.xml", 0, 1); });
  refused("Participant()", "cannot be read", [] { Participant("One", "none.xml", 0, 1); });
  refused("Participant()", "2 processes", [] { Participant("One", "dummies.xml", 1, 2); });
  refused("Participant()", "rank 3 of 1", [] { Participant("One", "dummies.xml", 3, 1); });
}

void before_initialize(Participant& p) {
  const std::string early = "initialize() was not called";
  refused("advance()", early, [&] { p.advance(1); });
  refused("readData()", early, [&] { p.readData(mesh, "Data-Two", ids, 0, values); });
  refused("isCouplingOngoing()", early, [&] { p.isCouplingOngoing(); });
  refused("isTimeWindowComplete()", early, [&] { p.isTimeWindowComplete(); });
  refused("getMaxTimeStepSize()", early, [&] { p.getMaxTimeStepSize(); });
  refused("requiresWritingCheckpoint()", early, [&] { p.requiresWritingCheckpoint(); });
  refused("requiresReadingCheckpoint()", early, [&] { p.requiresReadingCheckpoint(); });
  refused("getMeshDimensions()", "did you mean \"One-Mesh\"", [&] { p.getMeshDimensions("One-Mash"); });
  refused("getDataDimensions()", "is none of mesh", [&] { p.getDataDimensions(mesh, "Force"); });
  refused("setMeshVertex()", "has 2 numbers", [&] { p.setMeshVertex(mesh, {place.data(), 2}); });
  refused("setMeshVertex()", "is none of this participant", [&] {
    p.setMeshVertex("Two-Mesh", {place.data(), 3});
  });
  refused("setMeshVertices()", "has 8 numbers", [&] { p.setMeshVertices(mesh, {place.data(), 8}, ids); });
  refused("setMeshVertex()", "not finite", [&] { p.setMeshVertex(mesh, std::vector<double>{0, NAN, 0}); });
  refused("initialize()", "has no vertices", [&] { p.initialize(); });
  p.setMeshVertices(mesh, place, ids);
  refused("setMeshEdge()", "vertex 3", [&] { p.setMeshEdge(mesh, 0, 3); });
  refused("setMeshTriangle()", "vertex 1 twice", [&] { p.setMeshTriangle(mesh, 0, 1, 1); });
  refused("setMeshEdges()", "multiple of 2", [&] { p.setMeshEdges(mesh, ids); });
  refused("setMeshQuads()", "multiple of 4", [&] { p.setMeshQuads(mesh, ids); });
  refused("setMeshTetrahedron()", "vertex -1", [&] { p.setMeshTetrahedron(mesh, 0, 1, 2, -1); });
  refused("writeData()", "no vertex 7", [&] {
    p.writeData(mesh, "Data-One", std::vector<int>{7}, {values.data(), 3});
  });
  refused("writeData()", "is not written", [&] { p.writeData(mesh, "Data-Two", ids, values); });
  refused("writeData()", "3 vertices and 8 numbers", [&] {
    p.writeData(mesh, "Data-One", ids, {values.data(), 8});
  });
  refused("writeData()", "not finite",
          [&] { p.writeData(mesh, "Data-One", ids, std::vector<double>(9, NAN)); });
}

void in_the_run(Participant& p) {
  const std::string late = "initialize() was called before";
  refused("initialize()", late, [&] { p.initialize(); });
  refused("setMeshVertex()", late, [&] { p.setMeshVertex(mesh, {place.data(), 3}); });
  refused("requiresInitialData()", late, [&] { p.requiresInitialData(); });
  refused("advance()", "whether it must save", [&] { p.advance(0.25); });
  p.requiresWritingCheckpoint();
  for (const double dt : std::vector<double>{0, -1, INFINITY, NAN})
    refused("advance()", "finite and greater than 0", [&] { p.advance(dt); });
  refused("advance()", "1 s are left", [&] { p.advance(1.5); });
  refused("advance()", "data \"Data-One\" of mesh \"One-Mesh\": was not written", [&] { p.advance(1); });
  p.writeData(mesh, "Data-One", {ids.data(), 2}, {values.data(), 6});
  refused("advance()", "at 2 of 3 vertices; vertex 2 has no value", [&] { p.advance(1); });
  refused("readData()", "is not read", [&] { p.readData(mesh, "Data-One", ids, 0, values); });
  refused("readData()", "a time from 0", [&] { p.readData(mesh, "Data-Two", ids, -0.1, values); });
  refused("readData()", "a time from 0", [&] { p.readData(mesh, "Data-Two", ids, 1.1, values); });
  refused("stopLastProfilingSection()", "none is open", [&] { p.stopLastProfilingSection(); });
  refused("resetMesh()", "not supported", [&] { p.resetMesh(mesh); });
  refused("writeAndMapData()", "not supported", [&] { p.writeAndMapData(mesh, "Data-One", place, values); });
  refused("mapAndReadData()", "not supported", [&] { p.mapAndReadData(mesh, "Data-Two", place, 0, values); });
  refused("setMeshAccessRegion()", "not supported", [&] { p.setMeshAccessRegion(mesh, place); });
  refused("writeGradientData()", "not supported",
          [&] { p.writeGradientData(mesh, "Data-One", ids, values); });
}

void after_a_window(Participant& p) {
  refused("advance()", "whether it must go back", [&] { p.advance(1); });
}

void after_the_run(Participant& p) {
  const std::string over = "the run has ended";
  refused("advance()", over, [&] { p.advance(1); });
  refused("writeData()", over, [&] { p.writeData(mesh, "Data-One", ids, values); });
}

void after_finalize(Participant& p) {
  const std::string over = "finalize() was called before";
  refused("finalize()", over, [&] { p.finalize(); });
  refused("advance()", over, [&] { p.advance(1); });
  refused("initialize()", over, [&] { p.initialize(); });
  refused("isCouplingOngoing()", over, [&] { p.isCouplingOngoing(); });
}

}  // namespace

int main() {
  of_the_constructor();
  Participant p("One", "dummies.xml", 0, 1);
  before_initialize(p);
  p.initialize();
  in_the_run(p);
  for (bool first = true; p.isCouplingOngoing(); first = false) {
    p.requiresWritingCheckpoint();
    p.readData(mesh, "Data-Two", ids, p.getMaxTimeStepSize(), values);
    p.writeData(mesh, "Data-One", ids, values);
    p.advance(p.getMaxTimeStepSize());
    if (first) after_a_window(p);
    p.requiresReadingCheckpoint();
  }
  after_the_run(p);
  p.finalize();
  after_finalize(p);
  print_count();
}
