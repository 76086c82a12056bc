#include "coupler/summary/hulls.hpp"

#include <algorithm>
#include <cstddef>

namespace strake {

// Between the crossings of even and odd number lies the body.
std::vector<std::array<double, 2>> hulls_at(const InterfaceMesh& body, double y) {
  std::vector<double> crossings;
  for (Eigen::Index f = 0; f < body.faces.cols(); ++f) {
    const Eigen::Vector3d a = body.position.col(body.faces(0, f)), b = body.position.col(body.faces(1, f));
    if ((a.y() <= y) != (b.y() <= y))
      crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  std::vector<std::array<double, 2>> hulls;
  if (crossings.size() % 2 != 0) return hulls;
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t k = 0; k < crossings.size(); k += 2) {
    const double left = crossings[k], right = crossings[k + 1];
    const auto below = [&](const auto& X) { return X[1] <= y && X[0] > hulls.back()[1] && X[0] < left; };
    bool joined = false;
    for (Eigen::Index i = 0; !hulls.empty() && i < body.position.cols(); ++i)
      joined = joined || below(body.position.col(i));
    if (joined)
      hulls.back()[1] = right;
    else
      hulls.push_back({left, right});
  }
  return hulls;
}

std::optional<Hollow> hollow_below(const InterfaceMesh& body, double level) {
  std::optional<Hollow> widest;
  if (body.dimension != 2 || body.position.cols() == 0) return widest;
  constexpr int heights = 100;
  const double lowest = body.position.row(1).minCoeff(), step = (level - lowest) / heights;
  std::vector<Hollow> open;  // not yet under a roof
  for (int k = 0; step > 0 && k < heights; ++k) {
    const double y = lowest + (k + 0.5) * step;
    const auto hulls = hulls_at(body, y);
    for (const Hollow& hollow : open)
      for (const auto& [left, right] : hulls)
        if (left <= hollow.left && right >= hollow.right)
          if (!widest || hollow.right - hollow.left > widest->right - widest->left) {
            widest = hollow;
            widest->roof = y;
          }
    std::erase_if(open, [&](const Hollow& hollow) { return widest && widest->left == hollow.left; });
    for (std::size_t i = 1; i < hulls.size(); ++i) {
      const double left = hulls[i - 1][1], right = hulls[i][0];
      const bool known = std::any_of(open.begin(), open.end(), [&](const Hollow& hollow) {
        return left < hollow.right && right > hollow.left;
      });
      if (!known) open.push_back({.left = left, .right = right, .mouth = y, .roof = y});
    }
  }
  return widest;
}

}  // namespace strake
