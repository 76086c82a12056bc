#include "structure/ccx/output.hpp"

#include "structure/material/stress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

namespace strake::structure::ccx {
namespace {

constexpr double unset = std::numeric_limits<double>::quiet_NaN();

/// Reads a number in a column of fixed width. An exponent of three digits replaces its letter E.
double number(std::string_view line, std::size_t from, std::size_t width) {
  if (from >= line.size()) return unset;
  std::string text(line.substr(from, width));
  text.erase(std::remove(text.begin(), text.end(), ' '), text.end());
  if (text.find('E') == std::string::npos)
    if (const std::size_t sign = text.find_first_of("+-", 1); sign != std::string::npos)
      text.insert(sign, "E");
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end == text.c_str() || *end != '\0' ? unset : value;
}

bool complete(const Printed& p, bool with_velocity) {
  return p.displacement.allFinite() && (!with_velocity || p.velocity.allFinite()) &&
         std::isfinite(p.strain) && std::isfinite(p.kinetic);
}

}  // namespace

//  displacements (vx,vy,vz) for set WANTED and time  0.1000000E-04
//
//         62  3.531339E-24  3.175739E-08  0.000000E+00
//
//  total internal energy for set BODY and time  0.1000000E-04
//
//         1.103277E-04
std::vector<Printed> read_printed(const std::filesystem::path& file, const std::vector<int>& node,
                                  int n_nodes) {
  constexpr std::size_t first = 10, width = 14;  // of a node's columns
  std::vector<Eigen::Index> column(static_cast<std::size_t>(n_nodes) + 1, -1);
  for (std::size_t i = 0; i < node.size(); ++i)
    column[static_cast<std::size_t>(node[i]) + 1] = static_cast<Eigen::Index>(i);
  const auto k = static_cast<Eigen::Index>(node.size());

  std::vector<Printed> all;
  Points* values = nullptr;
  double* energy = nullptr;
  bool with_velocity = false;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (const std::size_t at = line.find("and time"); at != std::string::npos) {
      values = nullptr;
      energy = nullptr;
      if (line.find("displacements") != std::string::npos) {
        all.push_back({.time = std::strtod(line.c_str() + at + 8, nullptr),
                       .displacement = Points::Constant(3, k, unset),
                       .velocity = {},
                       .strain = unset,
                       .kinetic = 0});
        values = &all.back().displacement;
      } else if (all.empty()) {
        continue;
      } else if (line.find("velocities") != std::string::npos) {
        with_velocity = true;
        all.back().velocity = Points::Constant(3, k, unset);
        values = &all.back().velocity;
      } else if (line.find("internal energy") != std::string::npos) {
        energy = &(all.back().strain = unset);
      } else if (line.find("kinetic energy") != std::string::npos) {
        energy = &(all.back().kinetic = unset);
      }
      continue;
    }
    if (line.find_first_not_of(' ') == std::string::npos) continue;
    if (energy != nullptr) *energy = number(line, 0, line.size());
    if (values == nullptr) continue;
    const long id = std::strtol(line.c_str(), nullptr, 10);
    if (id < 1 || id > n_nodes || column[static_cast<std::size_t>(id)] < 0) continue;
    auto value = values->col(column[static_cast<std::size_t>(id)]);
    for (Eigen::Index i = 0; i < 3; ++i)
      value(i) = number(line, first + width * static_cast<std::size_t>(i), width);
  }
  while (!all.empty() && !complete(all.back(), with_velocity)) all.pop_back();
  return all;
}

//      MODE NO    EIGENVALUE                       FREQUENCY
//           1   0.1895207E+08   0.4353397E+04   0.6928647E+03   0.0000000E+00
std::vector<double> read_frequencies(const std::filesystem::path& file) {
  std::vector<double> frequencies;
  std::ifstream stream(file);
  bool table = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.find("E I G E N V A L U E") != std::string::npos) table = true;
    if (line.find("P A R T I C I P A T I O N") != std::string::npos) break;
    if (!table) continue;
    char* end = nullptr;
    if (std::strtol(line.c_str(), &end, 10) < 1) continue;
    std::strtod(end, &end);                            // ω²
    std::strtod(end, &end);                            // ω
    frequencies.push_back(std::strtod(end, nullptr));  // f
  }
  return frequencies;
}

//   100CL  101 1.00000E-05         133                     1    1           1
//  -4  DISP        4    1
//  -1         2 3.53741E-09 2.71224E-08 0.00000E+00
//  -3
std::vector<BodyField> read_fields(const std::filesystem::path& file, int n_nodes) {
  constexpr std::size_t name_at = 5, first = 13, width = 12, time_at = 12;
  enum class Block { none, displacement, velocity, stress } block = Block::none;
  std::vector<BodyField> all;
  double time = 0;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, 7, "  100CL") == 0) {
      time = number(line, time_at, width);
      block = Block::none;
    } else if (line.compare(0, 3, " -4") == 0) {
      const std::string_view name = std::string_view(line).substr(std::min(name_at, line.size()));
      block = name.starts_with("DISP")     ? Block::displacement
              : name.starts_with("VELO")   ? Block::velocity
              : name.starts_with("STRESS") ? Block::stress
                                           : Block::none;
      if (block == Block::displacement)
        all.push_back({.time = time,
                       .displacement = Points::Zero(3, n_nodes),
                       .velocity = Points::Zero(3, n_nodes),
                       .von_mises = Eigen::VectorXd::Zero(n_nodes)});
      if (all.empty()) block = Block::none;
    } else if (block != Block::none && line.compare(0, 3, " -1") == 0) {
      const long id = std::strtol(line.substr(3, 10).c_str(), nullptr, 10);
      if (id < 1 || id > n_nodes) continue;
      const auto component = [&](std::size_t i) { return number(line, first + width * i, width); };
      const Eigen::Vector3d vector(component(0), component(1), component(2));
      if (block == Block::displacement) all.back().displacement.col(id - 1) = vector;
      if (block == Block::velocity) all.back().velocity.col(id - 1) = vector;
      if (block == Block::stress)
        all.back().von_mises(id - 1) =
            von_mises(Stress(vector.x(), component(3), component(5), vector.y(), component(4), vector.z()));
    }
  }
  return all;
}

}  // namespace strake::structure::ccx
