#include "coupler/participant/precice/partner_surface.hpp"

#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"
#include "proto/geometry/face_direction.hpp"
#include "proto/mesh_files/mesh_text.hpp"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <utility>

namespace strake {
namespace {

using Eigen::Index;

/// The surface in a mesh file: the points that its faces use, in the order of the file's numbers.
class SurfaceOfFile {
 public:
  SurfaceOfFile(const MeshText& text, int dimension, std::string where)
      : text_(text), where_(std::move(where)) {
    mesh_.dimension = dimension;
    take_points();
    take_faces();
    if (!orient(mesh_.faces, mesh_.position))
      refuse("more than two faces meet, or the surface has one side only",
             "mesh the outer surface of the body alone");
  }
  InterfaceMesh& mesh() { return mesh_; }

  /// Vectors on the nodes; zero where the file has none.
  Field field(const std::string& quantity, const std::string& unit) const {
    Eigen::MatrixXd value = Eigen::MatrixXd::Zero(3, mesh_.position.cols());
    if (const auto data = text_.node_data.find(quantity); data != text_.node_data.end())
      for (const auto& [node, point] : point_)
        if (const auto found = data->second.find(node); found != data->second.end())
          for (Index k = 0; k < 3; ++k) value(k, point) = found->second[static_cast<std::size_t>(k)];
    return {quantity, unit, false, std::move(value)};
  }

 private:
  [[noreturn]] void refuse(const std::string& problem, const std::string& fix) const {
    throw Error(ExitCode::case_file, where_, problem, fix);
  }

  void take_points() {
    for (const MeshText::Element& element : text_.element)
      if (is_face(element, mesh_.dimension))
        for (const long node : element.node) point_[node] = 0;
    mesh_.position.resize(3, static_cast<Index>(point_.size()));
    int next = 0;
    for (auto& [node, point] : point_) {
      const auto found = text_.node.find(node);
      if (found == text_.node.end()) refuse(fmt::format("there is no node {}", node), "write the mesh anew");
      point = next++;
      for (Index k = 0; k < 3; ++k) mesh_.position(k, point) = found->second[static_cast<std::size_t>(k)];
    }
  }

  void take_faces() {
    std::vector<std::vector<int>> walks;
    for (const MeshText::Element& element : text_.element) {
      if (!is_face(element, mesh_.dimension)) continue;
      walks.emplace_back();
      for (const long node : element.node) walks.back().push_back(point_.at(node));
    }
    mesh_.faces = faces_of(walks, mesh_.position, mesh_.dimension, where_);
  }

  const MeshText& text_;
  std::string where_;
  InterfaceMesh mesh_;
  std::map<long, int> point_;  // of a node
};

/// What the structure program of the case prints with --interface.
MeshText ask_structure(const BodySource& body) {
  const std::string program = "strake-structure-" + body.solver;
  std::vector<std::string> words = {"--interface", "--case", body.case_file.string()};
  for (const std::string& set : body.sets) words.insert(words.end(), {"--set", set});
  const Captured answer = capture(find_program(program), words, std::chrono::seconds(120));
  if (answer.exit_code == 0) return read_gmsh_text(answer.out, program + " --interface");
  if (answer.exit_code > 128)
    throw Error(ExitCode::participant_lost, program + " --interface",
                fmt::format("ended with exit code {}\n{}", answer.exit_code, answer.err));
  throw Error(static_cast<ExitCode>(answer.exit_code), "", answer.err);
}

}  // namespace

Setup setup_with_body(const BodySource& body, int dimension) {
  const std::string fix =
      "structure.solver = \"fem\" (or another one of Strake's) with the body's keys, or the surface as a "
      "mesh:\n"
      "[structure] solver = \"precice\" and [structure.precice] surface = \"body.msh\"";
  if (body.surface.empty() && body.solver == "none")
    throw Error(ExitCode::case_file, body.case_file.string(), "has no body for the water to meet", fix);
  if (body.surface.empty() && body.solver.find('/') != std::string::npos)
    throw Error(ExitCode::case_file, body.case_file.string(),
                fmt::format("says nothing of the surface that {} moves", body.solver), fix);
  const bool from_file = !body.surface.empty();
  const MeshText text = from_file ? read_mesh_text(body.surface) : ask_structure(body);
  SurfaceOfFile surface(text, dimension, from_file ? body.surface.string() : "structure");
  Setup setup;
  setup.interface = "surface";
  setup.partner_initial = {surface.field("displacement", "m"), surface.field("velocity", "m/s")};
  setup.partner_mesh = std::move(surface.mesh());
  return setup;
}

}  // namespace strake
