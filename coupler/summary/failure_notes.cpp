#include "coupler/summary/failure_notes.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <utility>

namespace strake {

namespace {

using Words = std::pair<const char*, const char*>;
constexpr std::array<Words, 3> events = {Words{"start", "failure begins: the strength is reached"},
                                         Words{"crack", "the first crack opens"},
                                         Words{"parted", "a crack has parted the body"}};
constexpr std::array<const char*, 4> parts = {"time", "x", "y", "z"};

/// What stands before a body's columns.
std::string before(const std::string& body) {
  return body.empty() ? "" : body + ".";
}

Json json_of(const std::map<std::string, double>& monitor, const std::string& body) {
  const auto energy = monitor.find(before(body) + "failure.energy");
  if (energy == monitor.end()) return nullptr;
  Json json;
  for (const auto& [event, words] : events) {
    const std::string name = fmt::format("{}failure.{}.", before(body), event);
    json[event] = nullptr;
    if (!monitor.contains(name + "time")) continue;
    Json place;
    for (const char* part : parts) place[part] = monitor.at(name + part);
    json[event] = place;
  }
  json["energy"] = energy->second;
  return json;
}

}  // namespace

std::vector<std::string> FailureNotes::look(const std::map<std::string, double>& monitor) {
  std::vector<std::string> lines;
  if (bodies_.empty()) look_at("", monitor, lines);
  for (const std::string& body : bodies_) look_at(body, monitor, lines);
  return lines;
}

void FailureNotes::look_at(const std::string& body, const std::map<std::string, double>& monitor,
                           std::vector<std::string>& lines) {
  for (const auto& [event, words] : events) {
    const std::string name = fmt::format("{}failure.{}.", before(body), event);
    const auto time = monitor.find(name + "time");
    if (time == monitor.end() || std::exchange(told_[name], true) || time->second <= since_) continue;
    lines.push_back((body.empty() ? "" : body + ": ") +
                    fmt::format("{}, t = {:.6g} s at ({:.4g}, {:.4g}, {:.4g}) m of the body as it was", words,
                                time->second, monitor.at(name + "x"), monitor.at(name + "y"),
                                monitor.at(name + "z")));
    if (std::string(event) == "parted" && dry_faces_)
      lines.push_back(
          "the faces of the crack stay dry: the wet surface is that of the whole body; "
          "coupling.interface = \"volume\" wets them (structure.solver = \"particle\")");
  }
}

Json failure_json(const std::map<std::string, double>& monitor, const std::vector<std::string>& bodies) {
  if (bodies.empty()) return json_of(monitor, "");
  Json json;
  for (const std::string& body : bodies) json[body] = json_of(monitor, body);
  return json;
}

}  // namespace strake
