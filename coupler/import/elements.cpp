#include "coupler/import/import_parts.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace strake {
namespace {

/// Elements of preCICE 3 that say something about the run, and are translated.
const std::vector<std::string> known_elements{"data",
                                              "mesh",
                                              "use-data",
                                              "participant",
                                              "provide-mesh",
                                              "receive-mesh",
                                              "write-data",
                                              "read-data",
                                              "mapping",
                                              "basis-function",
                                              "coupling-scheme",
                                              "participants",
                                              "exchange",
                                              "max-time",
                                              "max-time-windows",
                                              "time-window-size",
                                              "min-iterations",
                                              "max-iterations",
                                              "absolute-convergence-measure",
                                              "relative-convergence-measure",
                                              "residual-relative-convergence-measure",
                                              "absolute-or-relative-convergence-measure",
                                              "acceleration",
                                              "relaxation",
                                              "initial-relaxation",
                                              "max-used-iterations",
                                              "time-windows-reused",
                                              "filter",
                                              "preconditioner"};

struct Words {
  std::string_view kind;
  std::string words, fix;
};

/// Elements that do not change the result, and what Strake has in their place.
const std::array<Words, 8> left_out{{
    {"log", "each solver has a log file in the run folder", ""},
    {"profiling", "strake run --profile says where the time went", ""},
    {"m2n", "Strake connects the solvers itself", ""},
    {"intra-comm", "a participant is one process", ""},
    {"export", "interface/ in the run folder has the data of every point", ""},
    {"watch-point", "interface/ in the run folder has the data of every point", ""},
    {"executor", "the mapping runs on the threads of run.threads", ""},
    {"imvj-restart-mode", "iqn-imvj has one way to stay small", ""},
}};

/// Elements without which the run would be another one.
const std::array<Words, 5> refused_elements{{
    {"action", "changes data between the solvers, which Strake does not", "do it in one of the solvers"},
    {"watch-integral", "is an integral over the interface, which Strake does not write",
     "leave it out: interface/ in the run folder has the data of every point"},
    {"solver-interface", "is of preCICE 2", "bring the configuration to preCICE 3 first"},
    {"use-mesh", "is of preCICE 2", "bring the configuration to preCICE 3 first"},
    {"extrapolation-order", "is of preCICE 2", "leave it out, or set coupling.surface.predictor in the case"},
}};

/// Flags that ask for what Strake does not have.
struct Flag {
  std::string_view kind;
  const char *attribute, *words, *fix;
};
const std::array<Flag, 9> flags{{
    {"precice-configuration", "allow-remeshing", "meshes that change during a run are not in Strake", ""},
    {"receive-mesh", "api-access", "direct access to the partner's mesh is not in Strake",
     "a mapping to a mesh of the participant's own"},
    {"receive-mesh", "direct-access", "direct access to the partner's mesh is not in Strake",
     "a mapping to a mesh of the participant's own"},
    {"data:scalar", "gradient", "gradients of data are not in Strake", "a mapping that needs no gradients"},
    {"data:vector", "gradient", "gradients of data are not in Strake", "a mapping that needs no gradients"},
    {"mapping", "x-dead", "a direction that the mapping leaves out is not in Strake", ""},
    {"mapping", "y-dead", "a direction that the mapping leaves out is not in Strake", ""},
    {"mapping", "z-dead", "a direction that the mapping leaves out is not in Strake", ""},
    {"", "suffices", "one measure that is enough for all data is not in Strake",
     "leave suffices out: all data have to settle"},
}};

const Words* words_for(const auto& list, std::string_view kind) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const Words& w) { return w.kind == kind; });
  return found == list.end() ? nullptr : &*found;
}

void check_flags(const XmlElement& element) {
  for (const Flag& flag : flags)
    if (flag.kind.empty() || flag.kind == element.kind() || flag.kind == element.name)
      if (element.attributes.count(flag.attribute) && element.flag(flag.attribute))
        element.refuse(
            fmt::format("{} = \"{}\": {}", flag.attribute, element.text(flag.attribute), flag.words),
            flag.fix);
}

/// Throws for an element, or for an attribute of it, that Strake does not have.
void check_element(const XmlElement& element) {
  const std::string kind(element.kind());
  if (const Words* words = words_for(refused_elements, kind)) element.refuse(words->words, words->fix);
  if (std::find(known_elements.begin(), known_elements.end(), kind) == known_elements.end()) {
    const std::string nearest = did_you_mean(kind, known_elements);
    element.refuse("is no element that strake import knows",
                   nearest.empty() ? "leave it out" : fmt::format("did you mean <{}>?", nearest));
  }
  check_flags(element);
}

}  // namespace

std::vector<std::string> check_elements(const XmlTree& configuration) {
  std::vector<std::string> notes;
  std::vector<Error> errors;
  std::set<std::string_view> said;
  const auto collect = [&](const XmlElement& element, auto&& look) {
    try {
      look(element);
    } catch (const Error& error) {
      errors.push_back(error);
    }
  };
  collect(configuration.element, check_flags);
  walk(configuration, [&](const XmlTree& tree) {
    const Words* words = words_for(left_out, tree.element.kind());
    if (!words) {
      collect(tree.element, check_element);
      return words_for(refused_elements, tree.element.kind()) == nullptr;  // what is inside goes with it
    }
    if (said.insert(words->kind).second)
      notes.push_back(
          fmt::format("line {}: <{}> is left out: {}", tree.element.line, tree.element.name, words->words));
    return false;
  });
  if (!errors.empty()) throw all_of(errors);
  return notes;
}

}  // namespace strake
