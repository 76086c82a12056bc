// The functions for C. Names and texts end with a zero.

#include "coupler/precice/guarded_call.hpp"
#include "coupler/precice/only_participant.hpp"

#include <precice/preciceC.h>

using precice::Participant;
using precice::span;
using strake::count;
using strake::for_c;
using strake::only_participant;

namespace {

/// Numbers of `n` things with `each` numbers.
template <class Number>
span<Number> numbers(Number* first, std::size_t n, int each = 1) {
  return {first, n * count(each)};
}

/// Sets faces of `corners` vertices by a function of the participant.
void set_faces(void (Participant::*set)(precice::string_view, span<const int>), const char* mesh, int size,
               const int* ids, int corners) {
  for_c([&] { (only_participant().*set)(mesh, numbers(ids, count(size), corners)); });
}

}  // namespace

void precicec_createParticipant(const char* name, const char* config, int rank, int size) {
  strake::make_only_participant(name, config, rank, size);
}
void precicec_createParticipant_withCommunicator(const char* name, const char* config, int rank, int size,
                                                 void*) {
  strake::make_only_participant(name, config, rank, size);
}
void precicec_initialize(void) {
  for_c([] { only_participant().initialize(); });
}
void precicec_advance(double dt) {
  for_c([=] { only_participant().advance(dt); });
}
void precicec_finalize(void) {
  for_c([] { only_participant().finalize(); });
  strake::drop_only_participant();
}

int precicec_isCouplingOngoing(void) {
  return for_c([] { return only_participant().isCouplingOngoing(); });
}
int precicec_isTimeWindowComplete(void) {
  return for_c([] { return only_participant().isTimeWindowComplete(); });
}
double precicec_getMaxTimeStepSize(void) {
  return for_c([] { return only_participant().getMaxTimeStepSize(); });
}
int precicec_requiresInitialData(void) {
  return for_c([] { return only_participant().requiresInitialData(); });
}
int precicec_requiresWritingCheckpoint(void) {
  return for_c([] { return only_participant().requiresWritingCheckpoint(); });
}
int precicec_requiresReadingCheckpoint(void) {
  return for_c([] { return only_participant().requiresReadingCheckpoint(); });
}

int precicec_getMeshDimensions(const char* mesh) {
  return for_c([=] { return only_participant().getMeshDimensions(mesh); });
}
int precicec_getDataDimensions(const char* mesh, const char* data) {
  return for_c([=] { return only_participant().getDataDimensions(mesh, data); });
}
int precicec_requiresMeshConnectivityFor(const char* mesh) {
  return for_c([=] { return only_participant().requiresMeshConnectivityFor(mesh); });
}
void precicec_resetMesh(const char* mesh) {
  for_c([=] { only_participant().resetMesh(mesh); });
}

int precicec_setMeshVertex(const char* mesh, const double* position) {
  return for_c([=] {
    Participant& p = only_participant();
    return p.setMeshVertex(mesh, numbers(position, 1, p.getMeshDimensions(mesh)));
  });
}
int precicec_getMeshVertexSize(const char* mesh) {
  return for_c([=] { return only_participant().getMeshVertexSize(mesh); });
}
void precicec_setMeshVertices(const char* mesh, int size, const double* positions, int* ids) {
  for_c([=] {
    Participant& p = only_participant();
    p.setMeshVertices(mesh, numbers(positions, count(size), p.getMeshDimensions(mesh)),
                      numbers(ids, count(size)));
  });
}
void precicec_setMeshEdge(const char* mesh, int first, int second) {
  for_c([=] { only_participant().setMeshEdge(mesh, first, second); });
}
void precicec_setMeshEdges(const char* mesh, int size, const int* ids) {
  set_faces(&Participant::setMeshEdges, mesh, size, ids, 2);
}
void precicec_setMeshTriangle(const char* mesh, int first, int second, int third) {
  for_c([=] { only_participant().setMeshTriangle(mesh, first, second, third); });
}
void precicec_setMeshTriangles(const char* mesh, int size, const int* ids) {
  set_faces(&Participant::setMeshTriangles, mesh, size, ids, 3);
}
void precicec_setMeshQuad(const char* mesh, int first, int second, int third, int fourth) {
  for_c([=] { only_participant().setMeshQuad(mesh, first, second, third, fourth); });
}
void precicec_setMeshQuads(const char* mesh, int size, const int* ids) {
  set_faces(&Participant::setMeshQuads, mesh, size, ids, 4);
}
void precicec_setMeshTetrahedron(const char* mesh, int first, int second, int third, int fourth) {
  for_c([=] { only_participant().setMeshTetrahedron(mesh, first, second, third, fourth); });
}
void precicec_setMeshTetrahedra(const char* mesh, int size, const int* ids) {
  set_faces(&Participant::setMeshTetrahedra, mesh, size, ids, 4);
}

void precicec_writeData(const char* mesh, const char* data, int size, const int* ids, const double* values) {
  for_c([=] {
    Participant& p = only_participant();
    p.writeData(mesh, data, numbers(ids, count(size)),
                numbers(values, count(size), p.getDataDimensions(mesh, data)));
  });
}
void precicec_readData(const char* mesh, const char* data, int size, const int* ids, double relative_time,
                       double* values) {
  for_c([=] {
    Participant& p = only_participant();
    p.readData(mesh, data, numbers(ids, count(size)), relative_time,
               numbers(values, count(size), p.getDataDimensions(mesh, data)));
  });
}
void precicec_writeAndMapData(const char* mesh, const char* data, int, const double*, const double*) {
  for_c([=] { only_participant().writeAndMapData(mesh, data, {}, {}); });
}
void precicec_mapAndReadData(const char* mesh, const char* data, int, const double*, double relative_time,
                             double*) {
  for_c([=] { only_participant().mapAndReadData(mesh, data, {}, relative_time, {}); });
}
void precicec_setMeshAccessRegion(const char* mesh, const double*) {
  for_c([=] { only_participant().setMeshAccessRegion(mesh, {}); });
}
void precicec_getMeshVertexIDsAndCoordinates(const char* mesh, int size, int* ids, double* coordinates) {
  for_c([=] {
    Participant& p = only_participant();
    p.getMeshVertexIDsAndCoordinates(mesh, numbers(ids, count(size)),
                                     numbers(coordinates, count(size), p.getMeshDimensions(mesh)));
  });
}
int precicec_requiresGradientDataFor(const char* mesh, const char* data) {
  return for_c([=] { return only_participant().requiresGradientDataFor(mesh, data); });
}
void precicec_writeGradientData(const char* mesh, const char* data, int, const int*, const double*) {
  for_c([=] { only_participant().writeGradientData(mesh, data, {}, {}); });
}
void precicec_startProfilingSection(const char* name) {
  for_c([=] { only_participant().startProfilingSection(name); });
}
void precicec_stopLastProfilingSection(void) {
  for_c([] { only_participant().stopLastProfilingSection(); });
}
const char* precicec_getVersionInformation(void) {
  return strake::precice_version;
}
