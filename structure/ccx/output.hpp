#pragma once

#include "structure/deck/model.hpp"

#include <filesystem>
#include <vector>

namespace strake::structure::ccx {

/// What CalculiX has printed of the wanted nodes after one increment, relative to the supports.
struct Printed {
  double time = 0;                 // [s]
  Points displacement, velocity;   // 3×k [m], [m/s]; the velocity is empty after statics
  double strain = 0, kinetic = 0;  // [J] of the model, as thick as it is
};

/// Reads all complete increments of a .dat file. Empty if there is none.
std::vector<Printed> read_printed(const std::filesystem::path&, const std::vector<int>& node, int n_nodes);

/// The natural frequencies [Hz] in a .dat file, ascending.
std::vector<double> read_frequencies(const std::filesystem::path&);

/// The whole body at one time, relative to the supports.
struct BodyField {
  double time = 0;                // [s]
  Points displacement, velocity;  // 3×n [m], [m/s]
  Eigen::VectorXd von_mises;      // n [Pa], mean of the cells that meet in a node
};

/// Reads a .frd file (text).
std::vector<BodyField> read_fields(const std::filesystem::path&, int n_nodes);

}  // namespace strake::structure::ccx
