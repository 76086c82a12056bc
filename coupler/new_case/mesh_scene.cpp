// Scene of a rigid body from a mesh file.

#include "coupler/new_case/case_lines.hpp"
#include "coupler/new_case/scenes.hpp"
#include "coupler/summary/start.hpp"
#include "proto/error.hpp"
#include "proto/mesh_files/mesh_text.hpp"
#include "proto/mesh_files/stl.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace strake {
namespace {

/// Smallest and largest coordinates of a mesh's nodes, in the file's unit.
struct MeshExtent {
  std::array<double, 3> min = {}, max = {};
};

/// The nodes of a mesh file, 3×n; an STL file gives the corners of its triangles.
Points nodes_of(const std::filesystem::path& file) {
  if (is_stl(file)) return read_stl(file);
  if (const std::string ending = lower_case(file.extension().string()); ending != ".msh" && ending != ".inp")
    throw Error(ExitCode::case_file, file.string(), "a mesh file ends in .msh (Gmsh), .inp (Abaqus) or .stl",
                "gmsh -2 -format msh41 FILE.geo");
  const MeshText mesh = read_mesh_text(file);
  Points nodes(3, static_cast<Eigen::Index>(mesh.node.size()));
  Eigen::Index k = 0;
  for (const auto& [number, place] : mesh.node)
    nodes.col(k++) = Eigen::Map<const Eigen::Vector3d>(place.data());
  return nodes;
}

MeshExtent read_mesh_extent(const std::filesystem::path& file) {
  const Points nodes = nodes_of(file);
  MeshExtent extent;
  for (std::size_t k = 0; k < 3 && nodes.cols() > 0; ++k) {
    extent.min[k] = nodes.row(static_cast<Eigen::Index>(k)).minCoeff();
    extent.max[k] = nodes.row(static_cast<Eigen::Index>(k)).maxCoeff();
  }
  if (!is_stl(file) && (!(extent.max[0] > extent.min[0]) || !(extent.max[1] > extent.min[1])))
    throw Error(ExitCode::case_file, file.string(), "holds no nodes that span an area",
                "a mesh of Gmsh (.msh, ASCII), Abaqus (.inp) or STL (.stl)");
  return extent;
}

/// A tank around a body in space. Walls and floor stand one `narrow` [m] from it, the smaller of its two
/// widths.
///
/// A square plate meets the water of such a tank, and of one 1.5 times as deep, with 1.3 % more impulse than
/// that of open water (cases/VALIDATION.md, "Plates in space").
void put_space_tank(NewScene& s, double wide_x, double wide_z, double height) {
  const double narrow = std::max(std::min(wide_x, wide_z), 0.1 * std::max(wide_x, wide_z));
  s.right = s.water_right = 0.5 * wide_x + narrow;
  s.left = -s.right;
  s.front = 0.5 * wide_z + narrow;
  s.back = -s.front;
  s.bottom = -narrow;
  s.top = height + 0.5 * narrow;
}

/// Makes all lengths of the tank in space whole spacings.
///
/// The water reaches at least four spacings down and to each side of the body: the fluid refuses thinner
/// water, and a coarse spacing may be larger than a slender body's tank.
void round_up(NewScene& s, double wide_x, double wide_z) {
  const double least = 4 * s.spacing;
  s.right = std::max(s.right, 0.5 * wide_x + least);
  s.front = std::max(s.front, 0.5 * wide_z + least);
  s.left = -s.right;
  s.back = -s.front;
  s.bottom = std::min(s.bottom, -least);
  for (double* x : {&s.left, &s.right, &s.back, &s.front, &s.bottom, &s.top})
    *x = std::copysign(s.whole(std::abs(*x)), *x);
  s.water_right = s.right;
}

/// Turns a file whose z points up, (x, y, z) → (x, z, −y): by −90 degrees about x.
void turn_up(MeshExtent& mesh) {
  if (!(mesh.max[2] > mesh.min[2]))
    throw Error(ExitCode::command_line, "strake new mesh --up z",
                "expected y: the file lies in the plane z = 0", "leave --up out");
  std::swap(mesh.min[1], mesh.min[2]);
  std::swap(mesh.max[1], mesh.max[2]);
  std::swap(mesh.min[2], mesh.max[2]);
  for (double* z : {&mesh.min[2], &mesh.max[2]}) *z = -*z;
}

/// Moves tank and water to the mesh, which keeps its place.
void move_to(const MeshExtent& mesh, double gap, NewScene& s) {
  const auto middle_along = [&](std::size_t axis) {
    return s.spacing * std::round(0.5 * (mesh.min[axis] + mesh.max[axis]) / s.spacing);
  };
  const double x = middle_along(0), z = s.dimension == 3 ? middle_along(2) : 0;
  for (double* left_or_right : {&s.left, &s.right, &s.water_right}) *left_or_right += x;
  for (double* back_or_front : {&s.back, &s.front}) *back_or_front += z;
  s.surface = mesh.min[1] - gap;
  for (double* height : {&s.bottom, &s.top}) *height += s.surface;
}

/// Warns of a body larger than any ship, which a file in mm gives where --scale is left out; empty for
/// others.
std::string size_warning(std::array<double, 3> lengths, int dimension, double scale) {
  const std::string words = larger_than_ships(lengths, dimension);
  if (words.empty()) return {};
  return fmt::format("{}. If the file is in mm, write the case anew with --scale {:g}.", words,
                     0.001 * scale);
}

/// Says in comments what makes the body an elastic one.
void elastic_instead(double mass, CaseLines& lines) {
  lines.comment("Elastic in place of rigid: solver = \"fem\" or \"particle\", and these lines.")
      .comment("[structure.material]")
      .comment("density = 2700.0                      # kg/m^3, aluminium; its mass is that of the cells")
      .comment("young = 7.0e10                        # Pa")
      .comment("poisson = 0.33")
      .comment("[[structure.support]]                 # without one nothing holds or drives the body")
      .comment("on = \"NAME\"                           # a face that the file names")
      .comment("kind = \"clamped\"                      # or pinned, roller, symmetry");
  if (mass > 0)
    lines.comment("lumped.mass takes the place of mass above: what the supports carry beside the cells.");
}

}  // namespace

