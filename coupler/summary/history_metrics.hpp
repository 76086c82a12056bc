#pragma once

#include "proto/files/history.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// Columns of history.csv that no participant keeps a record of its steps for: force and moment on the body,
/// its place, all columns of a solver of another's. Counters, energies and what belongs to a probe are left
/// out. recorded: probes with a record.
std::vector<std::string> columns_without_record(const Table& history,
                                                const std::vector<std::string>& recorded);

/// Peak, first peak, impulse and last value of such a column by the lines of history.csv, "peak" → value. The
/// impulse is that of forces and moments alone, over 300 µs after contact; so is their largest mean over
/// 50 µs, where no window is longer than that. Zeros have a peak of 0 and no time of it.
/// contact [s]: from where a first peak counts; none: contact was not met, nothing counts from it.
std::map<std::string, double> metrics_of_column(const Table& history, const std::string& column,
                                                std::optional<double> contact);

/// A line for each force on a body, its largest component, whose peak is a blow. It lasts at most five
/// windows with half of it or more, and is three times the median of the twenty windows before it, and of
/// those after it. Water that closes on itself or on a face is stopped within a step: such a peak is as high
/// as the step is short. A peak that begins with the contact is none: the windows before it are empty.
std::vector<std::string> blow_lines(const Table& history, const std::vector<std::string>& columns);

/// M = Σ (x_i − c) × f_i, the moment of the forces on a body's points about its middle [N m; 2-D: N m per m].
/// position: where the points were at t = 0, 3 x n. displacement, force: 3 x n. c: the middle of the box
/// round `position`, moved by the points' mean displacement.
Eigen::Vector3d moment_about_middle(const Points& position, const Eigen::Ref<const Points>& displacement,
                                    const Eigen::Ref<const Points>& force);

}  // namespace strake
