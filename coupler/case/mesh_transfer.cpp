#include "coupler/case/mesh_transfer.hpp"

#include "coupler/case/rank_threads.hpp"
#include "coupler/mapping/mesh_part.hpp"
#include "proto/error.hpp"
#include "proto/lookup.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace strake {
namespace {

using Eigen::Index;

/// A participant as one end of a crossing.
struct End {
  const Participant& participant;
  const char* name;  // "structure" | "fluid"
  const InterfaceMesh& mesh() const { return participant.mesh(); }
  std::string title() const { return mesh().name.empty() ? name : mesh().name; }
};

/// The mesh on which a field is sent. A velocity that is not announced lives where the displacement does.
std::string sent_on(const End& end, const std::string& quantity) {
  if (!has_several_meshes(end.participant)) return end.title();
  const auto& mesh_of = end.participant.description().sent_on;
  auto found = mesh_of.find(quantity);
  if (found == mesh_of.end() && quantity == "velocity") found = mesh_of.find("displacement");
  if (found != mesh_of.end()) return found->second;
  throw Error(ExitCode::solver_fault, end.name,
              fmt::format("joins {} meshes and does not say on which one it sends {}",
                          end.mesh().meshes.size(), quantity),
              "see Ready.sent_on in proto/WIRE.md");
}

/// The mesh on which a field is taken; empty: on none.
std::string taken_on(const End& end, const std::string& quantity) {
  if (!has_several_meshes(end.participant)) return end.title();
  const auto& mesh_of = end.participant.description().taken_on;
  const auto found = mesh_of.find(quantity);
  return found == mesh_of.end() ? "" : found->second;
}

/// All mappings of a run; one between the same meshes is made once.
class Mappings {
 public:
  Mappings(End structure, End fluid, const MakeMapping& make)
      : structure_(structure), fluid_(fluid), make_(make) {}

  Crossing crossing(Sender sender, const Field& field) {
    const bool of_structure = sender == Sender::structure;
    const End &from = of_structure ? structure_ : fluid_, &to = of_structure ? fluid_ : structure_;
    const std::string source = sent_on(from, field.quantity), target = taken_on(to, field.quantity);
    const bool back = FieldTransfer::needs_way_back(sender, field);
    const auto& [on_structure, on_fluid] =
        of_structure ? std::pair(source, target) : std::pair(target, source);
    if (target.empty())
      return {
          field.quantity, sender, "", "", back, none(back), of_structure ? points(structure_, source) : 0};
    const Mapping& mapping = between(on_structure, on_fluid, back);
    return {field.quantity, sender, on_structure, on_fluid, back, mapping, points(structure_, on_structure)};
  }

  /// A matrix without entries, of the right size.
  Mapping none(bool back) const {
    const Index n_structure = structure_.mesh().position.cols(), n_fluid = fluid_.mesh().position.cols();
    return Mapping(back ? Mapping::Matrix(n_structure, n_fluid) : Mapping::Matrix(n_fluid, n_structure));
  }

  /// From one mesh of the structure to another; none if they are one.
  std::optional<Mapping> inside_structure(const std::string& from, const std::string& to) const {
    if (from == to) return std::nullopt;
    const InterfaceMesh& all = structure_.mesh();
    return embedded(make_(mesh_part(all, from), mesh_part(all, to)), all, range_of(all, from), all,
                    range_of(all, to));
  }

 private:
  static Index points(const End& end, const std::string& mesh) { return range_of(end.mesh(), mesh).points; }

  const Mapping& between(const std::string& on_structure, const std::string& on_fluid, bool back) {
    const auto key = std::tuple(on_structure, on_fluid, back);
    const auto known = made_.find(key);
    if (known != made_.end()) return known->second;
    const End &from = back ? fluid_ : structure_, &to = back ? structure_ : fluid_;
    const std::string &source = back ? on_fluid : on_structure, &target = back ? on_structure : on_fluid;
    const Mapping own = make_(mesh_part(from.mesh(), source), mesh_part(to.mesh(), target));
    return made_
        .emplace(key, embedded(own, from.mesh(), range_of(from.mesh(), source), to.mesh(),
                               range_of(to.mesh(), target)))
        .first->second;
  }

