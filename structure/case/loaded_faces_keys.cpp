#include "structure/case/loaded_faces_keys.hpp"

#include "proto/error.hpp"
#include "structure/body/solid.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace strake::structure {

void read_wet(CaseTable t, bool only_declares, Parameters& p) {
  t.texts(
      "wet", p.wet,
      {.help = "faces that the water loads: left, right, bottom, top, back or front of the body, a physical "
               "name of its mesh, or PART.SIDE of a structure.box; others keep it out and feel nothing; "
               "[]: all of the outer surface"});
  if (only_declares || p.wet.empty()) return;
  const auto refuse = [&](const std::string& expected, const std::string& fix) {
    throw t.error("wet", expected, fix);
  };
  if (p.interface == "volume")
    refuse("nothing: in volume coupling every particle of the body meets the water",
           "coupling.interface = \"surface\", or leave wet out");
  if (p.shape.kind != ShapeKind::plate && p.shape.kind != ShapeKind::solid)
    refuse("nothing: only plates, boxes and meshes have faces with names", "leave wet out");
  if (p.kind == "ccx" && !p.load_run.empty())
    refuse("nothing: CalculiX reads a recorded load itself, all of it",
           "structure.solver = \"fem\", or leave wet out");
  const Solid solid = elastic_solid(p);
  std::vector<std::string> known(side_names.begin(), side_names.begin() + (p.dimension == 3 ? 6 : 4));
  for (const SupportedFace& face : solid.supported) known.push_back(face.name);
  for (const std::string& name : p.wet) {
    if (!facets_named(solid, name).empty()) continue;
    std::string all;
    for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
    const std::string near = did_you_mean(name, known);
    refuse(fmt::format("faces at the body's boundary, and \"{}\" is none: {}, or PART.SIDE", name, all),
           near.empty() ? "wet = [\"bottom\"]" : fmt::format("did you mean \"{}\"?", near));
  }
}

}  // namespace strake::structure
