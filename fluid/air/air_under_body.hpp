#pragma once

#include "fluid/air/air_layer.hpp"
#include "fluid/air/near_columns.hpp"
#include "fluid/air/surface_response.hpp"
#include "fluid/scheme/step_data.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace strake::fluid {

/// The air between the lower faces of a body and the water, as columns under its wet points (fluid/THEORY.md,
/// section 17a). Everything that changes is in State (air_…). The water feels the pressure on its surface
/// (StepData::air), the dry faces feel the same pressure on the same area.
template <int dim>
class AirUnderBody {
 public:
  static constexpr int plane = dim - 1;
  /// Builds the columns, and the start of their air where the state has none. Throws Error(case_file) where
  /// no face looks down, or where one starts in the water.
  AirUnderBody(const AirKeys&, StepData<dim>&);

  /// Gives faces over to contact with the water: those whose air is pressed and down to the film, or stiffer
  /// than the water's inertia in a step. Called before the faces are found wet or dry.
  void give_over(StepData<dim>&);
  /// Advances the air by the step, and finds the pressure on which air and surface agree (F82). Writes
  /// StepData::air. Called with the velocities that the step before has left.
  void advance(StepData<dim>&);
  /// Adds −p n A of the columns to the force on the wet points [N].
  void add_load(const StepData<dim>&, Vectors<dim>& on_points) const;
  /// Number of columns, their area [m², in the plane m], half the width of the largest field [m].
  struct Extent {
    std::int64_t columns;
    double area, half_width;
  };
  Extent extent() const;
  /// The column under the face whose wet points were nearest to a place of the reference, and how far [m].
  struct Found {
    Eigen::Index column;
    double distance;
  };
  Found column_at(const BodySurface<dim>&, const Eigen::Vector3d& reference) const;
  /// Calls visit(row, gap, pressure) for each first-layer particle behind a face with air: h [m], and p less
  /// that of the open air [Pa].
  template <class Visit>
  void for_each_row(const State<dim>& state, const Visit& visit) const {
    for (std::size_t c = 0; c < columns_.size(); ++c)
      if (const auto i = static_cast<Eigen::Index>(c); state.air_mass[i] > 0)
        for (const std::int64_t row : columns_[c].rows) visit(row, state.air_gap[i], state.air_pressure[i]);
  }
  /// Mass of the columns together [kg], in the plane [kg/m].
  double mass(const Eigen::VectorXd& of_columns) const { return of_columns.dot(area_); }
  /// Energy of the air against the open air [J], in the plane [J/m] (F83).
  double energy(const State<dim>&) const;

 private:
  using Place = Eigen::Matrix<double, plane, 1>;
  /// A piece of the open border, from the middle of its column.
  struct Border {
    Place middle, normal;
    double length = 0;
  };
  struct Column {
    std::vector<int> points;         // wet points over it
    std::vector<std::int64_t> rows;  // first-layer particles behind them
    Place offset = Place::Zero();    // its middle from the mean of those points
    std::vector<Border> borders;
  };
  /// The faces over the columns, at the start of a step.
  struct Faces {
    Eigen::Matrix<double, plane, Eigen::Dynamic> place;  // of the columns, seen from above [m]
    Eigen::VectorXd height, speed;                       // [m], upwards [m/s]
  };
  /// Means of the water in the surface's first row before each column.
  struct Sample {
    Eigen::VectorXd velocity, pressure, level, weight;  // upwards [m/s]; [Pa]; of the surface [m]; Σ
  };
  static Place from_above(const Vector<dim>&);
  Eigen::Index size() const { return static_cast<Eigen::Index>(columns_.size()); }
  Eigen::Index first_of(std::size_t layer) const { return first_[layer]; }
  Eigen::Index count_of(std::size_t layer) const { return first_[layer + 1] - first_[layer]; }
  using Near = std::vector<NearColumns<plane>>;  // of each field
  Faces faces(const StepData<dim>&) const;
  Near near(const Faces&, double spacing) const;
  Sample sample(const StepData<dim>&, const Faces&, const Near&) const;
  void find_columns(const StepData<dim>&);
  void begin(StepData<dim>&);
  void set_aired(Eigen::Index column, StepData<dim>&, std::uint8_t has) const;  // of its wet points
  bool is_aired(Eigen::Index column, const StepData<dim>&) const;
  /// Advances the velocity of the surface against the row below it by the step (F95).
  void let_surface_follow(std::size_t layer, const AirState<plane>&, StepData<dim>&) const;
  void press_surface(StepData<dim>&, const Faces&, const Near&) const;
  AirState<plane> air_of(const State<dim>&, std::size_t layer) const;
  void store(const AirState<plane>&, std::size_t layer, State<dim>&) const;

  AirKeys keys_;
  std::vector<Column> columns_;                   // field after field
  std::vector<AirLayer<plane>> layer_;            // of each field of faces
  std::vector<SurfaceResponse<plane>> response_;  // of the water below each
  std::vector<Eigen::Index> first_{0};            // column of each field, and their number
  std::vector<int> columns_over_;                 // under each wet point
  Eigen::VectorXd area_;                          // of the columns [m²], on a line [m]
};

}  // namespace strake::fluid
