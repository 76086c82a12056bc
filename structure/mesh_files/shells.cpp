#include "proto/error.hpp"
#include "structure/mesh_files/stl_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <unordered_map>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

struct Shell {
  Eigen::Matrix3Xi triangle;
  double volume = 0;  // [unit³] positive: normals outside
  Vector3d min, max;
  int around = 0;  // how many other shells enclose it
};

/// The piece of each triangle: those that share an edge are one piece. Numbers are those of first triangles.
std::vector<int> pieces(const ClosedSurface& surface) {
  std::vector<int> up(static_cast<std::size_t>(surface.triangle.cols()));
  std::iota(up.begin(), up.end(), 0);
  const auto root = [&](int i) {
    while (up[static_cast<std::size_t>(i)] != i) {
      int& above = up[static_cast<std::size_t>(i)];
      above = up[static_cast<std::size_t>(above)];
      i = above;
    }
    return i;
  };
  std::unordered_map<std::uint64_t, int> seen;  // edge → a triangle of it
  for (int t = 0; t < static_cast<int>(up.size()); ++t)
    for (Index k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({surface.triangle(k, t), surface.triangle((k + 1) % 3, t)});
      const auto [found, fresh] =
          seen.emplace(static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high), t);
      if (fresh) continue;
      const int a = root(t), b = root(found->second);
      up[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  for (int t = 0; t < static_cast<int>(up.size()); ++t) up[static_cast<std::size_t>(t)] = root(t);
  return up;
}

std::vector<Shell> shells_of(const ClosedSurface& surface) {
  std::map<int, std::vector<Index>> members;
  const std::vector<int> piece = pieces(surface);
  for (Index t = 0; t < surface.triangle.cols(); ++t)
    members[piece[static_cast<std::size_t>(t)]].push_back(t);
  std::vector<Shell> shells;
  for (const auto& [number, triangles] : members) {
    Shell shell;
    shell.triangle.resize(3, static_cast<Index>(triangles.size()));
    shell.min = shell.max = surface.point.col(surface.triangle(0, number));
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      shell.triangle.col(static_cast<Index>(i)) = surface.triangle.col(triangles[i]);
      for (Index k = 0; k < 3; ++k) {
        const Vector3d X = surface.point.col(surface.triangle(k, triangles[i]));
        shell.min = shell.min.cwiseMin(X);
        shell.max = shell.max.cwiseMax(X);
      }
    }
    shell.volume = volume_of({.point = surface.point, .triangle = shell.triangle});
    shells.push_back(std::move(shell));
  }
  return shells;
}

/// Whether a shell lies in the box of another and the middle of its first triangle in the other itself.
bool encloses(const Points& point, const Shell& outer, const Shell& inner) {
  if ((inner.min.array() < outer.min.array()).any() || (inner.max.array() > outer.max.array()).any())
    return false;
  Vector3d X = Vector3d::Zero();
  for (Index k = 0; k < 3; ++k) X += point.col(inner.triangle(k, 0)) / 3;
  return std::abs(winding_number(point, outer.triangle, X)) > 0.5;
}

}  // namespace

std::string place_text(const Vector3d& X) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", X.x(), X.y(), X.z());
}

void sort_shells(ClosedSurface& surface, const std::string& file) {
  constexpr std::size_t most = 1000;   // each is compared with all others
  constexpr double no_volume = 1e-12;  // of the cube of the extent
  std::vector<Shell> shells = shells_of(surface);
  const auto refuse = [&](const std::string& problem, const std::string& fix) {
    throw Error(ExitCode::case_file, file, problem, fix);
  };
  if (shells.size() > most)
    refuse(fmt::format("{} separate pieces, at most {} are read", shells.size(), most),
           "export the outer hull alone, without fittings");
  std::size_t hollows = 0, turned = 0;
  for (Shell& shell : shells) {
    const Vector3d at = surface.point.col(shell.triangle(0, 0));
    if (std::abs(shell.volume) < no_volume * std::pow((shell.max - shell.min).maxCoeff(), 3))
      refuse(fmt::format("the piece at {} encloses no volume", place_text(at)),
             "export a solid body, not a sheet");
    for (const Shell& other : shells)
      if (&other != &shell && encloses(surface.point, other, shell)) ++shell.around;
    if (shell.around > 1)
      refuse(fmt::format("the piece at {} lies inside {} others", place_text(at), shell.around),
             "leave out what lies inside a hollow");
    if (shell.around == 1) ++hollows;
    if ((shell.volume > 0) == (shell.around == 0)) continue;
    shell.triangle.row(1).swap(shell.triangle.row(2));
    ++turned;
  }
  std::stable_sort(shells.begin(), shells.end(),
                   [](const Shell& a, const Shell& b) { return a.around < b.around; });
  Index filled = 0;
  surface.outer = 0;
  for (const Shell& shell : shells) {
    surface.triangle.middleCols(filled, shell.triangle.cols()) = shell.triangle;
    filled += shell.triangle.cols();
    if (shell.around == 0) surface.outer = filled;
  }
  if (shells.size() > 1)
    surface.lines.push_back(fmt::format(
        "{} separate pieces, {} of them hollows that stay dry and have no mass", shells.size(), hollows));
  if (turned > 0)
    surface.lines.push_back(fmt::format(
        "{} of {} pieces had normals that point into the material: turned over", turned, shells.size()));
}

}  // namespace strake::structure
