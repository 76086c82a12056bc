#pragma once

#include "proto/interface.hpp"

#include <string>
#include <vector>

namespace strake {

/// First guess of what a side will send at a window's end, from what was committed.
enum class Predictor { constant, linear, quadratic };  // by the polynomial's degree
/// "constant" | "linear" | "quadratic"; throws Error(case_file) otherwise.
Predictor predictor_kind(const std::string&);

/// Fields of a side at the ends of the last committed windows, oldest first. There are at most as many
/// samples as the predictor uses; more would only displace other data from the processor's cache. Each has
/// the same fields.
using Samples = std::vector<Sample>;
void remember(Samples&, Sample, Predictor);
/// Extrapolates the fields to `time` by the polynomial of the predictor's degree through the last samples.
/// With too few samples it uses the highest degree they allow. Displacement and velocity are extrapolated
/// together: from one sample u + v (t − t_n), and always so that a motion with constant acceleration gets its
/// exact end velocity.
Sample predict(Predictor, const Samples&, double time);

}  // namespace strake
