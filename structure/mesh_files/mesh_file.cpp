#include "structure/mesh_files/mesh_file.hpp"

#include "proto/error.hpp"
#include "proto/mesh_files/mesh_text.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Corners walked around, as files give them, in lexicographic order; turned over where the walk is
/// clockwise.
std::vector<int> lexicographic(const std::vector<int>& walked, const Points& node) {
  const auto at = [&](int k) -> Vector3d { return node.col(walked[static_cast<std::size_t>(k)]); };
  const auto pick = [&](std::initializer_list<int> order) {
    std::vector<int> picked;
    for (const int k : order) picked.push_back(walked[static_cast<std::size_t>(k)]);
    return picked;
  };
  if (walked.size() == 4) {
    const double area = (at(2) - at(0)).cross(at(3) - at(1)).z();
    return area > 0 ? pick({0, 1, 3, 2}) : pick({0, 3, 1, 2});
  }
  Vector3d low = Vector3d::Zero(), high = low;
  for (int k = 0; k < 4; ++k) low += 0.25 * at(k), high += 0.25 * at(k + 4);
  const double volume = (at(2) - at(0)).cross(at(3) - at(1)).dot(high - low);
  return volume > 0 ? pick({0, 1, 3, 2, 4, 5, 7, 6}) : pick({4, 5, 7, 6, 0, 1, 3, 2});
}

/// Facets by the sorted numbers of their nodes.
std::map<std::vector<int>, int> facets_by_nodes(const Solid& solid) {
  std::map<std::vector<int>, int> number;
  for (int f = 0; f < solid.facet.cols(); ++f) {
    std::vector<int> key;
    for (Index k = 0; k < solid.facet.rows(); ++k) key.push_back(solid.facet(k, f));
    std::sort(key.begin(), key.end());
    number[key] = f;
  }
  return number;
}

void add_to_face(Solid& solid, const std::string& name, int facet) {
  auto found = std::find_if(solid.supported.begin(), solid.supported.end(),
                            [&](const SupportedFace& face) { return face.name == name; });
  if (found == solid.supported.end()) found = solid.supported.insert(found, {name, Support::free, {}});
  found->facet.push_back(facet);
}

/// Makes a body of the cells, the named sides and the node sets of a mesh file.
class MeshReader {
 public:
  MeshReader(const std::filesystem::path& path, const MeshText& text, int dimension)
      : path_(path), text_(text), dimension_(dimension) {
    solid_.dimension = dimension;
  }

  Solid read(const Material& material) {
    for (const MeshText::Element& element : text_.element) {
      refuse_other_cells(element);
      if (element.kind != (dimension_ == 2 ? "quadrilateral" : "hexahedron")) continue;
      cells_.push_back(&element);
      number_nodes(element);
    }
    if (cells_.empty())
      throw wrong(0,
                  fmt::format("has no {}",
                              dimension_ == 2 ? "triangles or quadrilaterals" : "tetrahedra or hexahedra"),
                  dimension_ == 2 ? "gmsh -2; save all physical groups" : "gmsh -3; or fluid.dimension = 2");
    add_cells(material);
    refuse_overlaps();
    find_facets(solid_);
    name_faces();
    return std::move(solid_);
  }

 private:
  Error wrong(std::size_t line, const std::string& problem, const std::string& fix) const {
    return Error(ExitCode::case_file, line > 0 ? fmt::format("{}:{}", path_.string(), line) : path_.string(),
                 problem, fix);
  }

  void refuse_other_cells(const MeshText::Element& element) const {
    if (dimension_ == 3 && element.kind == "pyramid")
      throw wrong(element.line, "a pyramid: cells are hexahedra, tetrahedra or prisms",
                  "in Gmsh: volumes of tetrahedra alone, or extruded ones with Recombine");
  }

  void number_nodes(const MeshText::Element& element) {
    for (const long n : element.node) {
      const auto place = text_.node.find(n);
      if (place == text_.node.end())
        throw wrong(element.line,
                    fmt::format("element {} names node {}, which the file does not have", element.number, n),
                    "write the mesh anew");
      const auto [found, fresh] = number_.emplace(n, static_cast<int>(node_.size()));
      if (fresh) node_.emplace_back(place->second[0], place->second[1], place->second[2]);
      if (!node_[static_cast<std::size_t>(found->second)].allFinite() ||
          (dimension_ == 2 && node_[static_cast<std::size_t>(found->second)].z() != 0))
        throw wrong(
            element.line,
            fmt::format("node {} has z = {:g}: two dimensions are the plane z = 0", n, place->second[2]),
            "move the mesh to z = 0, or fluid.dimension = 3");
    }
  }

