#include "coupler/import/import_parts.hpp"
#include "coupler/precice/config/quantities.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace strake {
namespace {

/// The rule for a name of data: one of Strake's quantities where the name, the number of components and the
/// mapping agree with it, else a quantity of that name without a unit.
std::string rule_of(const PreciceConfig::Data& data, bool conservative) {
  const Quantity known = QuantityNames("").of(data.name, conservative);
  const bool is_known = known.components != 0;
  if (is_known && (known.components > 1) == data.vector && known.conservative == conservative)
    return data.name + "=" + known.name;
  // A name that is spelt as a quantity is kept apart from it.
  return data.name + "=" + data.name + (is_known && known.name == data.name ? "-data" : "");
}

/// Names become part of the case file and of STRAKE_PRECICE_NAMES.
void check_name(const XmlElement& element, const std::string& name) {
  const bool printable =
      std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 127; });
  if (name.empty() || !printable || name.find_first_of("\"\\;=") != std::string::npos)
    element.refuse(fmt::format("has the name \"{}\"", visible(name, "")),
                   "a name without quotation marks, \\, ; and =");
}

/// The meshes that a participant provides: at least one, in one space, and none of them its partner's.
std::vector<std::string> own_meshes(const Configuration& from, const XmlTree& participant) {
  const std::string owner = participant.element.text("name");
  const auto provided = participant.all("provide-mesh");
  if (provided.empty())
    participant.element.refuse(fmt::format("{} provides no mesh", owner), "<provide-mesh name=\"…\" />");
  std::vector<std::string> names;
  for (const XmlTree* mesh : provided) {
    const std::string name = mesh->element.text("name");
    if (std::find(names.begin(), names.end(), name) != names.end())
      mesh->element.refuse(fmt::format("is the mesh {} of {} once more", name, owner), "once");
    for (const auto& other : from.config.participants)
      if (other.name != owner &&
          std::find(other.provided.begin(), other.provided.end(), name) != other.provided.end())
        mesh->element.refuse(fmt::format("{} is provided by {} as well", name, other.name),
                             "one participant that provides it; the other one receives it");
    const int dimension = from.config.find_mesh(name)->dimension;
    if (!names.empty() && dimension != from.config.find_mesh(names.front())->dimension)
      mesh->element.refuse(
          fmt::format("{} has {} dimensions, and {} of {} has not", name, dimension, names.front(), owner),
          "all meshes of a participant in one space");
    names.push_back(name);
  }
  return names;
}

/// A participant has each data on one of its meshes.
void check_data(const XmlTree& participant) {
  for (const char* kind : {"write-data", "read-data"}) {
    std::map<std::string, std::string> mesh_of;
    for (const XmlTree* one : participant.all(kind)) {
      const std::string data = one->element.text("name"), mesh = one->element.text("mesh");
      const auto [known, is_new] = mesh_of.emplace(data, mesh);
      if (!is_new && known->second != mesh)
        one->element.refuse(fmt::format("has {} on {} after {}, and in Strake a participant has each data on "
                                        "one mesh",
                                        data, mesh, known->second),
                            "data of another name for the other mesh");
    }
  }
}

const XmlTree& participant_of(const XmlTree& tree, const std::string& name) {
  for (const XmlTree* one : tree.all("participant"))
    if (one->element.text("name") == name) return *one;
  tree.element.refuse(fmt::format("has no participant {}", name), "");
}

void check_participants(const XmlTree& tree) {
  const auto participants = tree.all("participant");
  if (participants.size() > 2)
    participants[2]->element.refuse(fmt::format("{} is a third participant, and Strake couples two",
                                                participants[2]->element.text("name")),
                                    "a configuration of two participants");
  if (participants.size() < 2)
    tree.element.refuse(
        fmt::format("has {} participant{}", participants.size(), participants.empty() ? "s" : ""),
        "a configuration of two participants");
}

void check_schemes(const XmlTree& tree) {
  const auto schemes = tree.all("coupling-scheme");
  if (schemes.empty()) tree.element.refuse("has no coupling scheme", "<coupling-scheme:serial-implicit> … ");
  const XmlElement& first = schemes.front()->element;
  if (first.type() == "multi")
    first.refuse("couples more than two participants, and Strake couples two",
                 "serial-implicit or parallel-implicit");
  if (schemes.size() > 1)
    schemes[1]->element.refuse("is a second scheme: Strake has no composition of schemes", "one scheme");
  if (!schemes.front()->first("participants"))
    first.refuse("names no participants", "<participants first=\"…\" second=\"…\" />");
}

ImportedSide side_of(const Configuration& from, const std::string& which) {
  const XmlElement& both = from.scheme().first("participants")->element;
  const std::string name = both.text(which);
  check_name(both, name);
  const XmlTree& participant = participant_of(from.tree, name);
  check_data(participant);
  return {.participant = {name, place_of(both)},
          .meshes = own_meshes(from, participant),
          .sends = {},
          .names = {}};
}

/// What a participant sends, from the exchanges of the scheme; at least one data.
void import_exchanges(const Configuration& from, ImportedSide& side, const ImportedSide& other,
                      std::vector<std::string>& names) {
  for (const XmlTree* exchange : from.scheme().all("exchange")) {
    const XmlElement& element = exchange->element;
    if (element.text("from") == element.text("to"))
      element.refuse(fmt::format("goes from {0} to {0}", element.text("from")),
                     "from one participant to the other");
    for (const char* end : {"from", "to"})
      if (const std::string name = element.text(end);
          name != side.participant.value && name != other.participant.value)
        element.refuse(fmt::format("{} = \"{}\" is no participant of this scheme", end, name),
                       fmt::format("{} or {}", side.participant.value, other.participant.value));
    if (element.text("from") != side.participant.value) continue;
    const std::string data = element.text("data");
    check_name(element, data);
    side.sends.push_back(data);
    const std::string mesh =
        mesh_of(from.config.find_participant(side.participant.value)->writes, data, side);
    names.push_back(rule_of(*from.config.find_data(data), from.config.conservative({mesh, data})));
  }
  if (side.sends.empty())
    from.scheme().element.refuse(fmt::format("sends nothing from {} to {}, and Strake couples both ways",
                                             side.participant.value, other.participant.value),
                                 fmt::format("<exchange data=\"…\" mesh=\"…\" from=\"{}\" to=\"{}\" />",
                                             side.participant.value, other.participant.value));
}

}  // namespace

std::string mesh_of(const std::vector<PreciceConfig::MeshData>& list, const std::string& data,
                    const ImportedSide& side) {
  for (const auto& entry : list)
    if (entry.data == data) return entry.mesh;
  return side.meshes.front();
}

void import_sides(const Configuration& from, ImportedRun& run) {
  check_participants(from.tree);
  check_schemes(from.tree);
  run.fluid = side_of(from, "first");
  run.structure = side_of(from, "second");
  if (run.fluid.participant.value == run.structure.participant.value)
    from.scheme()
        .first("participants")
        ->element.refuse("couples a participant with itself", "two participants");
  std::vector<std::string> names;
  import_exchanges(from, run.fluid, run.structure, names);
  import_exchanges(from, run.structure, run.fluid, names);
  run.fluid.names = run.structure.names = names;
  for (const XmlTree* participant : from.tree.all("participant"))
    for (const XmlTree* mesh : participant->all("receive-mesh"))
      for (const char* filter : {"safety-factor", "geometric-filter"})
        if (mesh->element.attributes.count(filter))
          run.notes.push_back(fmt::format("line {}: {} is left out: every participant gets the whole mesh",
                                          mesh->element.line, filter));
}

}  // namespace strake