NewScene mesh_scene(const NewAnswers& answers) {
  MeshExtent mesh = read_mesh_extent(answers.mesh);
  const double scale = answers.value("scale");
  for (double& x : mesh.min) x *= scale;
  for (double& x : mesh.max) x *= scale;
  const bool turned = answers.up == "z";
  if (turned) turn_up(mesh);
  const double wide_x = mesh.max[0] - mesh.min[0], wide_z = mesh.max[2] - mesh.min[2],
               width = std::max(wide_x, wide_z), height = mesh.max[1] - mesh.min[1],
               speed = answers.value("speed");
  NewScene s;
  s.dimension = wide_z > 1e-6 * width ? 3 : 2;
  s.title = answers.mesh.stem().string() + " entry";
  s.physics =
      fmt::format("Rigid body of {}, {:.3g} m wide, {:.3g} m high, {}, {}-D.",
                  answers.mesh.filename().string(), width, height, motion_words(answers), s.dimension);
  if (s.dimension == 2) {
    s.spacing = chosen_spacing(answers, "body's width", width, 80);
    put_wide_tank(s, width, width, height + 0.5 * width);
  } else {
    put_space_tank(s, wide_x, wide_z, height);
    s.spacing = chosen_spacing_or(spacing_in_space(s), answers, "body's width", width);
    round_up(s, wide_x, wide_z);
  }
  s.warning = size_warning({wide_x, height, wide_z}, s.dimension, scale);
  const double gap = rigid_gap * s.spacing;
  move_to(mesh, gap, s);
  // A blade would come to the floor before half its height is in the water.
  const double way = std::min(0.5 * std::min(height, 0.5 * width), 0.8 * (s.surface - s.bottom));
  s.end_time = (gap + way) / speed;
  s.end_reason = "the body is deep in the water";
  CaseLines lines = rigid_body(answers, s.dimension);
  lines.text("mesh", answers.mesh_text, "file of the body, from this file's folder on");
  lines.number("placed.scale", scale, "factor on its lengths: 1 in m, 0.001 in mm");
  if (turned)
    lines.number("placed.angle", -90, "deg, about placed.axis: the file's z points up")
        .key("placed.axis", "[1.0, 0.0, 0.0]", "the file's x");
  else if (s.dimension == 3)
    lines.comment("The file's y points up. A file whose z does: strake new mesh --up z.");
  if (answers.mesh.extension() != ".stl" && answers.mesh.extension() != ".STL")
    elastic_instead(answers.value("mass"), lines);
  s.body = lines.str();
  return s;
}

}  // namespace strake
