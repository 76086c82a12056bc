#include "coupler/editor/declarations.hpp"
#include "proto/files/json_file.hpp"

#include <cmath>
#include <memory>

namespace strake {
namespace {

/// A key or table of the case file, with what stands below it in the order of the declarations.
struct Branch {
  const KeyInfo* info = nullptr;
  bool list = false;  // [[name]]
  std::vector<std::pair<std::string, std::unique_ptr<Branch>>> below;

  Branch& child(const std::string& name) {
    for (const auto& [known, branch] : below)
      if (known == name) return *branch;
    below.emplace_back(name, std::make_unique<Branch>());
    return *below.back().second;
  }
  bool is_table() const { return !below.empty() || (info && info->type == "table"); }
};

Branch tree_of(const std::vector<KeyInfo>& keys) {
  Branch root;
  for (const KeyInfo& key : keys) {
    Branch* branch = &root;
    for (std::size_t start = 0; start <= key.path.size();) {
      const std::size_t dot = std::min(key.path.find('.', start), key.path.size());
      std::string name = key.path.substr(start, dot - start);
      const bool list = name.ends_with("[]");
      branch = &branch->child(list ? name.substr(0, name.size() - 2) : name);
      branch->list = branch->list || list;
      start = dot + 1;
    }
    branch->info = &key;
  }
  return root;
}

/// 2 instead of 2.0: what most people write.
Json number_json(double x) {
  constexpr double exact = 1e15;  // whole numbers up to it are those of an integer
  if (x == std::floor(x) && std::abs(x) <= exact) return static_cast<std::int64_t>(x);
  return x;
}

/// Bounds of a number. One that may be inf has no upper bound here, since inf would lie above it.
void put_bounds(const KeyLimits& limits, Json& json) {
  if (limits.min) json[limits.above ? "exclusiveMinimum" : "minimum"] = number_json(*limits.min);
  if (limits.max && !limits.infinite) json["maximum"] = number_json(*limits.max);
}

Json array_of(Json items, std::size_t fewest, std::size_t most) {
  Json json = {{"type", "array"}, {"items", std::move(items)}};
  if (fewest > 0) json["minItems"] = fewest;
  if (most > 0) json["maxItems"] = most;
  return json;
}

Json vector_json(const KeyLimits& limits) {
  Json component = {{"type", "number"}};
  put_bounds(limits, component);
  return array_of(component, 2, 3);
}

Json choice_json(const KeyInfo& key) {
  Json json = {{"type", "string"}};
  if (key.limits.path)
    json["anyOf"] = {{{"enum", key.choices}}, {{"pattern", "/"}, {"description", "the path of a program"}}};
  else
    json["enum"] = key.choices;
  return json;
}

/// What a value must be, without its meaning. JSON has no inf: taplo writes null for it.
Json type_json(const KeyInfo& key) {
  const Json scalar = {{"type", {"string", "number", "boolean", "null"}}}, text = {{"type", "string"}};
  if (key.type == "number" || key.type == "integer") {
    Json json = {{"type", key.type}};
    put_bounds(key.limits, json);
    if (key.limits.infinite) json["type"] = {"number", "null"};
    return json;
  }
  if (key.type == "flag") return {{"type", "boolean"}};
  if (key.type == "choice") return choice_json(key);
  if (key.type == "vector") return vector_json(key.limits);
  if (key.type == "box") return array_of(vector_json(key.limits), 2, 2);
  if (key.type == "points") return array_of(vector_json(key.limits), key.limits.fewest, key.limits.most);
  if (key.type == "file" || key.type == "folder") return {{"type", "string"}, {"minLength", 1}};
  if (key.type == "texts") return {{"anyOf", {text, array_of(text, 0, 0)}}};
  if (key.type == "scalars") return {{"anyOf", {scalar, array_of(scalar, 0, 0)}}};
  if (key.type == "not built") return {{"not", Json::object()}};
  return text;
}

/// Meaning, unit, range and defaults in sentences, as an editor shows them beside a key.
std::string description(const KeyInfo& key) {
  std::string text = key.help.empty() ? "" : sentence(key.help);
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : " ") + what + "."; };
  if (key.type == "table") return text;
  if (!key.unit.empty() && key.unit != "1") add("Unit: " + key.unit);
  if (!key.range.empty() && key.type != "flag") add("Range: " + key.range);
  if (!key.default_value.empty()) add("Default: " + key.default_value);
  if (!key.paper_value.empty()) add("With preset = \"paper\": " + key.paper_value);
  if (!key.instead.empty()) add("Write " + key.instead + " instead");
  return text;
}

