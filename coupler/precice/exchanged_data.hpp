#pragma once

#include "coupler/precice/config/precice_config.hpp"
#include "coupler/precice/config/quantities.hpp"
#include "proto/participant.hpp"
#include "proto/values.hpp"

#include <Eigen/Core>

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace strake {

/// One of the partner's fields over the window, components×n, to be read at any time in it.
class Waveform {
 public:
  /// degree: 0 constant, 1 linear, more: a polynomial of that degree through the nearest samples.
  explicit Waveform(int degree) : degree_(degree) {}

  struct Knot {
    double time;  // [s] absolute
    Values value;
  };
  /// The value that holds where the first window begins.
  void begin(double time, Values value);
  /// The partner's samples for the window that begins at `start`, ascending; the last one is the window's
  /// end. Replaces those that were set for the same window. The field keeps what it had at `start`.
  void set_window(double start, std::vector<Knot> samples);
  /// The window is over: its end is the next one's start.
  void commit();

  /// The value at a time of the window. With one sample and degree 1 it is linear between the window's ends.
  /// With degree 0 it is that of the next sample, and at the window's start the one that held there.
  Values at(double time) const;
  bool empty() const { return knots_.empty(); }

 private:
  int degree_;
  Knot start_{0, {}};
  std::vector<Knot> knots_;  // of the window, ascending
};

/// The data that a participant writes and reads on its meshes, under the names of its configuration file.
/// Errors are Error(solver_fault).
///
/// The coupler sees the meshes as one (solver_mesh.hpp, `joined`): a field that is sent has the values of its
/// own mesh there and zeros elsewhere, and of one that is received the part on its mesh is taken.
class ExchangedData {
 public:
  /// Error(case_file) where two data are one quantity for the coupler.
  ExchangedData(const PreciceConfig&, const PreciceConfig::Participant&, const QuantityNames&);

  /// The meshes that have data, in the order of the configuration.
  std::vector<std::string> meshes() const;
  /// Room for n points on a mesh; those that are new have the value zero.
  void resize(const std::string& mesh, int n_points);
  /// values: as many numbers for each point as the data have components there.
  void write(const std::string& mesh, const std::string& data, std::span<const int> ids,
             std::span<const double> values);
  /// values: the same; at a time of the window [s, absolute].
  void read(const std::string& mesh, const std::string& data, std::span<const int> ids, double time,
            std::span<double> values) const;
  /// Tests that all data were written since the last call of `take_fields`. Error(solver_fault) names those
  /// that were not. Conservative data, such as a force, may be written at some vertices alone: the others
  /// carry none. What does not keep its sum, such as a displacement, needs a value at every vertex.
  void check_written() const;
  /// What was written since the last call, as the coupler takes it; from here on it is zero. Vectors have
  /// three components where Strake knows the quantity.
  std::vector<Field> take_fields();
  /// Tests that some of the data to read were read so far. Error(solver_fault) if none was.
  void check_read() const;
  /// Reads in the window that was received last were all at its start [s, absolute]; false without a read.
  bool read_start_alone(double start, double round_off) const;

  /// The mesh of each quantity that is written, and of each that is read.
  std::map<std::string, std::string> written_on() const { return mesh_of(written_); }
  std::map<std::string, std::string> read_on() const { return mesh_of(read_); }

  /// The partner's fields where the run begins, on its own mesh. They are taken where that mesh has the
  /// points of the data's mesh; else, and where one is missing, a field begins at zero.
  void begin(const InterfaceMesh& partner, const std::vector<Field>& fields,
             const std::vector<InterfaceMesh>& own);
  /// The partner's fields over a window. Error if one that is read is missing or has other components.
  void receive(const Window&, const Input&);
  void commit();

  bool writes(const std::string& mesh, const std::string& data) const;
  bool reads(const std::string& mesh, const std::string& data) const;

 private:
  struct Entry {
    std::string mesh, data;
    Quantity quantity;
    int components;                // in the solver
    Eigen::MatrixXd value;         // quantity.components×n, of what is written; empty: nothing yet
    std::vector<bool> given = {};  // the vertices that were written; empty: none
    Waveform waveform;             // of what is read
    std::string text() const { return "data \"" + data + "\" of mesh \"" + mesh + "\""; }
  };
  /// Where a mesh stands among all that are joined.
  struct Place {
    std::string mesh;
    int first = 0, points = 0;
  };
  Entry entry(const PreciceConfig&, const PreciceConfig::MeshData&, const QuantityNames&) const;
  void check_quantities(const PreciceConfig&, const std::vector<Entry>&, const char* verb) const;
  static std::map<std::string, std::string> mesh_of(const std::vector<Entry>&);
  const Place& place_of(const Entry&) const;
  int all_points() const { return places_.back().first + places_.back().points; }
  const Entry* find(const std::vector<Entry>&, const std::string& mesh, const std::string& data) const;
  void check_sizes(const Entry&, std::size_t ids, std::size_t values) const;
  void check_written(const Entry&) const;
  std::string listed(const std::vector<Entry>&) const;
  void check_components(const Entry&, const Field&, int points) const;
  Values from_partner(const Entry&, const Field&) const;

  std::vector<Entry> written_, read_;
  std::vector<Place> places_;
  mutable bool was_read_ = false;
  mutable std::optional<double> latest_read_;  // [s] in the window that was received last
};

}  // namespace strake
