#include "coupler/import/import_parts.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

namespace strake {
namespace {

constexpr int deepest = 20;  // elements around one; preCICE's files have 4

template <class Number>
Number value_of(const XmlElement& element, const std::string& attribute, Number min, Number max,
                const char* what) {
  const std::string text = element.text(attribute);
  const auto value = number_from<Number>(text);
  if (!value || !(*value >= min && *value <= max))
    element.refuse(
        fmt::format("{} = \"{}\"", attribute, text),
        fmt::format("{} from {:g} to {:g}", what, static_cast<double>(min), static_cast<double>(max)));
  return *value;
}

}  // namespace

std::vector<const XmlTree*> XmlTree::all(std::string_view kind) const {
  std::vector<const XmlTree*> found;
  for (const XmlTree& one : inner)
    if (one.element.kind() == kind) found.push_back(&one);
  return found;
}

const XmlTree* XmlTree::first(std::string_view kind) const {
  for (const XmlTree& one : inner)
    if (one.element.kind() == kind) return &one;
  return nullptr;
}

XmlTree read_xml_tree(const std::filesystem::path& path) {
  XmlTree whole;
  read_xml(path, [&](const XmlElement& element) {
    if (element.depth > deepest) element.refuse(fmt::format("is inside {} elements", element.depth), "");
    XmlTree* around = &whole;  // the last element of each depth is the open one
    for (int depth = 0; depth < element.depth; ++depth) around = &around->inner.back();
    around->inner.push_back({element, {}});
  });
  return std::move(whole.inner.front());
}

void walk(const XmlTree& tree, const std::function<bool(const XmlTree&)>& visit) {
  for (const XmlTree& one : tree.inner)
    if (visit(one)) walk(one, visit);
}

double number_of(const XmlElement& element, const std::string& attribute, double min, double max) {
  return value_of<double>(element, attribute, min, max, "a number");
}

int integer_of(const XmlElement& element, const std::string& attribute, int min, int max) {
  return value_of<int>(element, attribute, min, max, "a whole number");
}

}  // namespace strake
