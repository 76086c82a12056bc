// The functions for Fortran: those for C, with arguments by reference and texts that end with blanks.

#include "coupler/precice/guarded_call.hpp"

#include <precice/preciceC.h>
#include <precice/preciceFortran.hpp>

#include <algorithm>
#include <string>

namespace {

/// A text of Fortran without the blanks at its end.
std::string trimmed(const char* text, int length) {
  while (length > 0 && (text[length - 1] == ' ' || text[length - 1] == '\0')) --length;
  return {text, static_cast<std::size_t>(std::max(length, 0))};
}

}  // namespace

void precicef_create_(const char* name, const char* config, const int* rank, const int* size, int name_length,
                      int config_length) {
  precicec_createParticipant(trimmed(name, name_length).c_str(), trimmed(config, config_length).c_str(),
                             *rank, *size);
}
void precicef_create_with_communicator_(const char* name, const char* config, const int* rank,
                                        const int* size, const int*, int name_length, int config_length) {
  precicef_create_(name, config, rank, size, name_length, config_length);
}
void precicef_initialize_() {
  precicec_initialize();
}
void precicef_advance_(const double* dt) {
  precicec_advance(*dt);
}
void precicef_finalize_() {
  precicec_finalize();
}

void precicef_is_coupling_ongoing_(int* ongoing) {
  *ongoing = precicec_isCouplingOngoing();
}
void precicef_is_time_window_complete_(int* complete) {
  *complete = precicec_isTimeWindowComplete();
}
void precicef_get_max_time_step_size_(double* dt) {
  *dt = precicec_getMaxTimeStepSize();
}
void precicef_requires_initial_data_(int* required) {
  *required = precicec_requiresInitialData();
}
void precicef_requires_writing_checkpoint_(int* required) {
  *required = precicec_requiresWritingCheckpoint();
}
void precicef_requires_reading_checkpoint_(int* required) {
  *required = precicec_requiresReadingCheckpoint();
}

void precicef_get_mesh_dimensions_(const char* mesh, int* dimensions, int mesh_length) {
  *dimensions = precicec_getMeshDimensions(trimmed(mesh, mesh_length).c_str());
}
void precicef_get_data_dimensions_(const char* mesh, const char* data, int* dimensions, int mesh_length,
                                   int data_length) {
  *dimensions =
      precicec_getDataDimensions(trimmed(mesh, mesh_length).c_str(), trimmed(data, data_length).c_str());
}
void precicef_requires_mesh_connectivity_for_(const char* mesh, int* required, int mesh_length) {
  *required = precicec_requiresMeshConnectivityFor(trimmed(mesh, mesh_length).c_str());
}
void precicef_reset_mesh_(const char* mesh, int mesh_length) {
  precicec_resetMesh(trimmed(mesh, mesh_length).c_str());
}

void precicef_set_vertex_(const char* mesh, const double* position, int* id, int mesh_length) {
  *id = precicec_setMeshVertex(trimmed(mesh, mesh_length).c_str(), position);
}
void precicef_get_mesh_vertex_size_(const char* mesh, int* size, int mesh_length) {
  *size = precicec_getMeshVertexSize(trimmed(mesh, mesh_length).c_str());
}
void precicef_set_vertices_(const char* mesh, const int* size, double* positions, int* ids, int mesh_length) {
  precicec_setMeshVertices(trimmed(mesh, mesh_length).c_str(), *size, positions, ids);
}
void precicef_set_edge_(const char* mesh, const int* first, const int* second, int mesh_length) {
  precicec_setMeshEdge(trimmed(mesh, mesh_length).c_str(), *first, *second);
}
void precicef_set_mesh_edges_(const char* mesh, const int* size, const int* ids, int mesh_length) {
  precicec_setMeshEdges(trimmed(mesh, mesh_length).c_str(), *size, ids);
}
void precicef_set_triangle_(const char* mesh, const int* first, const int* second, const int* third,
                            int mesh_length) {
  precicec_setMeshTriangle(trimmed(mesh, mesh_length).c_str(), *first, *second, *third);
}
void precicef_set_mesh_triangles_(const char* mesh, const int* size, const int* ids, int mesh_length) {
  precicec_setMeshTriangles(trimmed(mesh, mesh_length).c_str(), *size, ids);
}
void precicef_set_quad_(const char* mesh, const int* first, const int* second, const int* third,
                        const int* fourth, int mesh_length) {
  precicec_setMeshQuad(trimmed(mesh, mesh_length).c_str(), *first, *second, *third, *fourth);
}
void precicef_set_mesh_quads_(const char* mesh, const int* size, const int* ids, int mesh_length) {
  precicec_setMeshQuads(trimmed(mesh, mesh_length).c_str(), *size, ids);
}
void precicef_set_tetrahedron(const char* mesh, const int* first, const int* second, const int* third,
                              const int* fourth, int mesh_length) {
  precicec_setMeshTetrahedron(trimmed(mesh, mesh_length).c_str(), *first, *second, *third, *fourth);
}
void precicef_set_tetrahedron_(const char* mesh, const int* first, const int* second, const int* third,
                               const int* fourth, int mesh_length) {
  precicef_set_tetrahedron(mesh, first, second, third, fourth, mesh_length);
}
void precicef_set_mesh_tetrahedra_(const char* mesh, const int* size, const int* ids, int mesh_length) {
  precicec_setMeshTetrahedra(trimmed(mesh, mesh_length).c_str(), *size, ids);
}

