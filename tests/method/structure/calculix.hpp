#pragma once

#include "structure/body/parameters.hpp"
#include "structure/deck/deck.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace strake::structure {

/// Skips the test, and says why, where CalculiX is not installed.
#define STRAKE_NEEDS_CALCULIX()                       \
  if (std::system("command -v ccx > /dev/null") != 0) \
  GTEST_SKIP() << "ccx is not installed (Debian: apt install calculix-ccx)"

/// The plate of cases/plate_entry.toml as it meets the water.
inline Parameters entering_plate() {
  Parameters p;
  p.plate = {.length = 0.4,
             .thickness = 0.02,
             .bottom = {0, 0.012, 0},
             .left = Support::clamped,
             .right = Support::clamped};
  p.velocity = {0, -6.26, 0};
  p.gravity = {0, -9.81, 0};
  return p;
}

/// Displacements of the printed nodes at one time.
struct Printed {
  double time = 0;                      // [s]
  std::map<int, Eigen::Vector3d> node;  // from 0
};

/// What *NODE PRINT has left in a .dat file:
///   displacements (vx,vy,vz) for set PROBES and time  0.1000000E-04
///   <empty>
///        159 -5.9E-17 -3.6E-03  0.0E+00
inline std::vector<Printed> read_printed(const std::filesystem::path& file) {
  std::vector<Printed> all;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t at = line.find("and time");
    if (line.find("displacements") != std::string::npos && at != std::string::npos) {
      all.push_back({.time = std::strtod(line.c_str() + at + 8, nullptr), .node = {}});
      continue;
    }
    std::istringstream words(line);
    int node = 0;
    Eigen::Vector3d u;
    if (!all.empty() && words >> node >> u.x() >> u.y() >> u.z()) all.back().node[node - 1] = u;
  }
  return all;
}

/// Runs a deck; the displacement of each probe at each printed time, probe after probe.
inline std::vector<std::vector<Eigen::Vector3d>> run_calculix(const deck::Model& m, const std::string& text) {
  const TemporaryFolder folder;
  put(folder / "deck.inp", text);
  const std::string in_folder =
      "cd '" + folder.path().string() + "' && OMP_NUM_THREADS=1 ccx -i deck > log 2>&1";
  const int code = std::system(in_folder.c_str());
  EXPECT_EQ(code, 0);
  std::vector<std::vector<Eigen::Vector3d>> probes(m.probe.size());
  for (const Printed& printed : read_printed(folder / "deck.dat"))
    for (std::size_t p = 0; p < probes.size(); ++p) {
      Eigen::Vector3d u = Eigen::Vector3d::Zero();
      for (deck::Weights::InnerIterator it(m.probe_weights, static_cast<Eigen::Index>(p)); it; ++it)
        u += it.value() * printed.node.at(static_cast<int>(it.col()));
      probes[p].push_back(u);
    }
  if (code != 0 || (!probes.empty() && probes.front().empty())) {
    std::ifstream log(folder / "log");
    std::ostringstream all;
    all << log.rdbuf();
    ADD_FAILURE() << "ccx:\n" << all.str().substr(all.str().size() > 2000 ? all.str().size() - 2000 : 0);
  }
  return probes;
}

}  // namespace strake::structure
