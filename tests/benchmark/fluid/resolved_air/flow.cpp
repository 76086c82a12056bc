#include "tests/benchmark/fluid/resolved_air/flow.hpp"

#include <algorithm>
#include <cmath>

namespace resolved_air {

namespace {

/// Steepness β of the interface across its normal [1 per cell]. With 2 and 3 the largest mean pressure at
/// 6.26 m/s changes by −0.7 and +0.9 %, the air left at contact by +2.7 and −1.4 % (rows of 1 mm).
constexpr double interface_steepness = 2.5;
/// A cell with less of either fluid holds no interface.
constexpr double interface_least = 1e-7;
/// Below this steepness a cell counts as uniform along the axis.
constexpr double steepness_least = 0.05;

/// Slope between neighbours: harmonic mean of both one-sided slopes, 0 at extremes (van Leer 1977).
double limited(double below, double above) {
  const double product = below * above;
  return product > 0 ? 2 * product / (below + above) : 0;
}

}  // namespace

std::vector<double> graded(double length, double first, double ratio, double largest) {
  std::vector<double> widths;
  double sum = 0;
  for (double w = first; sum < length - 0.5 * w; w = std::min(w * ratio, largest)) {
    widths.push_back(w);
    sum += w;
  }
  // What is missing is shared out in proportion to w − first, so that the finest cells keep their width.
  double share = 0;
  for (const double w : widths) share += w - first;
  const double missing = length - sum;
  for (double& w : widths)
    w += share > 0 ? missing * (w - first) / share : missing / static_cast<double>(widths.size());
  return widths;
}

Flow::Flow(const Grid& grid, const std::function<double(double, double)>& air_fraction, Slip slip)
    : grid_(grid),
      slip_(slip),
      content_(grid.columns() * grid.rows()),
      rate_(content_.size()),
      cells_(content_.size()),
      top_pressure_(grid.columns(), ambient_pressure) {
  double x = 0;
  for (std::size_t i = 0; i < grid_.columns(); ++i) {
    for (std::size_t j = 0; j < grid_.rows_of(i); ++j) {
      const double y = 0.5 * (grid_.face[j] + grid_.face[j + 1]);
      const double fraction = air_fraction(x + 0.5 * grid_.width[i], y);
      const double volume = grid_.width[i] * (grid_.face[j + 1] - grid_.face[j]);
      content_[at(i, j)] = {.air = volume * fraction * ambient_air,
                            .water = volume * (1 - fraction) * ambient_water};
    }
    x += grid_.width[i];
  }
  const std::size_t longest = std::max(grid_.columns(), grid_.rows());
  line_.resize(longest + 2);
  size_.resize(longest + 2);
  low_.resize(longest + 2);
  high_.resize(longest + 2);
  read_cells();
  find_rates();
}

void Flow::set_air_pressure(const std::function<double(double, double)>& pressure) {
  double x = 0;
  for (std::size_t i = 0; i < grid_.columns(); ++i) {
    for (std::size_t j = 0; j < grid_.rows_of(i); ++j) {
      const double y = 0.5 * (height(j) + height(j + 1));
      content_[at(i, j)].air =
          grid_.width[i] * (height(j + 1) - height(j)) * air_density(pressure(x + 0.5 * grid_.width[i], y));
    }
    x += grid_.width[i];
  }
  read_cells();
  find_rates();
}

void Flow::set_air_velocity(double velocity) {
  for (Content& content : content_) content.along_air = content.air * velocity;
  read_cells();
  find_rates();
}

void Flow::read_cells() {
  for (std::size_t j = 0; j < grid_.rows(); ++j)
    for (std::size_t i = grid_.first_column(j); i < grid_.columns(); ++i) read_cell(i, j);
  for (std::size_t j = 0; j < grid_.rows(); ++j)
    for (std::size_t i = grid_.first_column(j); i < grid_.columns(); ++i) find_surface(i, j);
}

void Flow::read_cell(std::size_t column, std::size_t row) {
  const Content& content = content_[at(column, row)];
  Cell& cell = cells_[at(column, row)];
  const double volume = grid_.width[column] * (height(row + 1) - height(row));
  const double air = content.air / volume, water = content.water / volume;
  cell.pressure = mixture_pressure(air, water, cell.pressure);
  cell.air_density = ambient_air;
  if (air > 0) cell.air_density = water > 0 ? air_density(cell.pressure) : air;
  const double air_volume = air / cell.air_density, water_volume = water / water_density(cell.pressure);
  cell.filled = std::min(1.0, air_volume + water_volume);
  cell.fraction = air_volume / (air_volume + water_volume);
  cell.up = content.up / (content.air + content.water);
  cell.along_air = content.air > 0 ? content.along_air / content.air : 0;
  cell.along_water = content.water > 0 ? content.along_water / content.water : cell.along_air;
  if (content.air <= 0) cell.along_air = cell.along_water;
}

void Flow::share_velocity(std::size_t k) {
  Content& content = content_[k];
  const double mean = (content.along_air + content.along_water) / (content.air + content.water);
  content.along_air = content.air * mean;
  content.along_water = content.water * mean;
  cells_[k].along_air = cells_[k].along_water = mean;
}

void Flow::find_surface(std::size_t i, std::size_t j) {
  // Steepness along x: β_x = β |g_x|/|g| (THINC with weighted slopes: Xiao, Ii and Chen 2011). The slopes g
  // are differences of the air's fraction over nine cells, weighted 1, 2, 1 across (Youngs 1984).
  Cell& cell = cells_[at(i, j)];
  cell.steep_along = cell.steep_up = 0;
  if (cell.fraction <= 0 || cell.fraction >= 1) return;
  if (cell.fraction < interface_least || cell.fraction > 1 - interface_least) return share_velocity(at(i, j));
  const auto fraction = [&](int right, int above) {
    const std::size_t row = above < 0 ? j - (j > 0) : j + (above > 0 && j + 1 < grid_.rows_of(i));
    const std::size_t first = grid_.first_column(row);
    const std::size_t column = right < 0 ? i - (i > first) : i + (right > 0 && i + 1 < grid_.columns());
    return cells_[at(column, row)].fraction;
  };
  double along = 0, up = 0;
  for (int across = -1; across <= 1; ++across) {
    const double weight = across == 0 ? 2 : 1;
    along += weight * (fraction(1, across) - fraction(-1, across));
    up += weight * (fraction(across, 1) - fraction(across, -1));
  }
  const double length = std::hypot(along, up);
  if (length > 0) {
    cell.steep_along = interface_steepness * std::abs(along) / length;
    cell.steep_up = interface_steepness * std::abs(up) / length;
  }
  const double high = grid_.face[j + 1] - grid_.face[j];
  if (slip_ == Slip::none || std::abs(along) * high >= std::abs(up) * grid_.width[i])
    share_velocity(at(i, j));
}

void Flow::face_states(std::size_t k, double Cell::*steep) {
  // q at a face = q ± (size/2) · limited slope (MUSCL: van Leer 1979); the fraction is sharp or uniform.
  const Cell &cell = line_[k], &below = line_[k - 1], &above = line_[k + 1];
  const double to_below = size_[k] / (size_[k - 1] + size_[k]);
  const double to_above = size_[k] / (size_[k] + size_[k + 1]);
  const auto change = [&](double Cell::*q) {
    return limited((cell.*q - below.*q) * to_below, (above.*q - cell.*q) * to_above);
  };
  Fractions fraction{cell.fraction, cell.fraction};
  if (cell.*steep > steepness_least &&
      (above.fraction - cell.fraction) * (cell.fraction - below.fraction) > 0)
    fraction = sharp_fractions(cell.fraction, cell.*steep, above.fraction > below.fraction);
  const double pressure = change(&Cell::pressure), up = change(&Cell::up);
  low_[k] = face_state(cell, fraction.low, cell.pressure - pressure);
  high_[k] = face_state(cell, fraction.high, cell.pressure + pressure);
  low_[k].up -= up;
  high_[k].up += up;
  if (std::min(below.fraction, above.fraction) > trace) {  // air on both sides
    const double along = change(&Cell::along_air);
    low_[k].along_air -= along;
    high_[k].along_air += along;
  }
  if (std::max(below.fraction, above.fraction) < 1 - trace) {  // water on both sides
    const double along = change(&Cell::along_water);
    low_[k].along_water -= along;
    high_[k].along_water += along;
  }
}

void Flow::sweep_row(std::size_t row) {
  const std::size_t first = grid_.first_column(row), count = grid_.columns() - first;
  const double length = height(row + 1) - height(row);
  for (std::size_t k = 0; k < count; ++k) {
    line_[k + 1] = cells_[at(first + k, row)];
    size_[k + 1] = grid_.width[first + k];
  }
  // Mirror images: both ends are walls at rest (tank, body, plane of symmetry).
  const auto mirror = [&](std::size_t image, std::size_t of) {
    line_[image] = line_[of];
    line_[image].along_air *= -1;
    line_[image].along_water *= -1;
    size_[image] = size_[of];
  };
  mirror(0, 1);
  mirror(count + 1, count);
  for (std::size_t k = 1; k <= count; ++k) face_states(k, &Cell::steep_along);
  ColumnFlux low = wall_flux(low_[1], -1);
  for (std::size_t k = 1; k <= count; ++k) {
    const ColumnFlux high = k < count ? column_flux(high_[k], low_[k + 1]) : wall_flux(high_[k], 1);
    if (k < count) fastest_ = std::max(fastest_, high.wave / std::min(size_[k], size_[k + 1]));
    Content& rate = rate_[at(first + k - 1, row)];
    rate.air += length * (low.carried.air - high.carried.air);
    rate.water += length * (low.carried.water - high.carried.water);
    rate.up += length * (low.carried.up - high.carried.up);
    // The surface inside the cell passes the cell's pressure from one fluid to the other.
    const double inside = line_[k].pressure * (high_[k].fraction - low_[k].fraction);
    rate.along_air +=
        length * (low.carried.along_air - high.carried.along_air + low.high_air - high.low_air + inside);
    rate.along_water += length * (low.carried.along_water - high.carried.along_water + low.high_water -
                                  high.low_water - inside);
    low = high;
  }
}

void Flow::sweep_column(std::size_t column) {
  const std::size_t count = grid_.rows_of(column);
  const double length = grid_.width[column];
  for (std::size_t k = 0; k < count; ++k) {
    line_[k + 1] = cells_[at(column, k)];
    size_[k + 1] = height(k + 1) - height(k);
  }
  const std::vector<double>& w = grid_.face_velocity;
  const auto mirror = [&](std::size_t image, std::size_t of, double wall_velocity) {
    line_[image] = line_[of];
    line_[image].up = 2 * wall_velocity - line_[of].up;
    size_[image] = size_[of];
  };
  mirror(0, 1, w[0]);
  mirror(count + 1, count, w[count]);
  const bool walled = column < grid_.plate_columns || grid_.top == Top::wall;
  const Cell open_air{.fraction = 1};
  if (!walled) line_[count + 1] = open_air;
  for (std::size_t k = 1; k <= count; ++k) face_states(k, &Cell::steep_up);
  low_[count + 1] = face_state(open_air, 1, ambient_pressure);
  Flux low{};
  low.pressure = wall_pressure(mixed_side(low_[1]), w[0], -1);
  for (std::size_t k = 1; k <= count; ++k) {
    Flux high{};
    const Side below = mixed_side(high_[k]);
    if (k == count && walled) {
      high.pressure = top_pressure_[column] = wall_pressure(below, w[k], 1);
    } else {
      high = flux_between(below, mixed_side(low_[k + 1]), w[k]);
      fastest_ = std::max(fastest_, high.wave / std::min(size_[k], size_[k + 1]));
    }
    Content& rate = rate_[at(column, k - 1)];
    rate.air += length * (low.air - high.air);
    rate.water += length * (low.water - high.water);
    rate.along_air += length * (low.beside_air - high.beside_air);
    rate.along_water += length * (low.beside_water - high.beside_water);
    rate.up += length * ((low.air + low.water) * low.velocity + low.pressure -
                         (high.air + high.water) * high.velocity - high.pressure);
    low = high;
  }
  leaving_.air += length * low.air;
  leaving_.water += length * low.water;
}

void Flow::find_rates() {
  std::fill(rate_.begin(), rate_.end(), Content{});
  leaving_ = {};
  fastest_ = 0;
  for (std::size_t j = 0; j < grid_.rows(); ++j) sweep_row(j);
  for (std::size_t i = 0; i < grid_.columns(); ++i) sweep_column(i);
}

double Flow::step(double longest, double courant) {
  // Heun: Q* = Q + Δt R(Q), Q' = (Q + Q* + Δt R(Q*))/2. Volumes are linear in time, so their change is exact.
  // A step ends with the rates of its end, which the next one begins with.
  const double dt = std::min(longest, courant / fastest_);
  const std::vector<Content> start = content_;
  const auto advance = [&](double kept, double share) {
    for (std::size_t k = 0; k < content_.size(); ++k) {
      Content& q = content_[k];
      const Content &r = rate_[k], &s = start[k];
      q = {.air = kept * s.air + share * (q.air + dt * r.air),
           .water = kept * s.water + share * (q.water + dt * r.water),
           .along_air = kept * s.along_air + share * (q.along_air + dt * r.along_air),
           .along_water = kept * s.along_water + share * (q.along_water + dt * r.along_water),
           .up = kept * s.up + share * (q.up + dt * r.up)};
    }
  };
  left_.air += 0.5 * dt * leaving_.air;
  left_.water += 0.5 * dt * leaving_.water;
  advance(0, 1);
  time_ += dt;
  read_cells();
  find_rates();
  left_.air += 0.5 * dt * leaving_.air;
  left_.water += 0.5 * dt * leaving_.water;
  advance(0.5, 0.5);
  read_cells();
  find_rates();
  return dt;
}

Masses Flow::masses() const {
  Masses sum;
  for (const Content& content : content_) {
    sum.air += content.air;
    sum.water += content.water;
  }
  return sum;
}

double Flow::air_under_plate() const {
  double sum = 0;
  for (std::size_t j = 0; j < grid_.plate_row; ++j)
    for (std::size_t i = 0; i < grid_.plate_columns; ++i) sum += content_[at(i, j)].air;
  return sum;
}

double Flow::air_thickness(std::size_t column) const {
  double sum = 0;
  for (std::size_t j = 0; j < grid_.rows_of(column); ++j) {
    const Cell& cell = cells_[at(column, j)];
    sum += (height(j + 1) - height(j)) * cell.filled * cell.fraction;
  }
  return sum;
}

}  // namespace resolved_air
