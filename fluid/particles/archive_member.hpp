#pragma once

#include "proto/archive_source.hpp"
#include "proto/error.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

// Members are written to an archive by their kind: reals as a matrix, whole numbers and enumerators as int64.

namespace strake::fluid {

inline void put(Archive& archive, const std::string& name, double value) {
  archive.real[name] = Eigen::MatrixXd::Constant(1, 1, value);
}
inline void put(Archive& archive, const std::string& name, std::int64_t value) {
  archive.integer[name] = {value};
}
template <int rows, int columns>
void put(Archive& archive, const std::string& name, const Eigen::Matrix<double, rows, columns>& value) {
  archive.real[name] = value;
}
template <class T>
void put(Archive& archive, const std::string& name, const std::vector<T>& values) {
  auto& stored = archive.integer[name];
  stored.clear();
  for (const T value : values) stored.push_back(static_cast<std::int64_t>(value));
}

/// Notes a member to be written later by those functions. It must outlive `source`.
template <class T>
void put(ArchiveSource& source, const std::string& name, const T& value) {
  const auto taken = [&value] {
    Archive one;
    put(one, {}, value);
    return one;
  };
  if constexpr (std::is_same_v<T, double> || std::is_base_of_v<Eigen::EigenBase<T>, T>)
    source.real[name] = [taken] { return std::move(taken().real.begin()->second); };
  else
    source.integer[name] = [taken] { return std::move(taken().integer.begin()->second); };
}

[[noreturn]] inline void refuse(const std::string& problem) {
  throw Error(ExitCode::case_file, "checkpoint of the fluid", problem);
}
template <class Map>
const auto& entry(const Map& map, const std::string& name) {
  const auto found = map.find(name);
  if (found == map.end()) refuse("holds no " + name);
  return found->second;
}

template <int rows, int columns>
void get(const Archive& archive, const std::string& name, Eigen::Matrix<double, rows, columns>& value) {
  const Eigen::MatrixXd& stored = entry(archive.real, name);
  if ((rows != Eigen::Dynamic && stored.rows() != rows) ||
      (columns != Eigen::Dynamic && stored.cols() != columns))
    refuse(fmt::format("{} is {}×{}, not of this case", name, stored.rows(), stored.cols()));
  value = stored;
}
template <class T>
void get(const Archive& archive, const std::string& name, std::vector<T>& values) {
  const std::vector<std::int64_t>& stored = entry(archive.integer, name);
  values.resize(stored.size());
  std::transform(stored.begin(), stored.end(), values.begin(), [](auto v) { return static_cast<T>(v); });
}
inline void get(const Archive& archive, const std::string& name, double& value) {
  Eigen::Matrix<double, 1, 1> stored;
  get(archive, name, stored);
  value = stored.value();
}
inline void get(const Archive& archive, const std::string& name, std::int64_t& value) {
  std::vector<std::int64_t> stored;
  get(archive, name, stored);
  if (stored.size() != 1) refuse(fmt::format("{} has {} values instead of one", name, stored.size()));
  value = stored.front();
}

}  // namespace strake::fluid
