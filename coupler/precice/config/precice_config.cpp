#include "coupler/precice/config/precice_config.hpp"

#include "coupler/precice/config/xml_elements.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace strake {
namespace {

/// The texts of a configuration file that have a meaning for it.
class Reader {
 public:
  explicit Reader(PreciceConfig& config) : config_(config) {}

  void open(const XmlElement& element) {
    const std::string_view kind = element.kind();
    if (element.depth == 0) return root(element);
    if (kind == "data" && element.depth == 1) return data(element);  // else of an acceleration
    if (kind == "mesh") return mesh(element);
    if (kind == "use-data") return use_data(element);
    if (kind == "participant") return participant(element);
    if (kind == "coupling-scheme") return scheme(element);
    if (kind == "participants") return both(element);
    if (kind == "time-window-size") return window(element);
    if (kind == "exchange") return exchange(element);
    if (config_.participants.empty() || element.parent != "participant") return;
    PreciceConfig::Participant& owner = config_.participants.back();
    if (kind == "provide-mesh") owner.provided.push_back(known_mesh(element, "name"));
    if (kind == "receive-mesh") owner.received.push_back(known_mesh(element, "name"));
    if (kind == "write-data")
      owner.writes.push_back({known_mesh(element, "mesh"), known_data(element, "name")});
    if (kind == "read-data")
      owner.reads.push_back({known_mesh(element, "mesh"), known_data(element, "name")});
    if (kind == "mapping")
      owner.mappings.push_back({std::string(element.type()), element.text_or("from", ""),
                                element.text_or("to", ""), element.text_or("constraint", "consistent")});
  }

 private:
  void root(const XmlElement& element) {
    if (element.name == "precice-configuration") return;
    element.refuse("is not the beginning of a preCICE configuration",
                   "the outermost element is <precice-configuration>");
  }

  void data(const XmlElement& element) {
    const std::string degree = element.text_or("waveform-degree", "1");
    int value = -1;
    std::from_chars(degree.data(), degree.data() + degree.size(), value);
    if (value < 0) element.refuse(fmt::format("waveform-degree = \"{}\"", degree), "a whole number from 0");
    if (element.type() != "scalar" && element.type() != "vector")
      element.refuse("is no kind of data", "<data:scalar … /> or <data:vector … />");
    config_.data.push_back({element.text("name"), element.type() == "vector", value});
  }

  void mesh(const XmlElement& element) {
    const std::string dimension = element.text("dimensions");
    if (dimension != "2" && dimension != "3")
      element.refuse(fmt::format("dimensions = \"{}\"", dimension), "dimensions=\"2\" or \"3\"");
    config_.meshes.push_back({element.text("name"), dimension == "2" ? 2 : 3, {}});
  }

  void use_data(const XmlElement& element) {
    if (!config_.meshes.empty()) config_.meshes.back().data.push_back(known_data(element, "name"));
  }

  /// In a multi scheme the same word names one of its participants.
  void participant(const XmlElement& element) {
    if (element.parent.starts_with("coupling-scheme"))
      config_.schemes.back().participants.push_back(element.text("name"));
    else
      config_.participants.push_back({element.text("name"), {}, {}, {}, {}, {}});
  }

  void scheme(const XmlElement& element) {
    config_.schemes.push_back({{}, !element.type().ends_with("explicit"), {}});
  }

  void window(const XmlElement& element) {
    if (config_.schemes.empty()) return;
    const std::string text = element.text_or("value", "-1");
    double value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      element.refuse(fmt::format("value = \"{}\"", text), "a number of seconds above 0");
    config_.schemes.back().window = std::max(value, 0.0);  // -1: the first participant chooses it
  }

  void both(const XmlElement& element) {
    if (config_.schemes.empty()) return;
    for (const char* which : {"first", "second"}) {
      const std::string name = element.text(which);
      if (!config_.find_participant(name))
        element.refuse(fmt::format("{} = \"{}\" is no participant", which, name),
                       near(name, config_.participants));
      config_.schemes.back().participants.push_back(name);
    }
  }

  void exchange(const XmlElement& element) {
    if (config_.schemes.empty()) return;
    config_.schemes.back().exchanges.push_back({known_data(element, "data"), known_mesh(element, "mesh"),
                                                element.text("from"), element.text("to"),
                                                element.flag("initialize"), element.flag("substeps")});
  }

  std::string known_mesh(const XmlElement& element, const char* attribute) {
    std::string name = element.text(attribute);
    if (!config_.find_mesh(name))
      element.refuse(fmt::format("{} = \"{}\" is no mesh", attribute, name), near(name, config_.meshes));
    return name;
  }
  std::string known_data(const XmlElement& element, const char* attribute) {
    std::string name = element.text(attribute);
    if (!config_.find_data(name))
      element.refuse(fmt::format("{} = \"{}\" is no data", attribute, name), near(name, config_.data));
    return name;
  }

  template <class Entry>
  static std::string near(const std::string& word, const std::vector<Entry>& entries) {
    std::vector<std::string> names;
    for (const Entry& entry : entries) names.push_back(entry.name);
    const std::string nearest = did_you_mean(word, names);
    return nearest.empty() ? "define it before it is used" : fmt::format("did you mean \"{}\"?", nearest);
  }

  PreciceConfig& config_;
};

template <class Entry>
const Entry* find_named(const std::vector<Entry>& entries, const std::string& name) {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

PreciceConfig PreciceConfig::read(const std::filesystem::path& path) {
  PreciceConfig config;
  config.file = path;
  Reader reader(config);
  read_xml(path, [&](const XmlElement& element) { reader.open(element); });
  return config;
}

double PreciceConfig::window_of(const std::string& participant) const {
  for (const Scheme& scheme : schemes)
    if (std::ranges::find(scheme.participants, participant) != scheme.participants.end())
      return scheme.window;
  return 0;
}

const PreciceConfig::Data* PreciceConfig::find_data(const std::string& name) const {
  return find_named(data, name);
}
const PreciceConfig::Mesh* PreciceConfig::find_mesh(const std::string& name) const {
  return find_named(meshes, name);
}
const PreciceConfig::Participant* PreciceConfig::find_participant(const std::string& name) const {
  return find_named(participants, name);
}

bool PreciceConfig::conservative(const MeshData& sent) const {
  const auto is_read_on = [&](const std::string& mesh) {
    for (const Participant& participant : participants)
      for (const MeshData& read : participant.reads)
        if (read.mesh == mesh && read.data == sent.data) return true;
    return false;
  };
  const Mapping* first = nullptr;
  for (const Participant& participant : participants)
    for (const Mapping& mapping : participant.mappings) {
      if (mapping.from != sent.mesh) continue;
      if (is_read_on(mapping.to)) return mapping.constraint == "conservative";
      if (!first) first = &mapping;
    }
  return first && first->constraint == "conservative";
}

}  // namespace strake
