#pragma once

#include "coupler/precice/config/precice_config.hpp"
#include "coupler/precice/config/quantities.hpp"

#include <string>
#include <vector>

namespace strake {

/// What a preCICE configuration says of one participant: its mesh, and what it reads and writes there.
struct OwnPart {
  struct Data {
    std::string name;      // preCICE's
    std::string quantity;  // Strake's: "force"
    int components = 0;    // in preCICE: 1, or the dimension of the mesh
  };
  std::string participant, mesh;
  int dimension = 3;
  std::vector<Data> reads, writes;
  bool reads_samples = false, writes_samples = false;  // substeps: values inside a window as well

  /// Error(case_file) with the file: no such participant, with the list of those that are there; not exactly
  /// one mesh of its own; data on the partner's mesh; a quantity that has another number of components.
  static OwnPart of(const PreciceConfig&, const std::string& participant, const QuantityNames&);

  /// Tests that a solver of that side ("fluid", "structure") can play this part. A fluid takes displacement
  /// and velocity and gives force; a structure takes force and gives displacement and velocity.
  /// Error(case_file) with these lists for other data, for nothing to give, and for a fluid without a
  /// displacement.
  void check_data(const std::string& side, const std::string& config) const;
  /// Error(case_file) if the mesh has other dimensions than the case.
  void check_dimension(int of_case, const std::string& config) const;
};

}  // namespace strake
