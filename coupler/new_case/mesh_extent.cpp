#include "coupler/new_case/mesh_extent.hpp"

#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/mesh_files/stl.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <optional>
#include <sstream>
#include <vector>

namespace strake {
namespace {

/// The numbers of a line; commas separate as spaces do.
std::vector<double> numbers_in_line(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::vector<double> numbers;
  for (const char* at = line.c_str();;) {
    char* end = nullptr;
    const double x = std::strtod(at, &end);
    if (end == at) return numbers;
    numbers.push_back(x);
    at = end;
  }
}

/// "$Nodes" and "*NODE, NSET=all" begin the nodes; the next word of that kind ends them.
std::optional<bool> begins_nodes(const std::string& line) {
  if (line.empty() || (line[0] != '$' && line[0] != '*') || line.starts_with("**")) return {};
  std::string word = line.substr(1, line.find_first_of(", \t\r") - 1);
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word == "nodes" || word == "node";
}

/// Where the coordinates of a node begin in its line. None in lines of Gmsh that count or number nodes.
std::optional<std::size_t> first_coordinate(bool abaqus, double version, std::size_t numbers) {
  if (abaqus) return numbers >= 3 ? std::optional<std::size_t>(1) : std::nullopt;
  if (version < 4) return numbers == 4 ? std::optional<std::size_t>(1) : std::nullopt;
  return numbers == 3 ? std::optional<std::size_t>(0) : std::nullopt;
}

MeshExtent extent_of_stl(const std::filesystem::path& file) {
  const Points corner = read_stl(file);
  MeshExtent extent;
  for (std::size_t k = 0; k < 3; ++k) {
    extent.min[k] = corner.row(static_cast<Eigen::Index>(k)).minCoeff();
    extent.max[k] = corner.row(static_cast<Eigen::Index>(k)).maxCoeff();
  }
  return extent;
}

MeshExtent extent_of_nodes(const std::filesystem::path& file) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::istringstream lines(read_whole(file, largest_mesh, file.string()));
  const bool abaqus = file.extension() == ".inp";
  MeshExtent extent{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  bool format = false, nodes = false;
  double version = 0;
  for (std::string line; std::getline(lines, line);) {
    if (const auto begins = begins_nodes(line)) {
      nodes = *begins;
      format = line.starts_with("$MeshFormat");
      continue;
    }
    const std::vector<double> numbers = nodes || format ? numbers_in_line(line) : std::vector<double>();
    if (format && !numbers.empty()) version = numbers.front();
    const auto first = nodes ? first_coordinate(abaqus, version, numbers.size()) : std::nullopt;
    for (std::size_t k = 0; first && k < 3; ++k) {
      const double x = *first + k < numbers.size() ? numbers[*first + k] : 0;
      extent.min[k] = std::min(extent.min[k], x);
      extent.max[k] = std::max(extent.max[k], x);
    }
  }
  if (!(extent.max[0] > extent.min[0]) || !(extent.max[1] > extent.min[1]))
    throw Error(ExitCode::case_file, file.string(), "holds no nodes that span an area",
                "a mesh of Gmsh (.msh, ASCII), Abaqus (.inp) or STL (.stl)");
  return extent;
}

}  // namespace

MeshExtent read_mesh_extent(const std::filesystem::path& file) {
  return is_stl(file) ? extent_of_stl(file) : extent_of_nodes(file);
}

}  // namespace strake
