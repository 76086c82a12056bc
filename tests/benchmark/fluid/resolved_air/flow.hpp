#pragma once

#include "tests/benchmark/fluid/resolved_air/faces.hpp"

#include <cstddef>
#include <functional>
#include <vector>

namespace resolved_air {

/// What ends the columns beside the plate at their top.
enum class Top { wall, open };

/// Columns and rows. Rows move: the face j stands at y_j(0) + w_j t. The plate's face is the row face
/// `plate_row` over the first `plate_columns` columns; above it is the body.
struct Grid {
  std::vector<double> width;          // [m] of the columns
  std::vector<double> face;           // [m] height of the row faces at the start
  std::vector<double> face_velocity;  // [m/s], up
  std::size_t plate_columns = 0, plate_row = 0;
  Top top = Top::open;

  std::size_t columns() const { return width.size(); }
  std::size_t rows() const { return face.size() - 1; }
  std::size_t first_column(std::size_t row) const { return row < plate_row ? 0 : plate_columns; }
  std::size_t rows_of(std::size_t column) const { return column < plate_columns ? plate_row : rows(); }
};

/// Widths that grow by about the given ratio from `first` to at most `largest` and sum up to `length`.
std::vector<double> graded(double length, double first, double ratio, double largest);

/// Masses [kg/m] of both fluids.
struct Masses {
  double air = 0, water = 0;
};

/// How the fluids move against each other along x.
enum class Slip {
  free,  // each has its own velocity, but where the surface is steeper than 45°
  none   // both have one velocity
};

/// The flow of air and water on a grid whose rows move, in two dimensions, without viscosity and gravity.
/// Finite volumes: d(V m_k)/dt = −Σ A m_k (u_k − w), d(V ρu)/dt = −Σ A (Σ_k m_k u_k (u_k − w) + p n).
/// The surface is nearly level here: the fluids share the velocity up and slip along x. One velocity for both
/// makes the water take the air's momentum in the row of the surface. A row or two of slow air then follow
/// the surface, a first-order error: the wind of the self-check loses 22 % with 48 rows and 13 % with 96.
class Flow {
 public:
  /// air_fraction: of the cell around (x, y) at the start; velocity is zero, pressure ambient.
  Flow(const Grid& grid, const std::function<double(double, double)>& air_fraction, Slip slip = Slip::free);

  /// Gives air at rest a pressure at the start; only where no cell holds water.
  void set_air_pressure(const std::function<double(double, double)>& pressure);
  /// Gives the air a velocity along x at the start.
  void set_air_velocity(double velocity);

  /// One step of at most `longest` seconds in two stages (Heun); returns its length.
  double step(double longest, double courant = 0.4);

  double time() const { return time_; }
  const Grid& grid() const { return grid_; }
  const Cell& cell(std::size_t column, std::size_t row) const { return cells_[at(column, row)]; }
  double height(std::size_t row) const { return grid_.face[row] + grid_.face_velocity[row] * time_; }
  /// Absolute pressure on the wall at the top of a column, now.
  const std::vector<double>& top_pressure() const { return top_pressure_; }
  Masses masses() const;
  /// Masses that have left through the top.
  const Masses& left() const { return left_; }
  /// Mass of the air under the plate per length across [kg/m].
  double air_under_plate() const;
  /// Thickness of all air in a column under the plate [m].
  double air_thickness(std::size_t column) const;

 private:
  std::size_t at(std::size_t column, std::size_t row) const { return row * grid_.columns() + column; }
  void read_cells();
  void read_cell(std::size_t column, std::size_t row);
  void find_surface(std::size_t column, std::size_t row);
  void share_velocity(std::size_t k);
  void find_rates();
  void sweep_row(std::size_t row);
  void sweep_column(std::size_t column);
  void face_states(std::size_t k, double Cell::*steep);

  Grid grid_;
  Slip slip_;
  double time_ = 0;
  std::vector<Content> content_, rate_;
  std::vector<Cell> cells_;
  std::vector<double> top_pressure_;
  Masses left_, leaving_;              // [kg/m], [kg/(m s)]
  double fastest_ = 0;                 // [1/s] largest wave speed over width
  std::vector<Cell> line_;             // a row or column with one image beyond either end
  std::vector<double> size_;           // [m] of the cells of the line
  std::vector<FaceState> low_, high_;  // of the cells of the line
};

}  // namespace resolved_air