  End structure_, fluid_;
  const MakeMapping& make_;
  std::map<std::tuple<std::string, std::string, bool>, Mapping> made_;
};

std::string mesh_that_moves(const Participant& structure) {
  if (!has_several_meshes(structure)) return {};
  const Description& description = structure.description();
  const std::string first = description.initial.empty() ? "displacement" : description.initial[0].quantity;
  const bool moves = description.sent_on.contains("displacement");
  return sent_on({structure, "structure"}, moves ? "displacement" : first);
}

}  // namespace

bool has_several_meshes(const Participant& participant) {
  return !participant.mesh().meshes.empty();
}

FieldTransfer transfer_between_meshes(const Participant& structure, const Participant& fluid,
                                      const MakeMapping& make) {
  Mappings mappings({structure, "structure"}, {fluid, "fluid"}, make);
  const StructureSample of_structure = fields_of_structure(structure);
  const std::vector<Field> of_fluid = fields_of_fluid(fluid);
  std::vector<Crossing> crossings;
  std::optional<Mapping> to_fluid, to_structure;
  const auto add = [&](Sender sender, const Field& field) {
    crossings.push_back(mappings.crossing(sender, field));
    const Crossing& made = crossings.back();
    std::optional<Mapping>& first = made.back ? to_structure : to_fluid;
    if (!first && made.taken()) first = made.mapping;
  };
  for (const Field& field : of_structure.fields()) add(Sender::structure, field);
  for (const Field& field : of_fluid) add(Sender::fluid, field);
  if (!to_fluid) to_fluid = mappings.none(false);
  if (!to_structure && FieldTransfer::needs_way_back(of_structure, of_fluid))
    to_structure = mappings.none(true);
  std::optional<Mapping> to_loaded;
  if (of_structure.motion && find(of_fluid, "force") && has_several_meshes(structure)) {
    const std::string loaded = taken_on({structure, "structure"}, "force");
    if (!loaded.empty())
      to_loaded = mappings.inside_structure(sent_on({structure, "structure"}, "displacement"), loaded);
  }
  return {*std::move(to_fluid), std::move(to_structure), std::move(crossings), std::move(to_loaded)};
}

bool takes_nearest(const MappingParameters& mapping, const InterfaceMesh& from) {
  return from.faces.cols() == 0 && (mapping.kind == "nearest-projection" || mapping.kind == "linear-cell");
}

std::vector<std::string> lines_of_crossings(const FieldTransfer& transfer, const MappingParameters& mapping,
                                            const Participant& structure, const Participant& fluid) {
  std::vector<std::string> lines;
  std::set<std::tuple<std::string, std::string, bool>> told;
  const auto& all = transfer.crossings();
  for (const Crossing& one : all) {
    if (!one.taken() || !told.insert(std::tuple(one.of_structure, one.of_fluid, one.back)).second) continue;
    std::string quantities;
    for (const Crossing& other : all)
      if (other.of_structure == one.of_structure && other.of_fluid == one.of_fluid && other.back == one.back)
        quantities += (quantities.empty() ? "" : ", ") + other.quantity;
    const InterfaceMesh &source = (one.back ? fluid : structure).mesh(),
                        &target = (one.back ? structure : fluid).mesh();
    const bool nearest =
        takes_nearest(mapping, mesh_part(source, one.back ? one.of_fluid : one.of_structure));
    lines.push_back(fmt::format("{}: {} of the structure, {} of the fluid{}", quantities, one.of_structure,
                                one.of_fluid, nearest ? ", without faces: nearest points" : ""));
    for (const std::string& line : quality_lines(one.mapping.quality(), target.position, one.back))
      lines.push_back("  " + line);
  }
  for (const Crossing& one : all)
    if (!one.taken() && one.quantity != "velocity")
      lines.push_back(fmt::format("{} of the {} is not taken by its partner", one.quantity,
                                  one.sender == Sender::fluid ? "fluid" : "structure"));
  return lines;
}

const MappingQuality& quality_of_load(const FieldTransfer& transfer) {
  for (const Crossing& one : transfer.crossings())
    if (one.taken() && one.sender == Sender::fluid && !one.back) return one.mapping.quality();
  return transfer.to_fluid().quality();
}

InterfaceMesh mesh_for_fluid(const Participant& structure) {
  return mesh_part(structure.mesh(), mesh_that_moves(structure));
}

