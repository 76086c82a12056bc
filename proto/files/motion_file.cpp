#include "proto/files/motion_file.hpp"

#include "proto/error.hpp"
#include "proto/files/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake {
namespace {

constexpr double degree = std::numbers::pi / 180;  // [rad]
constexpr const char* example = "a first line like: t [s],x [m],y [m],angle [deg]  or  t [s],vy [m/s]";

struct Accepted {
  const char* name;
  const char* unit;
  std::size_t channel;
  MotionColumn kind;
  double factor;  // to m, rad, and per second
};
constexpr std::array<Accepted, 10> accepted = {{{"x", "m", 0, MotionColumn::place, 1},
                                                {"y", "m", 1, MotionColumn::place, 1},
                                                {"z", "m", 2, MotionColumn::place, 1},
                                                {"angle", "deg", 3, MotionColumn::place, degree},
                                                {"angle", "rad", 3, MotionColumn::place, 1},
                                                {"vx", "m/s", 0, MotionColumn::rate, 1},
                                                {"vy", "m/s", 1, MotionColumn::rate, 1},
                                                {"vz", "m/s", 2, MotionColumn::rate, 1},
                                                {"rate", "deg/s", 3, MotionColumn::rate, degree},
                                                {"rate", "rad/s", 3, MotionColumn::rate, 1}}};

const Accepted& accept(const Column& column, const std::string& path) {
  std::string units;
  std::vector<std::string> names = {"t"};
  for (const Accepted& known : accepted) {
    names.emplace_back(known.name);
    if (column.name != known.name) continue;
    if (column.unit == known.unit) return known;
    units += fmt::format("{}[{}]", units.empty() ? "" : " or ", known.unit);
  }
  if (!units.empty())
    throw Error(ExitCode::case_file, path,
                fmt::format("column {} is in [{}], it must be in {}", column.name, column.unit, units),
                example);
  const std::string near = did_you_mean(column.name, names);
  throw Error(ExitCode::case_file, path,
              fmt::format("column \"{}\" is nothing that a motion consists of", column.name),
              near.empty() ? example : fmt::format("did you mean {}?", near));
}

}  // namespace

MotionTable read_motion(const std::filesystem::path& path) {
  const Table table = read_given_table(path);
  const auto wrong = [&](const std::string& problem, const std::string& fix = example) {
    return Error(ExitCode::case_file, path.string(), problem, fix);
  };
  std::vector<double> time;
  std::array<MotionColumn, MotionTable::n_channels> kind{};
  std::array<std::vector<double>, MotionTable::n_channels> value;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const Column& column = table.columns[c];
    for (std::size_t row = 0; row < table.rows(); ++row)
      if (!std::isfinite(table.value[c][row]))
        throw wrong(fmt::format("row {} of column {} holds no finite number", row + 1, column.name),
                    "a motion is known at every time of its table: leave the row out");
    if (column.name == "t" || column.name == "time") {
      if (column.unit != "s") throw wrong(fmt::format("the time is in [{}], it must be in [s]", column.unit));
      time = table.value[c];
      continue;
    }
    const Accepted& known = accept(column, path.string());
    if (kind[known.channel] != MotionColumn::absent)
      throw wrong(fmt::format("column {} gives a motion that another column gives already", column.name),
                  "one column for each direction: the place or its rate");
    kind[known.channel] = known.kind;
    value[known.channel] = table.value[c];
    for (double& v : value[known.channel]) v *= known.factor;
  }
  if (time.empty() && table.rows() > 0) throw wrong("has no column t [s]");
  if (table.rows() < 2) throw wrong(fmt::format("holds {} rows, a motion needs two", table.rows()));
  for (std::size_t row = 1; row < time.size(); ++row)
    if (!(time[row] > time[row - 1]))
      throw wrong(
          fmt::format("the time of row {} ({:.9g} s) is not after that of the row before it ({:.9g} s)",
                      row + 1, time[row], time[row - 1]),
          "give the rows in rising order of time");
  return {std::move(time), kind, std::move(value)};
}

VelocityProfile read_velocity_profile(const std::filesystem::path& path) {
  const Table table = read_given_table(path);
  const auto wrong = [&](const std::string& problem) {
    return Error(ExitCode::case_file, path.string(), problem, "a first line like: x [m],vy [m/s]");
  };
  std::vector<double> place;
  Eigen::Index along = 0;
  std::array<MotionColumn, MotionTable::n_channels> kind{};
  std::array<std::vector<double>, MotionTable::n_channels> value;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const Column& column = table.columns[c];
    for (const double v : table.value[c])
      if (!std::isfinite(v))
        throw wrong(fmt::format("column {} holds what is no finite number", column.name));
    const std::string axis = column.name.substr(column.name.size() == 2 && column.name[0] == 'v' ? 1 : 0);
    const std::size_t number = axis.size() == 1 ? std::string("xyz").find(axis) : std::string::npos;
    const bool coordinate = column.name.size() == 1;
    if (number == std::string::npos || column.unit != (coordinate ? "m" : "m/s"))
      throw wrong(
          fmt::format("column {} [{}] is none of x, y, z [m], vx, vy, vz [m/s]", column.name, column.unit));
    if (!coordinate) {
      kind[number] = MotionColumn::place;
      value[number] = table.value[c];
      continue;
    }
    if (!place.empty()) throw wrong("has two coordinates: velocities are given over one");
    place = table.value[c];
    along = static_cast<Eigen::Index>(number);
  }
  const bool none =
      std::all_of(kind.begin(), kind.end(), [](MotionColumn k) { return k == MotionColumn::absent; });
  if (place.size() < 2 || none) throw wrong("needs one coordinate, one velocity at least, and two rows");
  for (std::size_t row = 1; row < place.size(); ++row)
    if (!(place[row] > place[row - 1]))
      throw wrong(fmt::format("the coordinate of row {} ({:.9g} m) is not beyond that of the row before it",
                              row + 1, place[row]));
  return {MotionTable(std::move(place), kind, std::move(value)), along};
}

}  // namespace strake
