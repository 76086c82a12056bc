#pragma once

#include "coupler/case/case_view.hpp"
#include "proto/files/history.hpp"
#include "proto/interface.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// A body's name in the case and its mesh at the start.
using BodyAtStart = std::pair<std::string, const InterfaceMesh*>;

/// One line for each thing at t = 0 that is seldom meant. Looked at are a body larger than any ship, the
/// mass and the centre of gravity of a free one, and a driven one that comes to the floor of the tank. So are
/// a tank that starts at full speed, and water that stands on nothing. No line without water of ours.
std::vector<std::string> start_lines(const CaseView&, const std::vector<BodyAtStart>&);

/// One line for each [[compare]] block that holds in this case and whose probe is no column of the run: it is
/// never judged. columns: what the participants report. A probe that the solver leaves out is not said again.
std::vector<std::string> judged_lines(const CaseView&, const std::vector<Column>& columns);

/// "the body is 600 m long, larger than any ship"; empty for a smaller one. lengths: of the body along the
/// axes [m].
///
/// Its longest, second and third length are compared with 500, 80 and 50 m. Prelude FLNG, the largest hull
/// afloat, is 488 m long and 74 m wide. A section in the plane has no length of a ship: 80 and 50 m.
std::string larger_than_ships(std::array<double, 3> lengths, int dimension,
                              const std::string& body = "the body");

}  // namespace strake
