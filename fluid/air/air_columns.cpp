#include "fluid/air/air_columns.hpp"

namespace strake::fluid {

AirColumns<1> air_strip(const Eigen::VectorXd& middle, const Eigen::VectorXd& width) {
  AirColumns<1> columns;
  columns.place = middle.transpose();
  columns.area = width;
  const auto side = [&](int column, int other, double normal, double x) {
    AirColumns<1>::Side made{.column = column, .other = other};
    made.normal[0] = normal;
    made.middle[0] = x;
    columns.sides.push_back(made);
  };
  const auto n = static_cast<int>(middle.size());
  side(0, -1, -1, middle[0] - 0.5 * width[0]);
  for (int i = 0; i + 1 < n; ++i) side(i, i + 1, 1, middle[i] + 0.5 * width[i]);
  side(n - 1, -1, 1, middle[n - 1] + 0.5 * width[n - 1]);
  return columns;
}

AirColumns<1> air_strip(double low, double high, int n) {
  const double width = (high - low) / n;
  return air_strip(Eigen::VectorXd::LinSpaced(n, low + 0.5 * width, high - 0.5 * width),
                   Eigen::VectorXd::Constant(n, width));
}

}  // namespace strake::fluid
