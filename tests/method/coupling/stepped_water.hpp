#pragma once

#include "fluid/simulation/simulation.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <vector>

namespace strake::models {

/// The water of a simulation, one step per window.
template <int dim>
class SteppedWater : public Model<fluid::State<dim>> {
 public:
  SteppedWater(const fluid::Parameters& p, const InterfaceMesh& body, const Points& velocity)
      : simulation_(p, body, velocity) {
    this->begin(simulation_.interface(), simulation_.state());
  }

 private:
  Advanced step(const Window& window, const Input& input) override {
    simulation_.set_state(this->now_);
    const std::vector<Field>& fields = input.samples.back().fields;
    const Points velocity = find(fields, "velocity")->value;
    simulation_.step(window.dt, {find(fields, "displacement")->value, velocity, 0 * velocity});
    this->now_ = simulation_.state();
    Advanced advanced;
    advanced.output = {{"force", "N", true, simulation_.interface_force()}};
    return advanced;
  }
  fluid::Simulation<dim> simulation_;
};

}  // namespace strake::models
