#include "coupler/import/import_parts.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace strake {
namespace {

using Name = std::pair<std::string_view, const char*>;  // preCICE's, and that of the case file

constexpr std::array<Name, 6> kinds{{{"nearest-neighbor", "nearest-neighbour"},
                                     {"nearest-projection", "nearest-projection"},
                                     {"linear-cell-interpolation", "linear-cell"},
                                     {"rbf", "radial-basis"},
                                     {"rbf-pum-direct", "radial-basis"},
                                     {"rbf-global-direct", "radial-basis"}}};
constexpr std::array<Name, 4> functions{{{"compact-polynomial-c2", "wendland-c2"},
                                         {"compact-polynomial-c4", "wendland-c4"},
                                         {"compact-polynomial-c6", "wendland-c6"},
                                         {"thin-plate-splines", "thin-plate"}}};

template <std::size_t n>
const char* our_name(const std::array<Name, n>& names, const XmlElement& element) {
  std::string there_are;
  for (const auto& [theirs, ours] : names) {
    if (theirs == element.type()) return ours;
    there_are += fmt::format("{}{}", there_are.empty() ? "" : ", ", theirs);
  }
  element.refuse(fmt::format("is no {} of Strake", element.kind()), "one of " + there_are);
}

void import_radial(const XmlTree& mapping, ImportedMapping& ours) {
  const XmlElement& element = mapping.element;
  const XmlTree* basis = mapping.first("basis-function");
  if (!basis)
    element.refuse("has no basis function", "<basis-function:compact-polynomial-c6 support-radius=\"…\" />");
  ours.function = our_name(functions, basis->element);
  if (ours.function != "thin-plate")
    ours.support = number_of(basis->element, "support-radius", std::numeric_limits<double>::min(), 1e300);
  if (element.text_or("polynomial", "separate") == "off")
    element.refuse("polynomial = \"off\": Strake always reproduces constants", "polynomial=\"separate\"");
  ours.solve = element.type() == "rbf-global-direct" ? "global" : "partition";
  if (element.attributes.count("vertices-per-cluster"))
    ours.patch_points = integer_of(element, "vertices-per-cluster", 8, 500);
  if (element.attributes.count("relative-overlap"))
    ours.overlap = number_of(element, "relative-overlap", 0, 1);
}

ImportedMapping mapping_of(const XmlTree& tree) {
  ImportedMapping mapping;
  mapping.kind = {our_name(kinds, tree.element), place_of(tree.element)};
  if (mapping.kind.value == "radial-basis") import_radial(tree, mapping);
  return mapping;
}

bool equal(const ImportedMapping& a, const ImportedMapping& b) {
  return a.kind.value == b.kind.value && a.function == b.function && a.polynomial == b.polynomial &&
         a.solve == b.solve && a.support == b.support && a.patch_points == b.patch_points &&
         a.overlap == b.overlap;
}

void check_constraint(const XmlElement& element) {
  const std::string constraint = element.text("constraint");
  if (constraint == "conservative" || constraint == "consistent") return;
  element.refuse(fmt::format("constraint = \"{}\" is not in Strake for data of a preCICE solver", constraint),
                 "conservative for a force, consistent for a value per area");
}

/// All mappings of a configuration between the meshes of both sides.
class Mappings {
 public:
  explicit Mappings(const Configuration& from) {
    for (const XmlTree* participant : from.tree.all("participant"))
      for (const XmlTree* mapping : participant->all("mapping")) all_.push_back(mapping);
  }

  const std::vector<const XmlTree*>& all() const { return all_; }

  const XmlTree* between(const std::string& from, const std::string& to) const {
    for (const XmlTree* mapping : all_)
      if (mapping->element.text_or("from", "") == from && mapping->element.text_or("to", "") == to)
        return mapping;
    return nullptr;
  }

 private:
  std::vector<const XmlTree*> all_;
};

void check_meshes(const XmlElement& element, const ImportedRun& run) {
  for (const char* end : {"from", "to"})
    if (!element.attributes.count(end))
      element.refuse(fmt::format("has no {}: Strake maps between meshes, not to points given later", end),
                     fmt::format("<{} from=\"{}\" to=\"{}\" … />", element.name, run.fluid.meshes.front(),
                                 run.structure.meshes.front()));
  const auto provides = [](const ImportedSide& side, const std::string& mesh) {
    return std::find(side.meshes.begin(), side.meshes.end(), mesh) != side.meshes.end();
  };
  const std::string begin = element.text("from"), end = element.text("to");
  if (!(provides(run.fluid, begin) && provides(run.structure, end)) &&
      !(provides(run.structure, begin) && provides(run.fluid, end)))
    element.refuse(fmt::format("goes from {} to {}", begin, end),
                   fmt::format("between {} and {}, the meshes of both participants", joined(run.fluid.meshes),
                               joined(run.structure.meshes)));
}

/// All that is sent needs a mapping from the mesh where it is written to that where it is read.
void check_sent(const Configuration& from, const Mappings& mappings, const ImportedSide& sender,
                const ImportedSide& receiver) {
  const auto* writer = from.config.find_participant(sender.participant.value);
  const auto* reader = from.config.find_participant(receiver.participant.value);
  for (const std::string& data : sender.sends) {
    const std::string begin = mesh_of(writer->writes, data, sender),
                      end = mesh_of(reader->reads, data, receiver);
    if (!mappings.between(begin, end))
      from.tree.element.refuse(
          fmt::format("has no mapping from {} to {}, for {}", begin, end, data),
          fmt::format("<mapping:nearest-neighbor direction=\"…\" from=\"{}\" to=\"{}\" constraint=\"…\" />",
                      begin, end));
  }
}

}  // namespace

void import_mapping(const Configuration& from, ImportedRun& run) {
  const Mappings mappings(from);
  for (const XmlTree* mapping : mappings.all()) {
    check_meshes(mapping->element, run);
    check_constraint(mapping->element);
    const ImportedMapping ours = mapping_of(*mapping);
    if (run.mapping.kind.value.empty()) run.mapping = ours;
    if (!equal(run.mapping, ours))
      mapping->element.refuse(
          fmt::format("is not the mapping of {}, and Strake has one mapping for both ways",
                      run.mapping.kind.from),
          "the same mapping with the same numbers both ways");
  }
  check_sent(from, mappings, run.fluid, run.structure);
  check_sent(from, mappings, run.structure, run.fluid);
}

}  // namespace strake
