#pragma once

#include "proto/interface.hpp"

#include <string>
#include <vector>

namespace strake {

/// How a field is taken between the samples of a history, by the degree of its pieces. Smooth fields of
/// samples h apart: errors of h, h², h³, h⁴.
enum class Interpolation {
  constant,  // of a sample since the one before it: keeps the impulse of a load whose samples are means
  linear,
  quadratic,  // the parabola through both neighbours and one more sample; linear where there are two
  b_spline    // the cubic spline through all samples; of three the parabola, of two linear
};
/// "constant" | "linear" | "quadratic" | "b-spline"; throws Error(case_file) otherwise.
Interpolation interpolation_kind(const std::string&);

/// The degree of a polynomial in time by its name in a case file: "constant" 0, "linear" 1, "quadratic" 2.
/// `more`: what else the key takes, in the order of degrees from 3 on. Throws Error(case_file), naming the
/// key, for another name.
int degree_of(const std::string& name, const std::string& key, const std::vector<std::string>& more = {});

/// A field at a time; constant outside the samples. 0×0 if there are no samples, or they do not have it.
Eigen::MatrixXd value_at(const std::vector<Sample>&, const std::string& quantity, double time, Interpolation);
/// Its mean over [begin, end], exact for the interpolant.
Eigen::MatrixXd mean_over(const std::vector<Sample>&, const std::string& quantity, double begin, double end,
                          Interpolation);

}  // namespace strake
