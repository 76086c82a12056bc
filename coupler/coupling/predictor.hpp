#pragma once

#include "proto/interface.hpp"

#include <string>
#include <vector>

namespace strake {

/// First guess of what a side will send at a window's end, from what was committed.
enum class Predictor { constant, linear, quadratic };  // by the polynomial's degree
/// "constant" | "linear" | "quadratic"; throws Error(case_file) otherwise.
Predictor predictor_kind(const std::string&);

/// What a side sent at the ends of the last committed windows, oldest first, at most as many samples as the
/// predictor takes: what is kept longer only displaces what the next window needs from the processor's cache.
/// Each has the same fields.
using Samples = std::vector<Sample>;
void remember(Samples&, Sample, Predictor);
/// The fields at `time`: each by the polynomial of the predictor's degree through the last samples; while
/// there are too few, by the highest degree they allow. A velocity beside a displacement goes with it: from
/// one sample u + v (t − t_n), and always the end velocity of a motion with constant acceleration.
Sample predict(Predictor, const Samples&, double time);

}  // namespace strake