std::vector<Field> initial_for_fluid(const Participant& structure) {
  const std::vector<Field>& all = structure.description().initial;
  if (!has_several_meshes(structure)) return all;
  const Points points = mesh_for_fluid(structure).position;
  std::vector<Field> fields;
  for (const Field& field : all) {
    const MeshRange range = range_of(structure.mesh(), sent_on({structure, "structure"}, field.quantity));
    if (range.points != points.cols() ||
        structure.mesh().position.middleCols(range.point, range.points) != points)
      continue;
    fields.push_back(on_part(field, range));
  }
  return fields;
}

void check_motion(const CaseView& view, const std::string& side, const Participant& structure) {
  const std::vector<Field>& sent = structure.description().initial;
  if (!view.coupled() || view.fluid->solver != "mps" || sent.empty() || find(sent, "displacement")) return;
  std::vector<std::string> names;
  for (const Field& field : sent) names.push_back(field.quantity);
  const std::string table = table_of(*std::ranges::find(view.structures, side, &SideView::side));
  throw Error(
      ExitCode::case_file, side,
      fmt::format("sends no displacement, which the water follows; it sends {}", visible(joined(names), "")),
      fmt::format("a program with a preCICE adapter: {}.precice_names = [\"{}=displacement\"]\n"
                  "(of solver = \"precice\": precice.write), where that is the displacement",
                  table, visible(names.front(), "")));
}

namespace {

/// The corners of fluid.tank or fluid.tank_polygon, 3×n [m]; none where there is neither.
Points corners_of_tank(const CaseView& view) {
  const std::vector<double> numbers = numbers_in(at_or(view.value, "fluid.tank"));
  if (numbers.size() == 6) return Eigen::Map<const Points>(numbers.data(), 3, 2);
  if (numbers.size() == 4) {
    Points corners = Points::Zero(3, 2);
    corners.topRows<2>() = Eigen::Map<const Eigen::Matrix2d>(numbers.data());
    return corners;
  }
  const std::vector<double> polygon = numbers_in(at_or(view.value, "fluid.tank_polygon"));
  bool flat = polygon.size() % 3 == 0;  // each third number is a z of 0
  for (std::size_t i = 2; i < polygon.size(); i += 3) flat = flat && polygon[i] == 0;
  if (flat || polygon.size() % 2 != 0) return Points::Zero(3, 0);  // 2 or 3 numbers a corner cannot be told
  Points corners = Points::Zero(3, static_cast<Eigen::Index>(polygon.size() / 2));
  corners.topRows<2>() = Eigen::Map<const Eigen::Matrix2Xd>(polygon.data(), 2, corners.cols());
  return corners;
}

}  // namespace

void check_within_tank(const CaseView& view, const std::string& side, const Participant& structure) {
  if (!view.coupled() || view.fluid->solver != "mps" || view.common.interface != "surface") return;
  const InterfaceMesh mesh = mesh_for_fluid(structure);
  const Points corners = corners_of_tank(view);
  const double spacing = view.number("fluid.spacing").value_or(0);
  if (corners.cols() == 0 || !(spacing > 0)) return;
  const std::vector<Field> initial = initial_for_fluid(structure);
  const Field* moved = find(initial, "displacement");
  const Eigen::Vector3d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
  const bool lid = at_or(view.value, "fluid.open_top") == "false";
  for (Eigen::Index k = 0; k < mesh.position.cols(); ++k) {
    Eigen::Vector3d x = mesh.position.col(k);
    if (moved != nullptr) x += moved->value.col(k);
    bool outside = false;
    for (Eigen::Index d = 0; d < mesh.dimension; ++d)
      outside =
          outside || x[d] < low[d] - 1.01 * spacing || ((d != 1 || lid) && x[d] > high[d] + 1.01 * spacing);
    if (!outside) continue;
    throw Error(
        ExitCode::case_file, side + ", t = 0 s",
        fmt::format("the body starts at ({:.6g}, {:.6g}{}) m, beyond the walls of the tank", x[0], x[1],
                    mesh.dimension == 3 ? fmt::format(", {:.6g}", x[2]) : ""),
        "move the body, or enlarge fluid.tank; all lengths are in m, also those of a program of your own: "
        "1 mm is 0.001");
  }
}

}  // namespace strake
