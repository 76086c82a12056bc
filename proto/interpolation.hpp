#pragma once

#include <string>
#include <vector>

#include "proto/interface.hpp"

namespace strake {

/// How a field is taken between the samples of a history. Smooth fields of samples h apart: errors of h, h²,
/// h³.
enum class Interpolation {
  constant,  // of a sample since the one before it: keeps the impulse of a load whose samples are means
  linear,
  quadratic  // the parabola through both neighbours and one more sample; linear where there are two
};
/// "constant" | "linear" | "quadratic"; throws Error(case_file) otherwise.
Interpolation interpolation_kind(const std::string&);

/// A field at a time; held outside the samples. 0×0 where there are none, or they do not have it.
Eigen::MatrixXd value_at(const std::vector<Sample>&, const std::string& quantity, double time, Interpolation);
/// Its mean over [begin, end], exact for the interpolant.
Eigen::MatrixXd mean_over(const std::vector<Sample>&, const std::string& quantity, double begin, double end,
                          Interpolation);

}  // namespace strake