bool is_within(const KeyLimits& limits, double x) {
  const bool low = limits.min && (limits.above ? x <= *limits.min : x < *limits.min);
  return !low && !(limits.max && x > *limits.max);
}

/// The default as JSON, else null. JSON has no value for inf; and a default of 0 that means "not given" may
/// not be written.
Json default_json(const KeyInfo& key) {
  if (key.default_value.empty()) return nullptr;
  if (key.type == "text" || key.type == "choice" || key.type == "file" || key.type == "folder")
    return key.default_value;
  const Json value = Json::parse(key.default_value, nullptr, false);
  if (value.is_discarded() || (value.is_number() && !is_within(key.limits, value.get<double>())))
    return nullptr;
  return value;
}

Json key_json(const KeyInfo& key) {
  Json json = type_json(key);
  if (const std::string words = description(key); !words.empty()) json["description"] = words;
  if (const Json value = default_json(key); !value.is_null()) json["default"] = value;
  if (!key.instead.empty()) json["deprecated"] = true;
  return json;
}

Json required_json(const std::string& name) {
  return {{"type", "object"}, {"required", {name}}};
}

/// The required keys of a table: `required`, and under `allOf` those that another key may stand in for.
Json requirements(const Branch& table) {
  Json json = Json::object();
  for (const auto& [name, branch] : table.below) {
    if (!branch->info || !branch->info->limits.required) continue;
    const std::vector<std::string>& others = branch->info->limits.unless;
    if (others.empty()) {
      json["required"].push_back(name);
      continue;
    }
    Json any = Json::array();
    for (const std::string& other : others) any.push_back(required_json(other));
    json["allOf"].push_back({{"if", {{"not", {{"anyOf", any}}}}}, {"then", required_json(name)}});
  }
  return json;
}

Json branch_json(const Branch& branch);

/// A table that takes its declared keys alone. Without any it takes all, as `when` of a compare block.
Json table_json(const Branch& table, bool with_requirements) {
  Json json = {{"type", "object"}};
  if (table.info && !table.list) json["description"] = description(*table.info);
  if (table.below.empty()) {
    json["additionalProperties"] = type_json({.type = "scalars"});
    return json;
  }
  for (const auto& [name, branch] : table.below) json["properties"][name] = branch_json(*branch);
  json["additionalProperties"] = false;
  if (with_requirements) json.update(requirements(table));
  return json;
}

Json branch_json(const Branch& branch) {
  if (!branch.is_table()) return key_json(*branch.info);
  const Json table = table_json(branch, true);
  if (!branch.list) return table;
  Json json = array_of(table, 0, 0);
  if (branch.info) json["description"] = description(*branch.info);
  return json;
}

