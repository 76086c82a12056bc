#pragma once

#include "fluid/air/air_layer.hpp"
#include "fluid/scheme/step_data.hpp"

#include <Eigen/Core>

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
  /// Mass of the columns together [kg/m].
  double mass(const Eigen::VectorXd& of_columns) const {
    return of_columns.dot(layer_.front().columns().area);
  }

 private:
  /// Means of the water in the surface's first row before each column.
  struct Sample {
    Eigen::VectorXd velocity, pressure, level, weight;  // upwards [m/s]; [Pa]; of the surface [m]; Σ
  };
  Sample sample(const StepData<dim>&) const;
  void find_columns(const StepData<dim>&);
  void begin(StepData<dim>&);
  void mark(StepData<dim>&) const;
  void press_surface(StepData<dim>&) const;
  AirState<plane> air_of(const State<dim>&) const;
  void store(const AirState<plane>&, State<dim>&) const;
  double column_at(const StepData<dim>&, double x) const;

  AirKeys keys_;
  std::vector<std::int64_t> row_;  // first-layer particle behind each column's face
  std::vector<int> point_;         // wet point of each column, in the order of x
  std::vector<AirLayer<plane>> layer_;
};

}  // namespace strake::fluid
