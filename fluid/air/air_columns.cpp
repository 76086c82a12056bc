#include "fluid/air/air_columns.hpp"

namespace strake::fluid {

AirColumns<1> air_strip(double low, double high, int n) {
  AirColumns<1> columns;
  const double width = (high - low) / n;
  columns.place.resize(1, n);
  columns.area.setConstant(n, width);
  const auto side = [&](int column, int other, double normal, double x) {
    AirColumns<1>::Side made{.column = column, .other = other};
    made.normal[0] = normal;
    made.middle[0] = x;
    columns.sides.push_back(made);
  };
  side(0, -1, -1, low);
  for (int i = 0; i < n; ++i) {
    columns.place(0, i) = low + (i + 0.5) * width;
    if (i + 1 < n) side(i, i + 1, 1, low + (i + 1) * width);
  }
  side(n - 1, -1, 1, high);
  return columns;
}

}  // namespace strake::fluid