/// [fluid] or [structure]. Its keys are ours unless another program reads the table: one of the user's, whose
/// path `solver` is, or the replay of a fluid, which skips the keys of the water. Keys are required where the
/// default solver computes. `anyOf` accepts everything; it leads editors that read no conditions to the keys.
Json side_json(const std::string& side, const Branch& table, Json& definitions) {
  const std::string name = side + "_keys";
  definitions[name] = table_json(table, false);
  const Json ours = {{"$ref", "#/definitions/" + name}};
  Json elsewhere = {{"pattern", "/"}};
  if (side == "fluid") elsewhere = {{"anyOf", {elsewhere, {{"const", "replay"}}}}};
  elsewhere["type"] = "string";
  Json json = {{"type", "object"}, {"anyOf", {ours, true}}};
  if (table.info) json["description"] = description(*table.info);
  json["if"] = {{"type", "object"}, {"properties", {{"solver", elsewhere}}}, {"required", {"solver"}}};
  json["then"] = true;
  json["else"] = ours;
  const Json needed = requirements(table);
  if (needed.empty()) return json;
  std::string solver;
  for (const auto& [key, branch] : table.below)
    if (key == "solver" && branch->info) solver = branch->info->default_value;
  json["allOf"] = {
      {{"if", {{"type", "object"}, {"properties", {{"solver", {{"const", solver}}}}}}}, {"then", needed}}};
  return json;
}

/// [[structures]]: each body has a name and the keys of [structure]. `own` is the schema of that table.
Json bodies_json(const Branch& list, const Branch& structure, const Json& own, Json& definitions) {
  Json keys = table_json(structure, false);
  for (const auto& [name, branch] : list.below) keys["properties"][name] = branch_json(*branch);
  definitions["structures_keys"] = keys;
  Json body = own;
  const Json ours = {{"$ref", "#/definitions/structures_keys"}};
  body["anyOf"] = {ours, true};
  body["else"] = ours;
  body.update(requirements(list));
  Json json = array_of(body, 1, 0);
  if (list.info) json["description"] = description(*list.info);
  return json;
}

/// [[attachments]]: one that a program of the user's computes may have a table of that program's.
Json attachments_json(const Branch& list, Json& definitions) {
  definitions["attachments_keys"] = table_json(list, true);
  const Json ours = {{"$ref", "#/definitions/attachments_keys"}};
  Json one = {{"type", "object"}, {"anyOf", {ours, true}}};
  one["if"] = {{"type", "object"},
               {"properties", {{"solver", {{"type", "string"}, {"pattern", "/"}}}}},
               {"required", {"solver"}}};
  one["then"] = requirements(list);
  one["else"] = ours;
  Json json = array_of(one, 0, 0);
  if (list.info) json["description"] = description(*list.info);
  return json;
}

/// `of` of a probe may also be the name of a body.
void accept_bodies(Json& properties) {
  Json& of = properties["output"]["properties"]["probe"]["items"]["properties"]["of"];
  const Json names = of["enum"];
  of.erase("enum");
  of["anyOf"] = {{{"enum", names}}, {{"pattern", "^[A-Za-z]"}, {"description", "the name of a body"}}};
}

}  // namespace

std::string case_schema(const std::vector<KeyInfo>& keys) {
  const Branch root = tree_of(keys);
  Json definitions = Json::object(), properties = Json::object();
  Json required = requirements(root).value("required", Json::array());
  for (const auto& [name, branch] : root.below) {
    const bool side = name == "fluid" || name == "structure";
    properties[name] = side                    ? side_json(name, *branch, definitions)
                       : name == "attachments" ? attachments_json(*branch, definitions)
                                               : branch_json(*branch);
    if (name == "structures")
      for (const auto& [other, structure] : root.below)
        if (other == "structure")
          properties[name] =
              bodies_json(*branch, *structure, side_json(other, *structure, definitions), definitions);
    // Without its table a side has its default solver, and what that requires is missing.
    if (side && properties[name].contains("allOf")) required.push_back(name);
  }
  if (properties.contains("output")) accept_bodies(properties);
  const Json schema = {
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "Case file of Strake"},
      {"description", "Made by `strake explain --schema` from the declarations of the keys."},
      {"type", "object"},
      {"properties", properties},
      {"required", required},
      {"additionalProperties", false},
      {"definitions", definitions}};
  return json_text(schema, 1) + "\n";
}

}  // namespace strake
