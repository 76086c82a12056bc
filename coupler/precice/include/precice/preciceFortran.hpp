#pragma once

#include <precice/export.h>

#ifdef __cplusplus
extern "C" {
#endif

// The functions of preciceC.h for Fortran, as GNU Fortran calls external procedures. All arguments go by
// reference. The lengths of the texts stand at the end; trailing blanks of a text do not count.
// set_tetrahedron has two names, one without the last underscore.
PRECICE_API void precicef_create_(const char* name, const char* config, const int* rank, const int* size,
                                  int name_length, int config_length);
PRECICE_API void precicef_create_with_communicator_(const char* name, const char* config, const int* rank,
                                                    const int* size, const int* communicator, int name_length,
                                                    int config_length);
PRECICE_API void precicef_initialize_();
PRECICE_API void precicef_advance_(const double* dt);
PRECICE_API void precicef_finalize_();
PRECICE_API void precicef_is_coupling_ongoing_(int* ongoing);
PRECICE_API void precicef_is_time_window_complete_(int* complete);
PRECICE_API void precicef_get_max_time_step_size_(double* dt);
PRECICE_API void precicef_requires_initial_data_(int* required);
PRECICE_API void precicef_requires_writing_checkpoint_(int* required);
PRECICE_API void precicef_requires_reading_checkpoint_(int* required);
PRECICE_API void precicef_get_mesh_dimensions_(const char* mesh, int* dimensions, int mesh_length);
PRECICE_API void precicef_get_data_dimensions_(const char* mesh, const char* data, int* dimensions,
                                               int mesh_length, int data_length);
PRECICE_API void precicef_requires_mesh_connectivity_for_(const char* mesh, int* required, int mesh_length);
PRECICE_API void precicef_reset_mesh_(const char* mesh, int mesh_length);
PRECICE_API void precicef_set_vertex_(const char* mesh, const double* position, int* id, int mesh_length);
PRECICE_API void precicef_get_mesh_vertex_size_(const char* mesh, int* size, int mesh_length);
PRECICE_API void precicef_set_vertices_(const char* mesh, const int* size, double* positions, int* ids,
                                        int mesh_length);
PRECICE_API void precicef_set_edge_(const char* mesh, const int* first, const int* second, int mesh_length);
PRECICE_API void precicef_set_mesh_edges_(const char* mesh, const int* size, const int* ids, int mesh_length);
PRECICE_API void precicef_set_triangle_(const char* mesh, const int* first, const int* second,
                                        const int* third, int mesh_length);
PRECICE_API void precicef_set_mesh_triangles_(const char* mesh, const int* size, const int* ids,
                                              int mesh_length);
PRECICE_API void precicef_set_quad_(const char* mesh, const int* first, const int* second, const int* third,
                                    const int* fourth, int mesh_length);
PRECICE_API void precicef_set_mesh_quads_(const char* mesh, const int* size, const int* ids, int mesh_length);
PRECICE_API void precicef_set_tetrahedron(const char* mesh, const int* first, const int* second,
                                          const int* third, const int* fourth, int mesh_length);
PRECICE_API void precicef_set_tetrahedron_(const char* mesh, const int* first, const int* second,
                                           const int* third, const int* fourth, int mesh_length);
PRECICE_API void precicef_set_mesh_tetrahedra_(const char* mesh, const int* size, const int* ids,
                                               int mesh_length);
PRECICE_API void precicef_write_data_(const char* mesh, const char* data, const int* size, int* ids,
                                      double* values, int mesh_length, int data_length);
PRECICE_API void precicef_read_data_(const char* mesh, const char* data, const int* size, int* ids,
                                     const double* relative_time, double* values, int mesh_length,
                                     int data_length);
PRECICE_API void precicef_write_and_map_data_(const char* mesh, const char* data, const int* size,
                                              double* coordinates, double* values, int mesh_length,
                                              int data_length);
PRECICE_API void precicef_map_and_read_data_(const char* mesh, const char* data, const int* size,
                                             double* coordinates, const double* relative_time, double* values,
                                             int mesh_length, int data_length);
PRECICE_API void precicef_set_mesh_access_region_(const char* mesh, const double* box, int mesh_length);
PRECICE_API void precicef_get_mesh_vertex_ids_and_coordinates_(const char* mesh, const int* size, int* ids,
                                                               double* coordinates, int mesh_length);
PRECICE_API void precicef_requires_gradient_data_for_(const char* mesh, const char* data, int* required,
                                                      int mesh_length, int data_length);
PRECICE_API void precicef_write_gradient_data_(const char* mesh, const char* data, const int* size,
                                               const int* ids, const double* gradients, int mesh_length,
                                               int data_length);
PRECICE_API void precicef_start_profiling_section_(const char* name, int name_length);
PRECICE_API void precicef_stop_last_profiling_section_();
PRECICE_API void precicef_get_version_information_(char* text, int text_length);

#ifdef __cplusplus
}
#endif
