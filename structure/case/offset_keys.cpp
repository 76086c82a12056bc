#include "proto/error.hpp"
#include "proto/files/history.hpp"
#include "structure/case/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace strake::structure {
namespace {

constexpr const char* example = "a first line like: station [m],height [m],half_breadth [m]";
constexpr double same_station = 1e-6;  // [m]

/// Columns of a table of offsets, in the order station, height, half breadth, n values each [m].
struct Offsets {
  std::string file;
  std::array<std::vector<double>, 3> value;
  std::size_t rows() const { return value[0].size(); }
};

Error wrong(const std::string& file, const std::string& problem, const std::string& fix = example) {
  return {ExitCode::case_file, file, problem, fix};
}

Offsets read_table_of_offsets(const std::filesystem::path& path) {
  constexpr std::array<const char*, 3> names = {"station", "height", "half_breadth"};
  Table table = read_given_table(path);
  Offsets offsets{.file = path.string(), .value = {}};
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto found = std::find_if(table.columns.begin(), table.columns.end(),
                                    [&](const Column& column) { return column.name == names[k]; });
    if (found == table.columns.end())
      throw wrong(offsets.file, fmt::format("has no column {} [m]", names[k]));
    if (found->unit != "m")
      throw wrong(offsets.file,
                  fmt::format("column {} is in [{}], it must be in [m]", names[k], found->unit));
    offsets.value[k] = std::move(table.value[static_cast<std::size_t>(found - table.columns.begin())]);
    for (std::size_t row = 0; row < offsets.rows(); ++row)
      if (!std::isfinite(offsets.value[k][row]))
        throw wrong(offsets.file,
                    fmt::format("row {} of column {} holds no finite number", row + 1, names[k]),
                    "leave the row out");
  }
  return offsets;
}

/// Points (half breadth, height) of one section in the table's order.
std::vector<Eigen::Vector2d> half_section(const Offsets& offsets, double station) {
  std::vector<Eigen::Vector2d> half;
  const auto& [stations, heights, breadths] = offsets.value;
  for (std::size_t row = 0; row < offsets.rows(); ++row) {
    if (std::abs(stations[row] - station) > same_station) continue;
    if (breadths[row] < 0)
      throw wrong(offsets.file, fmt::format("row {}: the half breadth is {:.6g} m", row + 1, breadths[row]),
                  "give the half breadth of one side, 0 at the middle plane or greater");
    const Eigen::Vector2d point(breadths[row], heights[row]);
    if (!half.empty() && (point.y() < half.back().y() || point == half.back()))
      throw wrong(
          offsets.file,
          fmt::format("row {}: the height {:.6g} m of station {:.6g} m does not lie above that of the "
                      "row before it, {:.6g} m",
                      row + 1, point.y(), station, half.back().y()),
          "give each section from the keel upwards; a level bottom or deck has equal heights");
    half.push_back(point);
  }
  return half;
}

}  // namespace

std::vector<Eigen::Vector2d> read_offsets(const CaseFile& file, CaseTable t) {
  const bool all = file.only_declares();
  std::filesystem::path path;
  double station = 0;
  if (all || t.has("offsets"))
    t.file("offsets", path,
           {.help = "table of a ship's sections, of which a rigid body has one: columns station, height and "
                    "half_breadth [m], each section from the keel upwards; mirrored, and closed by a deck"});
  if (all || t.has("station"))
    t.number("station", station,
             {.unit = "m",
              .required = true,
              .conditional = true,
              .help = "which section of offsets the body has; not given: the only one"});
  if (all) return {};
  if (path.empty()) {
    if (t.has("station"))
      throw t.error("station", "nothing: it belongs to structure.offsets", "leave it out");
    return {};
  }
  const Offsets offsets = read_table_of_offsets(path);
  if (offsets.rows() == 0)
    throw wrong(offsets.file, "holds no rows", "a row for each point of a section: 10,0.05,0.03");
  std::set<double> known(offsets.value[0].begin(), offsets.value[0].end());
  if (!t.has("station") && known.size() == 1) station = *known.begin();
  const std::vector<Eigen::Vector2d> half = half_section(offsets, station);
  if (half.empty()) {
    constexpr std::size_t shown = 20;
    std::vector<std::string> some;
    for (const double at : known)
      if (some.size() < shown) some.push_back(fmt::format("{:.6g}", at));
    if (known.size() > shown) some.emplace_back("...");
    throw t.error("station", fmt::format("a station of {}: {} m", offsets.file, joined(some)),
                  fmt::format("station = {}", some.front()));
  }
  if (half.size() < 3)
    throw wrong(offsets.file,
                fmt::format("station {:.6g} m has {} points, at least 3 are needed", station, half.size()),
                "add points from the keel to the deck");
  for (std::size_t k = 1; k + 1 < half.size(); ++k)
    if (half[k].x() == 0)
      throw wrong(
          offsets.file,
          fmt::format("station {:.6g} m: the half breadth at the height {:.6g} m is 0", station, half[k].y()),
          "the keel and the top alone may lie in the middle plane");
  std::vector<Eigen::Vector2d> corner = half;
  for (auto point = half.rbegin(); point != half.rend(); ++point)
    if (point->x() > 0) corner.emplace_back(-point->x(), point->y());
  return corner;
}

}  // namespace strake::structure
