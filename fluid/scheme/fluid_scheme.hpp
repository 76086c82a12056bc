#pragma once

#include "fluid/particles/shared_memory.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"
#include "fluid/scheme/step_data.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::fluid {

/// The force of the water on all other particles, one column per particle [N] (per metre of depth in 2-D).
template <int dim>
using LayerForces = Vectors<dim>;

/// The load of a step on walls and bodies.
template <int dim>
struct Load {
  LayerForces<dim> on_layers;
  Eigen::Matrix2Xd on_solids;  // see carried_pressure; volume coupling
};

/// The stages of a step in which discretisations differ. `Simulation::step` calls them in this order:
/// measure, predict, assemble, limit_pressure, find_gradient, load, correct, shift. `measure` is left out
/// where a step goes on with a frozen configuration.
template <int dim>
class FluidScheme {
 public:
  FluidScheme() = default;
  FluidScheme(const FluidScheme&) = delete;
  FluidScheme& operator=(const FluidScheme&) = delete;
  virtual ~FluidScheme() = default;

  /// Notes what the scheme needs of the configuration at the start. It is called once, before the state of an
  /// earlier run is adopted.
  virtual void begin(StepData<dim>&) {}
  /// Takes on another number of water particles, before `measure`. Nothing of an earlier step is kept.
  virtual void set_water(const StepData<dim>&) {}
  /// The same, with other layer particles of the tank as well.
  virtual void set_layers(const StepData<dim>&) {}
  /// Whether steps of dt may share one configuration (acoustic_substepping.hpp).
  virtual bool may_substep(const StepData<dim>&, double) const { return false; }
  /// Memory that the scheme does not need before `measure`; the viscous stage uses it.
  struct SpareMemory {
    std::vector<Eigen::Matrix<double, dim, dim>>& tensors;  // one per particle of water
    SharedMemory& shared;                                   // of any size
  };
  virtual SpareMemory spare_memory() = 0;

  /// Measures the configuration: sums over neighbours, free surface, State::surface.
  virtual void measure(StepData<dim>&) = 0;
  /// Computes u* = u + Δt (ν∇²u + ∇·τ + g) (fluid/THEORY.md (F30)).
  virtual void predict(StepData<dim>&) = 0;
  /// Assembles the pressure equation.
  virtual void assemble(StepData<dim>&, PressureSystem&) = 0;
  /// Limits the solved pressure in State::pressure, and extends it to dummies. tension: negative values are
  /// allowed.
  virtual void limit_pressure(StepData<dim>&, bool tension) = 0;
  /// Computes ∇p of the water.
  virtual void find_gradient(StepData<dim>&) = 0;
  /// Computes the load at the positions for which the pressure was solved.
  virtual Load<dim> load(StepData<dim>&) = 0;
  /// Computes u = u* − (Δt/ρ) ∇p (F31). Moves particles, bodies and tank where a group of sub-steps ends
  /// (F32). Returns the largest |∇·u| of inner water particles [1/s].
  virtual double correct(StepData<dim>&) = 0;
  /// Moves particles towards even spacing.
  virtual void shift(StepData<dim>&) = 0;
};

}  // namespace strake::fluid
