#include "coupler/participant/interface_record.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {

using Eigen::Index;

std::vector<MeshPart> parts_in(const Archive& archive) {
  const std::string prefix = "body.";
  std::vector<MeshPart> parts;
  for (const auto& [name, begin] : archive.integer)
    if (name.starts_with(prefix) && begin.size() == 2)
      parts.push_back({name.substr(prefix.size()), begin[0], begin[1]});
  std::sort(parts.begin(), parts.end(),
            [](const MeshPart& a, const MeshPart& b) { return a.first_point < b.first_point; });
  return parts;
}

InterfaceRecord InterfaceRecord::of_body(const std::string& name, const std::string& source) const {
  const auto part = std::find_if(mesh.parts.begin(), mesh.parts.end(),
                                 [&](const MeshPart& one) { return one.name == name; });
  if (part == mesh.parts.end()) {
    std::string names;
    for (const MeshPart& one : mesh.parts) names += (names.empty() ? "" : ", ") + one.name;
    throw Error(ExitCode::case_file, source, "holds no body " + name,
                names.empty() ? "it is the record of one [structure]" : "its bodies are " + names);
  }
  const bool last = part + 1 == mesh.parts.end();
  const Index point = part->first_point, points = (last ? mesh.position.cols() : part[1].first_point) - point,
              face = part->first_face, faces = (last ? mesh.faces.cols() : part[1].first_face) - face;
  if (point < 0 || points < 0 || face < 0 || faces < 0 || point + points > mesh.position.cols() ||
      face + faces > mesh.faces.cols())
    throw Error(ExitCode::case_file, source, "the body " + name + " lies outside the record's mesh",
                "record the run again");
  const auto cut = [&](const Points& all) {
    return all.size() == 0 ? Points() : Points(all.middleCols(point, points));
  };
  InterfaceRecord own;
  own.mesh.name = mesh.name;
  own.mesh.dimension = mesh.dimension;
  own.mesh.position = cut(mesh.position);
  own.mesh.faces = mesh.faces.middleCols(face, faces).array() - static_cast<int>(point);
  if (mesh.mass.size() > 0) own.mesh.mass = mesh.mass.segment(point, points);
  own.initial_displacement = cut(initial_displacement);
  own.initial_velocity = cut(initial_velocity);
  own.windows = windows;
  for (const Points& field : displacement) own.displacement.push_back(cut(field));
  for (const Points& field : velocity) own.velocity.push_back(cut(field));
  for (const Points& field : force) own.force.push_back(cut(field));
  for (const auto& [quantity, field] : other) {
    Other& part_of_it = own.other[quantity];
    part_of_it.unit = field.unit;
    for (const Eigen::MatrixXd& values : field.value)
      part_of_it.value.push_back(values.middleCols(point, points));
  }
  return own;
}

void require_end(const InterfaceRecord& record, double end_time, const std::string& source) {
  constexpr double round_off = 1e-9;
  if (end_time <= record.end() * (1 + round_off)) return;
  throw Error(ExitCode::case_file, source,
              fmt::format("the record ends at {:.6g} s, before end_time = {:.6g} s", record.end(), end_time),
              fmt::format("end_time = {:.6g}", record.end()));
}

}  // namespace strake
