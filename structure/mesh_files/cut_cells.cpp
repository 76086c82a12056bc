#include "structure/mesh_files/mesh_file.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace strake::structure {
namespace {

using Corners = std::vector<long>;

/// Faces of a cell in space, each walked around, by the places of their corners in the cell.
const std::vector<std::vector<std::size_t>>& faces_of(const std::string& kind) {
  static const std::map<std::string, std::vector<std::vector<std::size_t>>> faces = {
      {"tetrahedron", {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}},
      {"prism", {{0, 1, 2}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
      {"hexahedron", {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}}};
  static const std::vector<std::vector<std::size_t>> none;
  const auto found = faces.find(kind);
  return found == faces.end() ? none : found->second;
}

bool is_flat_cell(const std::string& kind) {
  return kind == "triangle" || kind == "quadrilateral";
}

/// The mesh while it is cut: new nodes stand in the middle of an edge, a face or a cell, and belong to it.
class Cut {
 public:
  Cut(const MeshText& mesh, int dimension) : mesh_(mesh), dimension_(dimension), result_(mesh) {
    result_.element.clear();
    next_ = mesh.node.empty() ? 1 : mesh.node.rbegin()->first + 1;
  }

  MeshText all() {
    for (const MeshText::Element& element : mesh_.element)
      if (known(element)) cut(element);
    for (auto& [name, members] : result_.node_set) {
      const std::set<long> in(members.begin(), members.end());
      for (const auto& [corners, middle] : middle_)
        if (std::all_of(corners.begin(), corners.end(), [&](long n) { return in.contains(n); }))
          members.push_back(middle);
    }
    return std::move(result_);
  }

 private:
  /// Whether all nodes of the element are in the file; whoever reads the mesh refuses the others.
  bool known(const MeshText::Element& element) {
    const bool all =
        std::all_of(element.node.begin(), element.node.end(), [&](long n) { return mesh_.node.contains(n); });
    if (!all) result_.element.push_back(element);
    return all;
  }

  void cut(const MeshText::Element& element) {
    if (element.kind == "line")
      cut_line(element);
    else if (is_flat_cell(element.kind))
      cut_flat(element);
    else if (dimension_ == 3 && !faces_of(element.kind).empty())
      cut_solid(element);
    else
      result_.element.push_back(element);
  }

  /// The node in the middle of these corners; the same corners give the same node.
  long middle(Corners corners) {
    std::sort(corners.begin(), corners.end());
    const auto [found, fresh] = middle_.emplace(corners, next_);
    if (!fresh) return found->second;
    std::array<double, 3> place = {0, 0, 0};
    for (const long n : corners)
      for (std::size_t axis = 0; axis < 3; ++axis)
        place.at(axis) += mesh_.node.at(n).at(axis) / static_cast<double>(corners.size());
    result_.node.emplace(next_, place);
    return next_++;
  }

  void add(const MeshText::Element& of, const std::string& kind, Corners corners) {
    result_.element.push_back(
        {.number = of.number, .line = of.line, .kind = kind, .group = of.group, .node = std::move(corners)});
  }

  void cut_line(const MeshText::Element& line) {
    const long a = line.node.front(), b = line.node.back(), m = middle({a, b});
    add(line, "line", {a, m});
    add(line, "line", {m, b});
  }

  /// One quadrilateral at each corner: the corner, the middle of the edge behind it, the middle of the cell,
  /// the middle of the edge before it.
  void cut_flat(const MeshText::Element& cell) {
    const std::size_t n = cell.node.size();
    const long centre = middle(cell.node);
    for (std::size_t k = 0; k < n; ++k) {
      const long here = cell.node[k], next = cell.node[(k + 1) % n], before = cell.node[(k + n - 1) % n];
      add(cell, "quadrilateral", {here, middle({here, next}), centre, middle({before, here})});
    }
  }

  /// One hexahedron at each corner v with its neighbours a, b, c: v, the middles of the edges va, vb, vc, of
  /// the faces between them, and of the cell.
  void cut_solid(const MeshText::Element& cell) {
    const long centre = middle(cell.node);
    for (std::size_t v = 0; v < cell.node.size(); ++v) {
      std::vector<long> neighbour;  // over an edge, in the order of the faces
      std::vector<Corners> faces;   // that meet in v
      for (const auto& face : faces_of(cell.kind)) {
        const auto place = std::find(face.begin(), face.end(), v);
        if (place == face.end()) continue;
        const std::size_t k = static_cast<std::size_t>(place - face.begin()), n = face.size();
        Corners corners;
        for (const std::size_t corner : face) corners.push_back(cell.node[corner]);
        for (const std::size_t beside : {(k + 1) % n, (k + n - 1) % n})
          if (std::find(neighbour.begin(), neighbour.end(), corners[beside]) == neighbour.end())
            neighbour.push_back(corners[beside]);
        faces.push_back(std::move(corners));
      }
      const auto between = [&](long one, long other) {
        const auto has = [](const Corners& corners, long n) {
          return std::find(corners.begin(), corners.end(), n) != corners.end();
        };
        return middle(*std::find_if(faces.begin(), faces.end(),
                                    [&](const Corners& face) { return has(face, one) && has(face, other); }));
      };
      const long here = cell.node[v], a = neighbour[0], b = neighbour[1], c = neighbour[2];
      add(cell, "hexahedron",
          {here, middle({here, a}), between(a, b), middle({here, b}), middle({here, c}), between(a, c),
           centre, between(b, c)});
    }
  }

  const MeshText& mesh_;
  int dimension_;
  MeshText result_;
  std::map<Corners, long> middle_;  // sorted corners → node
  long next_ = 1;                   // number of the next node
};

}  // namespace

bool has_simplices(const MeshText& mesh, int dimension) {
  return std::any_of(mesh.element.begin(), mesh.element.end(), [&](const MeshText::Element& element) {
    return dimension == 2 ? element.kind == "triangle"
                          : element.kind == "tetrahedron" || element.kind == "prism";
  });
}

MeshText cut_into_quadrilaterals(const MeshText& mesh, int dimension) {
  return Cut(mesh, dimension).all();
}

}  // namespace strake::structure
