#include "structure/case/loaded_faces_keys.hpp"

#include "proto/error.hpp"
#include "structure/body/solid.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace strake::structure {

void read_loaded_faces(CaseTable t, bool only_declares, Parameters& p) {
  t.texts(
      "loaded_faces", p.loaded_faces,
      {.help = "faces that the water loads: left, right, bottom, top, back or front of the body, a physical "
               "name of its mesh, or PART.SIDE of a structure.box; others keep it out and feel nothing; "
               "[]: all of the outer surface"});
  std::vector<std::string> old_key;
  t.texts("wet", old_key, {.help = "name of loaded_faces before version 0.2"});
  if (only_declares) return;
  if (!old_key.empty() && !p.loaded_faces.empty())
    throw t.error("wet", "loaded_faces alone: wet is its older name", "leave wet out");
  p.loaded_by_old_key = !old_key.empty();
  if (p.loaded_by_old_key) p.loaded_faces = old_key;
  if (p.loaded_faces.empty()) return;
  const std::string key = p.loaded_by_old_key ? "wet" : "loaded_faces";
  const auto refuse = [&](const std::string& expected, const std::string& fix) {
    throw t.error(key, expected, fix);
  };
  if (p.interface == "volume")
    refuse("nothing: in volume coupling every particle of the body meets the water",
           "coupling.interface = \"surface\", or leave " + key + " out");
  if (p.shape.kind != ShapeKind::plate && p.shape.kind != ShapeKind::solid)
    refuse("nothing: only plates, boxes and meshes have faces with names", "leave " + key + " out");
  if (p.kind == "ccx" && !p.load_run.empty())
    refuse("nothing: CalculiX reads a recorded load itself, all of it",
           "structure.solver = \"fem\", or leave " + key + " out");
  const Solid solid = elastic_solid(p);
  std::vector<std::string> known(side_names.begin(), side_names.begin() + (p.dimension == 3 ? 6 : 4));
  for (const SupportedFace& face : solid.supported) known.push_back(face.name);
  for (const std::string& name : p.loaded_faces) {
    if (!facets_named(solid, name).empty()) continue;
    std::string all;
    for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
    const std::string near = did_you_mean(name, known);
    refuse(fmt::format("faces at the body's boundary, and \"{}\" is none: {}, or PART.SIDE", name, all),
           near.empty() ? key + " = [\"bottom\"]" : fmt::format("did you mean \"{}\"?", near));
  }
}

}  // namespace strake::structure
