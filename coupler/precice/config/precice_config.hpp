#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// What a preCICE configuration file says of names and dimensions, and of what each exchange needs. Its
/// mapping methods, acceleration and times are not used: the case file of the run has them. The windows'
/// length is read, to be compared with the case's.
struct PreciceConfig {
  struct Data {
    std::string name;
    bool vector = false;      // components: the dimension of the mesh; else 1
    int waveform_degree = 1;  // of the interpolation in time between samples
  };
  struct Mesh {
    std::string name;
    int dimension = 3;
    std::vector<std::string> data;  // names of what it may hold
  };
  struct MeshData {
    std::string mesh, data;
  };
  struct Mapping {
    std::string kind;        // "nearest-projection", …
    std::string from, to;    // meshes; empty: just in time
    std::string constraint;  // "consistent", "conservative", …
  };
  struct Participant {
    std::string name;
    std::vector<std::string> provided, received;  // meshes: its own, those of others
    std::vector<MeshData> writes, reads;
    std::vector<Mapping> mappings;
  };
  struct Exchange {
    std::string data, mesh, from, to;
    bool initialize = false;  // the sender gives values at the start
    bool substeps = false;    // the sender gives samples inside a window
  };
  struct Scheme {
    std::vector<std::string> participants;
    bool implicit = false;
    std::vector<Exchange> exchanges;
    double window = 0;  // [s] time-window-size; 0: none, or a participant chooses it
  };

  std::filesystem::path file;
  std::vector<Data> data;
  std::vector<Mesh> meshes;
  std::vector<Participant> participants;
  std::vector<Scheme> schemes;

  /// Reads a file. Error(case_file) with file:line:column where it cannot be read, is no XML, lacks an
  /// attribute, or names what it does not define.
  static PreciceConfig read(const std::filesystem::path&);

  /// [s] the windows' length of the scheme with that participant; 0 where there is none.
  double window_of(const std::string& participant) const;
  /// The entry of that name; nullptr if there is none.
  const Data* find_data(const std::string& name) const;
  const Mesh* find_mesh(const std::string& name) const;
  const Participant* find_participant(const std::string& name) const;

  /// True if data that are sent from that mesh keep their sum when they are mapped. Where mappings from it
  /// differ, that to a mesh on which the data are read counts.
  bool conservative(const MeshData& sent) const;
};

}  // namespace strake
