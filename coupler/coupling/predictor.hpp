#pragma once

#include "coupler/coupling/exchange.hpp"
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
void remember(StructureSamples&, StructureSample, Predictor);
/// The fields at `time`: each by the polynomial of the predictor's degree through the last samples; while
/// there are too few, by the highest degree they allow. The velocity of a motion goes with its displacement:
/// from one sample u + v (t − t_n), and always the end velocity of a motion with constant acceleration.
Sample predict(Predictor, const Samples&, double time);
StructureSample predict(Predictor, const StructureSamples&, double time);

}  // namespace strake
