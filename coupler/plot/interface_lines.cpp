// A body without frames of its own, such as that of a user's program: its wet interface.
#include "coupler/plot/scene.hpp"
#include "proto/error.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace strake::picture {
namespace {

using Eigen::Index;

/// The faces as lines; of three dimensions where the plane z = `at` meets them. Without faces the points.
void add(const InterfaceMesh& mesh, const Points& place, std::optional<double> at, Scene& scene) {
  const auto span = [&](const Place& p) {
    scene.x.add(p.x);
    scene.y.add(p.y);
  };
  for (Index f = 0; f < mesh.faces.cols(); ++f) {
    std::vector<Place> line;
    if (at)
      line = section(place, mesh.faces.col(f), *at);
    else
      for (const int k : mesh.faces.col(f)) line.push_back({place(0, k), place(1, k)});
    if (line.size() < 2) continue;
    for (const Place& p : line) span(p);
    scene.lines.push_back(std::move(line));
  }
  if (mesh.faces.cols() > 0) return;
  if (!(scene.solid_spacing > 0)) scene.solid_spacing = scene.spacing;
  for (Index k = 0; k < place.cols(); ++k) {
    if (at && std::abs(place(2, k) - *at) > 0.5 * scene.spacing) continue;
    scene.solid.push_back({{place(0, k), place(1, k)}, std::numeric_limits<double>::quiet_NaN()});
    span(scene.solid.back().at);
  }
}

}  // namespace

std::shared_ptr<const InterfaceRecord> record_of(const std::filesystem::path& folder) {
  try {
    return std::make_shared<const InterfaceRecord>(read_interface_record(folder));
  } catch (const Error&) {  // none, or a damaged one: said where the picture is made
    return nullptr;
  }
}

void draw_interface(const RunFrames& run, const std::string& body, std::optional<double> at, Scene& scene) {
  const std::string name = body.empty() ? "structure" : body;
  if (body.empty() && at_or(run.keys, "structure.solver") == "none") return;
  const auto say = [&](const std::string& words) {
    scene.notes.push_back(fmt::format("{} has no frames: {}", name, words));
  };
  if (!run.interface || run.interface->windows.empty())
    return say("the run's files do not hold its surface, the water alone is drawn");
  try {
    const InterfaceRecord record =
        body.empty() ? *run.interface : run.interface->of_body(body, run.folder.string());
    Points place = record.mesh.position;
    if (!record.displacement.empty()) place += record.displacement_at(scene.time);
    add(record.mesh, place, at, scene);
    say(record.mesh.faces.cols() > 0 ? "its wet surface is drawn"
                                     : "the points of its wet surface are drawn");
  } catch (const Error&) {  // a record without that body
    say("the run's files do not hold its surface, the water alone is drawn");
  }
}

}  // namespace strake::picture