  void add_cells(const Material& material) {
    std::map<std::string, int> part;
    solid_.node.resize(3, static_cast<Index>(node_.size()));
    for (std::size_t i = 0; i < node_.size(); ++i) solid_.node.col(static_cast<Index>(i)) = node_[i];
    solid_.cell.resize(1 << dimension_, static_cast<Index>(cells_.size()));
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      std::vector<int> walked;
      for (const long n : cells_[c]->node) walked.push_back(number_.at(n));
      const std::vector<int> corner = lexicographic(walked, solid_.node);
      for (std::size_t k = 0; k < corner.size(); ++k)
        solid_.cell(static_cast<Index>(k), static_cast<Index>(c)) = corner[k];
      const std::string name = cells_[c]->group.empty() ? "body" : cells_[c]->group;
      const auto [found, fresh] = part.emplace(name, static_cast<int>(solid_.parts.size()));
      if (fresh) solid_.parts.push_back({name, material, false});
      solid_.part_of.push_back(found->second);
    }
  }

  /// Cells over one another have their mass and their stiffness twice.
  void refuse_overlaps() const {
    const CellOverlaps overlaps = find_overlaps(solid_);
    if (overlaps.cells == 0) return;
    const auto element = [&](int cell) { return cells_[static_cast<std::size_t>(cell)]; };
    const auto *one = element(overlaps.first.first), *other = element(overlaps.first.second);
    const Vector3d& X = overlaps.place;
    const std::string more =
        overlaps.cells > 2 ? fmt::format("; cells that reach into another: {}", overlaps.cells) : "";
    throw wrong(
        other->line,
        one->number == other->number
            ? fmt::format("element {} is there twice, at ({:.6g}, {:.6g}, {:.6g}) in the file's unit{}",
                          one->number, X.x(), X.y(), X.z(), more)
            : fmt::format("element {} lies over element {} (line {}), at ({:.6g}, {:.6g}, {:.6g}) in "
                          "the file's unit{}",
                          other->number, one->number, one->line, X.x(), X.y(), X.z(), more),
        "mesh each part once, cut parts where they overlap (Gmsh: BooleanFragments, then Coherence), "
        "and give each cell one physical group");
  }

  void name_faces() {
    const std::string side = dimension_ == 2 ? "line" : "quadrilateral";
    const auto by_nodes = facets_by_nodes(solid_);
    for (const MeshText::Element& element : text_.element) {
      if (element.kind != side || element.group.empty()) continue;
      std::vector<int> key;
      for (const long n : element.node)
        if (const auto found = number_.find(n); found != number_.end()) key.push_back(found->second);
      std::sort(key.begin(), key.end());
      const auto facet = by_nodes.find(key);
      if (facet == by_nodes.end()) {
        if (const SolidFault fault = fault_of(solid_); !fault.problem.empty())  // the reason, perhaps
          throw wrong(0, fault.problem, fault.fix);
        throw wrong(
            element.line,
            fmt::format("a {} of \"{}\" is no side of a cell at the body's boundary", side, element.group),
            "give physical names to outer sides only");
      }
      add_to_face(solid_, element.group, facet->second);
    }
    for (const auto& [name, members] : text_.node_set) {
      std::set<int> in;
      for (const long n : members)
        if (const auto found = number_.find(n); found != number_.end()) in.insert(found->second);
      for (const auto& [nodes, facet] : by_nodes)
        if (std::all_of(nodes.begin(), nodes.end(), [&](int n) { return in.contains(n); }))
          add_to_face(solid_, name, facet);
    }
  }

  std::filesystem::path path_;
  const MeshText& text_;
  int dimension_;
  Solid solid_;
  std::map<long, int> number_;  // of the file's nodes that cells use
  std::vector<Vector3d> node_;
  std::vector<const MeshText::Element*> cells_;
};

/// Gives each element the set that the case names as a part, where a file has it in several sets. In two
/// sets with such names a cell would have two materials.
void take_named_sets(const std::filesystem::path& path, const std::vector<std::string>& names,
                     MeshText& text) {
  std::map<long, std::string> set_of;
  for (const std::string& name : names) {
    const auto set = text.element_set.find(name);
    if (set == text.element_set.end()) continue;
    for (const long number : set->second) {
      const auto [found, fresh] = set_of.emplace(number, name);
      if (fresh || found->second == name) continue;
      const auto element = std::find_if(text.element.begin(), text.element.end(),
                                        [&](const auto& one) { return one.number == number; });
      throw Error(
          ExitCode::case_file, fmt::format("{}:{}", path.string(), element->line),
          fmt::format("element {} is in two sets that the case names as parts, \"{}\" and \"{}\": which "
                      "material has it?",
                      number, found->second, name),
          "take it out of one of the two sets");
    }
  }
  for (MeshText::Element& element : text.element)
    if (const auto found = set_of.find(element.number); found != set_of.end()) element.group = found->second;
}

/// A cell has one material, so that it is in one group. Sides may be in several.
void refuse_cells_of_two_groups(const std::filesystem::path& path, const MeshText& text, int dimension) {
  const std::set<std::string> kinds = dimension == 2
                                          ? std::set<std::string>{"triangle", "quadrilateral"}
                                          : std::set<std::string>{"tetrahedron", "hexahedron", "prism"};
  std::map<long, const MeshText::Element*> first;
  for (const MeshText::Element& element : text.element) {
    if (!kinds.contains(element.kind)) continue;
    const MeshText::Element& other = *first.emplace(element.number, &element).first->second;
    if (element.group != other.group)
      throw Error(ExitCode::case_file, fmt::format("{}:{}", path.string(), element.line),
                  fmt::format("element {} is in two groups, \"{}\" and \"{}\": which material has it?",
                              element.number, other.group, element.group),
                  "give each cell one physical group");
  }
}

}  // namespace

Solid read_mesh(const std::filesystem::path& path, int dimension, const Material& material,
                const std::vector<std::string>& parts) {
  MeshText text = read_mesh_text(path);
  take_named_sets(path, parts, text);
  refuse_cells_of_two_groups(path, text, dimension);
  if (has_simplices(text, dimension)) text = cut_into_quadrilaterals(text, dimension);
  return MeshReader(path, text, dimension).read(material);
}

}  // namespace strake::structure
