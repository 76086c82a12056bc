#pragma once

#include "coupler/precice/config/precice_config.hpp"
#include "coupler/precice/config/quantities.hpp"
#include "coupler/precice/waveform.hpp"
#include "proto/participant.hpp"

#include <Eigen/Core>

#include <span>
#include <string>
#include <vector>

namespace strake {

/// The data that a participant writes and reads on its mesh, under the names of its configuration file.
/// Errors are Error(solver_fault).
class ExchangedData {
 public:
  ExchangedData(const PreciceConfig&, const PreciceConfig::Participant&, const QuantityNames&);

  /// Room for n points; those that are new have the value zero.
  void resize(int n_points);
  int points() const { return n_points_; }
  /// values: as many numbers for each point as the data have components there.
  void write(const std::string& mesh, const std::string& data, std::span<const int> ids,
             std::span<const double> values);
  /// values: the same; at a time of the window [s, absolute].
  void read(const std::string& mesh, const std::string& data, std::span<const int> ids, double time,
            std::span<double> values) const;
  /// What was written since the last call, as the coupler takes it; from here on it is zero. Vectors have
  /// three components where Strake knows the quantity.
  std::vector<Field> take_fields();

  /// The partner's fields where the run begins, on its own mesh. They are taken where that mesh has the
  /// points of `mesh`; else, and where one is missing, a field begins at zero.
  void begin(const InterfaceMesh& partner, const std::vector<Field>& fields, const InterfaceMesh& mesh);
  /// The partner's fields over a window. Error if one that is read is missing or has other components.
  void receive(const Window&, const Input&);
  void commit();

  bool writes(const std::string& mesh, const std::string& data) const;
  bool reads(const std::string& mesh, const std::string& data) const;

 private:
  struct Entry {
    std::string mesh, data;
    Quantity quantity;
    int components;         // in the solver
    Eigen::MatrixXd value;  // components×n, of what is written; empty: nothing yet
    Waveform waveform;      // of what is read
    std::string text() const { return "data \"" + data + "\" of mesh \"" + mesh + "\""; }
  };
  Entry entry(const PreciceConfig&, const PreciceConfig::MeshData&, const QuantityNames&) const;
  const Entry* find(const std::vector<Entry>&, const std::string& mesh, const std::string& data) const;
  void check_sizes(const Entry&, std::size_t ids, std::size_t values) const;
  std::string listed(const std::vector<Entry>&) const;
  Values from_partner(const Entry&, const Field&) const;

  std::vector<Entry> written_, read_;
  int n_points_ = 0;
};

}  // namespace strake
