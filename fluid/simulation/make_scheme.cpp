#include "fluid/simulation/make_scheme.hpp"

#include "fluid/least_squares/scheme.hpp"
#include "fluid/mps/scheme.hpp"
#include "proto/error.hpp"

namespace strake::fluid {

/// Chooses the data of the neighbour rows. The joint stress and the least-squares scheme read the rows of the
/// largest radius as the matrix of the pressure alone.
PairData pair_data(const Scheme& scheme) {
  return scheme.gradient == Gradient::least_squares && scheme.sps == SpsForm::joint ? PairData::entries
                                                                                    : PairData::inverses;
}

template <int dim>
std::unique_ptr<FluidScheme<dim>> make_scheme(const StepData<dim>& step) {
  const Boundary<dim>& boundary = step.boundary;
  if (step.p.scheme.gradient == Gradient::least_squares) {
    if (boundary.volume())
      throw Error(ExitCode::case_file, "fluid.scheme.gradient",
                  "least-squares has no volume coupling: the structure's particles are no faces",
                  "set fluid.scheme.gradient = \"pairwise\"");
    return std::make_unique<LeastSquaresScheme<dim>>(step.p, boundary, step.state);
  }
  if (dim == 3 && boundary.mesh().position.cols() > 0 && !boundary.volume())
    throw Error(ExitCode::case_file, "fluid.scheme.gradient",
                "moving surfaces in three dimensions are built for least-squares alone",
                "set fluid.scheme.gradient = \"least-squares\", or fluid.dimension = 2");
  return std::make_unique<MpsScheme<dim>>(step);
}

template std::unique_ptr<FluidScheme<2>> make_scheme<2>(const StepData<2>&);
template std::unique_ptr<FluidScheme<3>> make_scheme<3>(const StepData<3>&);

}  // namespace strake::fluid
