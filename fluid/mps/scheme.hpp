#pragma once

#include "fluid/mps/operators.hpp"
#include "fluid/mps/pressure_equation.hpp"
#include "fluid/scheme/fluid_scheme.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace strake::fluid {

/// The MPS scheme of the paper (fluid/THEORY.md, sections 4 to 6). It uses the number density and
/// weighted-average operators. Each first-layer particle of walls and bodies has a pressure unknown.
/// `gradient` chooses the form of ∇p.
template <int dim>
class MpsScheme final : public FluidScheme<dim> {
 public:
  explicit MpsScheme(const StepData<dim>&);

  typename FluidScheme<dim>::SpareMemory spare_memory() override { return {tensors_, shared_}; }
  void measure(StepData<dim>&) override;
  /// With `density_at = "star"` the particles move by Δt u*, and are measured there.
  void predict(StepData<dim>&) override;
  void assemble(StepData<dim>&, PressureSystem&) override;
  void limit_pressure(StepData<dim>&, bool tension) override;
  void find_gradient(StepData<dim>&) override;
  Load<dim> load(StepData<dim>&) override;
  double correct(StepData<dim>&) override;
  void shift(StepData<dim>&) override;

 private:
  void measure_number_density(StepData<dim>&);
  void classify_rows(StepData<dim>&);
  bool exposed_by_crack(const StepData<dim>&, std::int64_t i, const Neighbours& near) const;
  void filter_velocity(StepData<dim>&) const;
  Eigen::VectorXd divergence(StepData<dim>&) const;  // ∇·u at the unknowns [1/s]

  bool at_star_, pairwise_;
  std::vector<Row> row_;
  std::vector<std::uint8_t> solved_, moves_;  // masks: unknowns; water
  Eigen::VectorXd n_, deviation_;             // number density; (n − n0)/n0 of the source
  Vectors<dim> gradient_;                     // ∇p [Pa/m]
  Eigen::VectorXd level_;  // of the pairs of water and body, with the symmetric gradient (face_level)
  std::vector<Tensor<dim>> tensors_;
  SharedMemory shared_;
};

}  // namespace strake::fluid
