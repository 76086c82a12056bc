#include "coupler/attachments/case/attachment_keys.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace strake {
namespace {

constexpr std::size_t most_attachments = 64, most_points = 256, longest_name = 40;
const std::string per_depth = "; 2-D: per metre of depth";

bool is_name(const std::string& name) {
  const auto inside = [](unsigned char c) { return c < 128 && (std::isalnum(c) != 0 || c == '_'); };
  return !name.empty() && name.size() <= longest_name && name.front() > '9' &&
         std::all_of(name.begin(), name.end(), inside);
}

void check_name(const CaseTable& table, const std::string& name, const CommonKeys& common,
                const std::vector<AttachmentKeys>& others) {
  if (!is_name(name))
    throw table.error("name",
                      fmt::format("letters, digits and '_', a letter first, at most {}", longest_name),
                      "name = \"mooring\"");
  constexpr std::array reserved = {"fluid", "structure", "structures", "coupling", "coupler", "both", "air"};
  const auto named_so = [&](const auto& other) { return other.name == name; };
  if (std::find(reserved.begin(), reserved.end(), name) != reserved.end() ||
      std::any_of(common.bodies.begin(), common.bodies.end(), named_so) ||
      std::any_of(common.probes.begin(), common.probes.end(), named_so) ||
      std::any_of(others.begin(), others.end(), named_so))
    throw table.error("name", "a name that no side, body, probe or other attachment has",
                      "name = \"" + name + "_2\"");
}

void read_body(CaseTable& table, AttachmentKeys& keys, const CommonKeys& common) {
  std::vector<std::string> bodies;
  for (const BodyKeys& body : common.bodies) bodies.push_back(body.name);
  table.text("body", keys.body,
             {.help = "of several bodies the name of the one that it is attached to; not given with one "
                      "[structure]"});
  if (table.has("body") && bodies.empty())
    throw table.error("body", "no such key: the case has one [structure]", "leave it out");
  if (bodies.empty()) return;
  if (std::find(bodies.begin(), bodies.end(), keys.body) == bodies.end())
    throw table.error("body", fmt::format("one of the bodies {}", joined(bodies)),
                      "body = \"" + bodies.front() + "\"");
}

/// What is read: the table of the chosen solver, that of another, or none, to list its keys.
enum class Reading { chosen, other, listing };

/// Refuses a list that has not one entry for each point.
template <class T>
void check_count(const CaseTable& table, const std::string& key, const std::vector<T>& list,
                 std::size_t points) {
  if (list.size() != points)
    throw table.error(key, fmt::format("one for each of the {} points of `at`, not {}", points, list.size()));
}

void read_spring(CaseTable table, const AttachmentKeys& keys, Reading reading, SpringParameters& p) {
  const bool chosen = reading == Reading::chosen, needed = reading != Reading::other;
  table.points("anchor", p.anchor,
               {.unit = "m", .at_least = 1, .required = chosen, .help = "fixed end of each, a list as `at`"});
  table.number("stiffness", p.stiffness,
               {.unit = "N/m",
                .min = 0,
                .required = needed,
                .conditional = true,
                .help = "force per length that it is longer" + per_depth});
  table.number("damping", p.damping,
               {.unit = "N s/m", .min = 0, .help = "force per speed along its line" + per_depth});
  double length = 0;
  table.number("length", length,
               {.unit = "m",
                .min = 0,
                .required = reading == Reading::listing,  // listed without a default
                .conditional = true,
                .help = "without a force; not given: the distance at the start; 0: a force of -stiffness "
                        "times the displacement from the anchor, in every direction"});
  table.flag("slack", p.slack,
             {.help = "a rope: it pulls where it is longer than `length`, and never presses"});
  if (!chosen) return;
  check_count(table, "anchor", p.anchor, keys.at.size());
  for (std::size_t k = 0; k < keys.at.size(); ++k)
    p.length.push_back(table.has("length") ? length : (p.anchor[k] - keys.at[k]).norm());
  for (std::size_t k = 0; k < keys.at.size() && !table.has("length"); ++k)
    if (p.length[k] == 0)
      throw table.error("anchor", fmt::format("an end away from point {} of `at`", k + 1),
                        "length = 0 for a spring that is centred at its anchor");
}

void read_catenary(CaseTable table, const AttachmentKeys& keys, Reading reading, CatenaryParameters& p) {
  const bool chosen = reading == Reading::chosen, needed = reading != Reading::other;
  table.points("anchor", p.anchor,
               {.unit = "m", .at_least = 1, .required = chosen, .help = "fixed end of each, a list as `at`"});
  NumberKey length = positive("m", "of the line without a force"),
            weight = positive("N/m", "of the line in water, per metre of it" + per_depth),
            stiffness = positive("N", "E A: force per relative stretch" + per_depth);
  for (NumberKey* key : {&length, &weight, &stiffness}) {
    key->required = needed;
    key->conditional = true;
  }
  table.number("length", p.length, length);
  table.number("weight", p.weight, weight);
  table.number("axial_stiffness", p.axial_stiffness, stiffness);
  table.flag("bottom", p.bottom,
             {.help = "a level bottom at the anchor, without friction, on which the line may lie"});
  if (chosen) check_count(table, "anchor", p.anchor, keys.at.size());
}

void read_fmu(CaseTable table, Reading reading, FmuKeys& keys) {
  const bool chosen = reading == Reading::chosen;
  std::string file;
  table.text("file", file,
             {.required = chosen,
              .path = true,
              .help = "co-simulation unit of FMI 3.0 (.fmu), or the folder into which it was unpacked"});
  keys.file = file;
  std::error_code ignored;
  if (chosen && !file.empty() && !std::filesystem::is_regular_file(keys.file, ignored) &&
      !std::filesystem::is_directory(keys.file, ignored))
    throw table.error("file", "an .fmu file, or the folder of an unpacked one",
                      "relative paths start at the case file's folder; looked for " + file);
  table.texts("inputs", keys.inputs,
              {.help = "what it receives, a list of \"variable = displacement.y\" or \"velocity.x\", of the "
                       "second point \"displacement.y.2\""});
  table.texts("outputs", keys.outputs,
              {.required = chosen,
               .help = "what it gives, a list of \"force.y = variable\", of the second point \"force.y.2\""});
  table.texts("parameters", keys.parameters, {.help = "its parameters, a list of \"variable = 3.5\""});
}

/// Tables of solvers that are not chosen are declared, so that `explain` lists them, and may stand there.
AttachmentKeys read_one(CaseTable table, const CommonKeys& common, const std::vector<AttachmentKeys>& others,
                        bool only_declares) {
  AttachmentKeys keys;
  table.text("name", keys.name,
             {.required = true, .help = "of its columns, its log and --set attachments.NAME.KEY"});
  if (!only_declares) check_name(table, keys.name, common, others);
  read_body(table, keys, common);
  table.points("at", keys.at,
               {.unit = "m",
                .at_least = 1,
                .required = true,
                .help = "points on the body's surface, reference configuration"});
  if (keys.at.size() > most_points) throw table.error("at", fmt::format("at most {} points", most_points));
  keys.solver = "spring";
  table.choice("solver", keys.solver, {"spring", "catenary", "fmu"},
               {.required = true, .or_path = true, .help = "what computes the force on these points"});
  const auto reading = [&](const char* name) {
    return only_declares ? Reading::listing : keys.solver == name ? Reading::chosen : Reading::other;
  };
  read_spring(table.table("spring", "where solver = \"spring\": a spring with a damper from each point"),
              keys, reading("spring"), keys.spring);
  read_catenary(table.table("catenary", "where solver = \"catenary\": a mooring line from each point"), keys,
                reading("catenary"), keys.catenary);
  read_fmu(table.table("fmu", "where solver = \"fmu\": a co-simulation unit of FMI 3.0"), reading("fmu"),
           keys.fmu);
  if (keys.is_users())
    for (const std::string& key : table.keys())
      if (key == std::filesystem::path(keys.solver).stem()) table.table(key).accept_all();
  return keys;
}

}  // namespace

std::vector<AttachmentKeys> read_attachments(CaseFile& file, const CommonKeys& common) {
  std::vector<AttachmentKeys> all;
  const bool only_declares = file.only_declares();
  for (const CaseTable& table : file.root().tables(
           "attachments", "what is coupled to points of a structure: springs, mooring lines, controllers"))
    all.push_back(read_one(table, common, all, only_declares));
  if (only_declares || all.empty()) return all;
  const CaseTable root = file.root();
  if (all.size() > most_attachments)
    throw root.error("attachments", fmt::format("at most {}, not {}", most_attachments, all.size()),
                     "one with several points `at` instead of several");
  if (common.fluid_solver == "none" || common.structure_solver == "none")
    throw root.error("attachments", "a fluid and a structure: an attachment joins their coupling",
                     "leave out [[attachments]]");
  if (common.interface == "volume")
    throw root.error("attachments", "coupling.interface = \"surface\": they are attached to its points",
                     "interface = \"surface\"");
  return all;
}

}  // namespace strake