void precicef_write_data_(const char* mesh, const char* data, const int* size, int* ids, double* values,
                          int mesh_length, int data_length) {
  precicec_writeData(trimmed(mesh, mesh_length).c_str(), trimmed(data, data_length).c_str(), *size, ids,
                     values);
}
void precicef_read_data_(const char* mesh, const char* data, const int* size, int* ids,
                         const double* relative_time, double* values, int mesh_length, int data_length) {
  precicec_readData(trimmed(mesh, mesh_length).c_str(), trimmed(data, data_length).c_str(), *size, ids,
                    *relative_time, values);
}
void precicef_write_and_map_data_(const char* mesh, const char* data, const int* size, double* coordinates,
                                  double* values, int mesh_length, int data_length) {
  precicec_writeAndMapData(trimmed(mesh, mesh_length).c_str(), trimmed(data, data_length).c_str(), *size,
                           coordinates, values);
}
void precicef_map_and_read_data_(const char* mesh, const char* data, const int* size, double* coordinates,
                                 const double* relative_time, double* values, int mesh_length,
                                 int data_length) {
  precicec_mapAndReadData(trimmed(mesh, mesh_length).c_str(), trimmed(data, data_length).c_str(), *size,
                          coordinates, *relative_time, values);
}
void precicef_set_mesh_access_region_(const char* mesh, const double* box, int mesh_length) {
  precicec_setMeshAccessRegion(trimmed(mesh, mesh_length).c_str(), box);
}
void precicef_get_mesh_vertex_ids_and_coordinates_(const char* mesh, const int* size, int* ids,
                                                   double* coordinates, int mesh_length) {
  precicec_getMeshVertexIDsAndCoordinates(trimmed(mesh, mesh_length).c_str(), *size, ids, coordinates);
}
void precicef_requires_gradient_data_for_(const char* mesh, const char* data, int* required, int mesh_length,
                                          int data_length) {
  *required = precicec_requiresGradientDataFor(trimmed(mesh, mesh_length).c_str(),
                                               trimmed(data, data_length).c_str());
}
void precicef_write_gradient_data_(const char* mesh, const char* data, const int* size, const int* ids,
                                   const double* gradients, int mesh_length, int data_length) {
  precicec_writeGradientData(trimmed(mesh, mesh_length).c_str(), trimmed(data, data_length).c_str(), *size,
                             ids, gradients);
}
void precicef_start_profiling_section_(const char* name, int name_length) {
  precicec_startProfilingSection(trimmed(name, name_length).c_str());
}
void precicef_stop_last_profiling_section_() {
  precicec_stopLastProfilingSection();
}
void precicef_get_version_information_(char* text, int text_length) {
  const std::string version = strake::precice_version;
  const auto room = static_cast<std::size_t>(std::max(text_length, 0));
  std::fill_n(text, room, ' ');
  std::copy_n(version.data(), std::min(version.size(), room), text);
}
