#pragma once

#include <filesystem>
#include <string>

namespace strake {

/// preCICE's functions for C, from a library that is loaded while the program runs. Nothing of preCICE is
/// needed to build. Names and arrays are those of preCICE 3: points and values one after the other, `size`
/// the number of points, edges or triangles. The library ends the process where a call cannot be carried out.
struct PreciceLibrary {
  void (*create)(const char* participant, const char* config, int rank, int size) = nullptr;
  void (*initialize)() = nullptr;
  void (*advance)(double dt) = nullptr;  // [s]
  void (*finalize)() = nullptr;
  int (*is_ongoing)() = nullptr;
  double (*longest_step)() = nullptr;  // [s] what is left of the window
  int (*needs_initial_data)() = nullptr;
  int (*needs_checkpoint)() = nullptr;  // the state must be kept
  int (*needs_rewind)() = nullptr;      // the kept state must be taken
  int (*needs_faces)(const char* mesh) = nullptr;
  void (*set_vertices)(const char* mesh, int size, const double* positions, int* ids) = nullptr;
  void (*set_edges)(const char* mesh, int size, const int* ids) = nullptr;
  void (*set_triangles)(const char* mesh, int size, const int* ids) = nullptr;
  void (*write)(const char* mesh, const char* data, int size, const int* ids, const double* values) = nullptr;
  void (*read)(const char* mesh, const char* data, int size, const int* ids, double relative_time,
               double* values) = nullptr;

  std::filesystem::path file;  // that the loader took
  std::string version;         // "3.4.1…"
  bool is_strakes = false;     // coupler/precice: it couples through a run of Strake

  /// Loads `file`; where that is empty, libprecice.so.3 as the loader finds it. Error(command_line) that says
  /// what was looked for: no such library, one of another major version, or one without a function.
  static PreciceLibrary load(const std::filesystem::path& file);
};

}  // namespace strake
