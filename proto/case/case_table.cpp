// Declarations of numbers, flags, vectors and boxes, and the tables they stand in. Texts: case_text.cpp.
#include "proto/case/case_declare.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace strake {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// In one list: each is compared with all the others.
constexpr std::size_t most_tables = 2000, most_points = 2000;

std::string range_text(double min, double max, bool exclusive) {
  const bool below = std::isfinite(min), above = std::isfinite(max);
  if (below && above)
    return exclusive ? fmt::format("greater than {}, at most {}", to_toml(min), to_toml(max))
                     : fmt::format("{} to {}", to_toml(min), to_toml(max));
  if (below) return (exclusive ? "greater than " : "at least ") + to_toml(min);
  return above ? "at most " + to_toml(max) : "";
}

/// Magnitudes of a quantity that any ship, model or laboratory has; what lies beyond is a slip of the pen.
struct Magnitude {
  double smallest, largest;  // the former of a quantity that must not be zero
};

/// Gives the limits of a quantity by its unit; they are wide for a unit that is not known. They keep squares,
/// products and quotients of such numbers within the range of a double. They lie many orders of magnitude
/// beyond what has been built or measured, so that they exclude no real case.
Magnitude magnitude_of(const std::string& unit) {
  static const std::map<std::string, Magnitude> known = {
      {"m", {1e-9, 1e6}},        {"s", {1e-15, 1e9}},        {"kg", {1e-12, 1e15}},  {"kg/m^3", {1e-6, 1e6}},
      {"kg m^2", {1e-18, 1e24}}, {"m/s", {1e-9, 1e5}},       {"m/s^2", {1e-9, 1e6}}, {"m^2/s", {1e-15, 1e6}},
      {"Pa", {1e-3, 1e15}},      {"Pa | N/m", {1e-3, 1e15}}, {"N", {1e-12, 1e15}},   {"J/m^2", {1e-12, 1e15}},
      {"Hz", {1e-9, 1e9}},       {"1/s", {1e-9, 1e12}},      {"rad/s", {1e-9, 1e6}}, {"deg", {1e-9, 1e6}},
      {"SI", {1e-30, 1e30}},     {"1", {1e-16, 1e30}}};
  const auto found = known.find(unit);
  return found == known.end() ? Magnitude{1e-16, 1e15} : found->second;
}

/// Bounds that a key declares, within its unit's magnitudes; a number greater than 0 begins at the smallest.
NumberKey within_magnitude(NumberKey key) {
  const Magnitude magnitude = magnitude_of(key.unit);
  if (key.exclusive && key.min == 0 && magnitude.smallest < key.max) {
    key.min = magnitude.smallest;
    key.exclusive = false;
  }
  key.min = std::max(key.min, -magnitude.largest);
  key.max = std::min(key.max, magnitude.largest);
  return key;
}

std::string in_unit(const std::string& unit) {
  return unit.empty() || unit == "1" ? "" : " in " + unit;
}

/// "210 GPa" → 210e9 where the unit is Pa, "0,5" → 0.5; empty if the text is no number with that unit.
std::string without_unit(const std::string& text, const std::string& unit) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return {};
  const std::string number(text.data(), end);
  std::string rest(end, text.data() + text.size());
  if (rest.size() > 1 && rest[0] == ',' && rest.find_first_not_of("0123456789", 1) == std::string::npos)
    return number + "." + rest.substr(1);
  rest.erase(0, rest.find_first_not_of(' '));
  if (rest.empty() || rest == unit) return number;
  static const std::pair<const char*, int> prefixes[] = {{"G", 9},  {"M", 6},  {"k", 3},  {"c", -2},
                                                         {"m", -3}, {"u", -6}, {"µ", -6}, {"n", -9}};
  for (const auto& [prefix, exponent] : prefixes)
    if (rest == prefix + unit && number.find_first_of("eE") == std::string::npos)
      return fmt::format("{}e{}", number, exponent);
  return {};
}

/// The number of a node, if it is one; also of a --set value that TOML does not take for a number (.5).
std::optional<double> as_number(const toml::node& node, const CaseFile::Document::Set* set) {
  if (const auto* v = node.as_floating_point()) return v->get();
  if (const auto* v = node.as_integer()) return static_cast<double>(v->get());
  return set && node.is_string() ? number_from<double>(set->value) : std::nullopt;
}

bool in_range(double value, const NumberKey& key, bool infinite) {
  if (std::isnan(value)) return false;
  if (std::isinf(value)) return infinite && value > 0;
  return (key.exclusive ? value > key.min : value >= key.min) && value <= key.max;
}

std::string to_text(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", to_toml(v.x()), to_toml(v.y()), to_toml(v.z()));
}

/// Reads [x, y] or [x, y, z]; throws through the declaration, with the caret under the element that is wrong.
Eigen::Vector3d read_vector(const Declaration& d, const toml::node& node) {
  const std::string example = d.name() + " = [0.0, 1.0, 0.0]";
  const toml::array* array = node.as_array();
  if (!array || (array->size() != 2 && array->size() != 3)) throw d.wrong(d.expected, {}, &node);
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::optional<double> x = as_number(*array->get(i), nullptr);
    if (!x || !std::isfinite(*x)) throw d.wrong("a finite number" + in_unit(d.info.unit), {}, array->get(i));
    if (const double most = magnitude_of(d.info.unit).largest; std::abs(*x) > most)
      throw d.wrong(fmt::format("a number{}, {} to {}", in_unit(d.info.unit), to_toml(-most), to_toml(most)),
                    {}, array->get(i));
    value[static_cast<Eigen::Index>(i)] = *x;
  }
  return value;
}

/// Limits of each component of a vector, a box or a point.
KeyLimits limits_of(const VectorKey& key) {
  const double most = magnitude_of(key.unit).largest;
  return {.min = -most, .max = most, .required = key.required && !key.conditional, .unless = key.unless};
}

bool is_box(const Box& box) {
  return box.min.x() < box.max.x() && box.min.y() < box.max.y() && box.min.z() <= box.max.z();
}

}  // namespace

Declaration::Declaration(CaseFile::Document& document, const std::string& table, const std::string& name,
                         KeyInfo description)
    : info(std::move(description)), document_(document) {
  info.path = document.join(table, name);
  info.origin = "default";
  node = document.at(info.path);
  if (!node) return;
  set = document.set_of(info.path);
  info.origin = set ? "--set" : "case";
}

std::string Declaration::name() const {
  return quoted_key(parent_and_name(info.path).second);
}

std::string Declaration::raw_text() const {
  return set && set->path == info.path && !node->is_string() ? set->value : std::string();
}

Error Declaration::wrong(const std::string& what, const std::string& fix, const toml::node* part) const {
  std::string advice = fix;
  if (advice.empty() && !info.default_value.empty() && default_passes)
    advice = name() + " = " + info.default_value + " is the default";
  if (advice.empty() && what == expected && !info.limits.unless.empty())
    advice = "another shape has a key of its own: " + joined(info.limits.unless);
  if (advice.empty() && document_.explained) advice = "strake explain " + info.path;
  return document_.wrong(info.path, "expected " + what, advice, part);
}

bool Declaration::given(bool required, const std::string& sample) const {
  if (!node && required && !document_.only_declares)
    throw document_.missing(info.path, "expected " + expected, sample);
  return node != nullptr;
}

bool Declaration::takes_paper(bool has_paper) {
  if (node || !has_paper || document_.preset != "paper") return false;
  info.origin = "preset";
  return true;
}

void Declaration::record(std::string value, bool echoed) {
  if (document_.index.contains(info.path)) return;
  info.value = std::move(value);
  document_.index.emplace(info.path, document_.keys.size());
  document_.keys.push_back(std::move(info));
  document_.echoed.push_back(echoed);
}

CaseTable::CaseTable(std::shared_ptr<CaseFile::Document> document, std::string path)
    : document_(std::move(document)), path_(std::move(path)) {}

void CaseTable::number(const std::string& name, double& value, const NumberKey& key) {
  Declaration d(*document_, path_, name, {.type = "number", .unit = key.unit, .help = key.help});
  const bool infinite =
      key.max == infinity && (key.infinite || std::isinf(value) || (key.paper && std::isinf(*key.paper)));
  const NumberKey wide = within_magnitude(key);
  const std::string or_inf = infinite ? ", or inf" : "";
  const std::string declared = range_text(key.min, key.max, key.exclusive);
  const bool complete = std::isfinite(key.min) && std::isfinite(key.max);
  d.info.range = complete ? declared : range_text(wide.min, wide.max, wide.exclusive) + or_inf;
  d.info.limits = {.min = wide.min,
                   .max = wide.max,
                   .above = wide.exclusive,
                   .infinite = infinite,
                   .required = key.required && !key.conditional};
  d.info.default_value = key.required ? "" : to_toml(value);
  d.default_passes = !key.required && in_range(value, key, infinite);
  if (key.paper) d.info.paper_value = to_toml(*key.paper);
  d.expected = "a number" + in_unit(key.unit) + (declared.empty() ? "" : ", " + declared) + or_inf;
  d.take([&] {
    if (d.given(key.required, "<number>")) {
      const std::optional<double> given = as_number(*d.node, d.set);
      std::string fix;
      if (!given)
        if (const auto* text = d.node->as_string())
          if (const std::string number = without_unit(text->get(), key.unit); !number.empty())
            fix = d.name() + " = " + number;
      if (!given || !in_range(*given, key, infinite)) throw d.wrong(d.expected, fix);
      if (!in_range(*given, wide, infinite))
        throw d.wrong("a number" + in_unit(key.unit) + ", " + range_text(wide.min, wide.max, wide.exclusive) +
                      or_inf);
      value = *given;
    } else if (d.takes_paper(key.paper.has_value())) {
      value = *key.paper;
    }
  });
  if (d.refused() && !in_range(value, wide, infinite)) value = std::clamp(1.0, wide.min, wide.max);
  d.record(to_toml(value), in_range(value, key, infinite));
}

void CaseTable::integer(const std::string& name, int& value, const IntegerKey& key) {
  Declaration d(*document_, path_, name, {.type = "integer", .unit = "1", .help = key.help});
  using Limits = std::numeric_limits<int>;
  d.info.range = range_text(key.min == Limits::min() ? -infinity : key.min,
                            key.max == Limits::max() ? infinity : key.max, false);
  d.info.limits.required = key.required;
  if (key.min != Limits::min()) d.info.limits.min = key.min;
  if (key.max != Limits::max()) d.info.limits.max = key.max;
  d.info.default_value = key.required ? "" : fmt::format("{}", value);
  d.default_passes = !key.required && value >= key.min && value <= key.max;
  if (key.paper) d.info.paper_value = fmt::format("{}", *key.paper);
  d.expected = "a whole number" + (d.info.range.empty() ? "" : ", " + d.info.range);
  d.take([&] {
    if (d.given(key.required, "<whole number>")) {
      const std::optional<double> given = as_number(*d.node, d.set);  // 1e3 is whole, too
      if (!given || *given != std::floor(*given) || *given < key.min || *given > key.max)
        throw d.wrong(d.expected);
      value = static_cast<int>(*given);
    } else if (d.takes_paper(key.paper.has_value())) {
      value = *key.paper;
    }
  });
  if (d.refused()) value = std::clamp(value, key.min, key.max);
  d.record(fmt::format("{}", value), value >= key.min && value <= key.max);
}

void CaseTable::flag(const std::string& name, bool& value, const FlagKey& key) {
  Declaration d(*document_, path_, name, {.type = "flag", .range = "true or false", .help = key.help});
  d.info.default_value = value ? "true" : "false";
  if (key.paper) d.info.paper_value = *key.paper ? "true" : "false";
  d.expected = "true or false";
  d.take([&] {
    if (d.node) {
      const auto* given = d.node->as_boolean();
      if (!given) throw d.wrong(d.expected);
      value = given->get();
    } else if (d.takes_paper(key.paper.has_value())) {
      value = *key.paper;
    }
  });
  d.record(value ? "true" : "false");
}

void CaseTable::vector(const std::string& name, Eigen::Vector3d& value, const VectorKey& key) {
  Declaration d(*document_, path_, name, {.type = "vector", .unit = key.unit, .help = key.help});
  d.info.limits = limits_of(key);
  d.info.default_value = key.required ? "" : to_text(value);
  d.default_passes = !key.required;
  d.expected = "[x, y] or [x, y, z]" + in_unit(key.unit);
  d.take([&] {
    if (d.given(key.required, "[x, y]")) value = read_vector(d, *d.node);
  });
  d.record(to_text(value), d.node || !key.required);
}

void CaseTable::box(const std::string& name, Box& value, const VectorKey& key) {
  Declaration d(*document_, path_, name, {.type = "box", .unit = key.unit, .help = key.help});
  const auto text = [](const Box& box) { return "[" + to_text(box.min) + ", " + to_text(box.max) + "]"; };
  d.info.limits = limits_of(key);
  d.default_passes = !key.required && is_box(value);
  d.info.default_value = d.default_passes ? text(value) : "";
  d.expected = "two corners [[x, y], [x, y]]" + in_unit(key.unit) + ", the lower one first";
  d.take([&] {
    if (d.given(key.required, "[[x, y], [x, y]]")) {
      const toml::array* corners = d.node->as_array();
      if (!corners || corners->size() != 2) throw d.wrong(d.expected);
      const Box given{read_vector(d, *corners->get(0)), read_vector(d, *corners->get(1))};
      if (!is_box(given)) {
        const Box ordered{given.min.cwiseMin(given.max), given.min.cwiseMax(given.max)};
        throw d.wrong(d.expected, is_box(ordered) ? d.name() + " = " + text(ordered) : "");
      }
      value = given;
    }
  });
  if (d.refused() && !is_box(value)) value = Box{{0, 0, 0}, {1, 1, 1}};  // only to read on
  d.record(text(value), is_box(value));
}

void CaseTable::points(const std::string& name, std::vector<Eigen::Vector3d>& value, const PointsKey& key) {
  Declaration d(*document_, path_, name, {.type = "points", .unit = key.unit, .help = key.help});
  const auto text = [](const std::vector<Eigen::Vector3d>& points) {
    std::string list;
    for (const Eigen::Vector3d& point : points) list += (list.empty() ? "" : ", ") + to_text(point);
    return "[" + list + "]";
  };
  d.info.limits = limits_of({.unit = key.unit, .required = key.required});
  d.info.limits.fewest = key.at_least;
  d.info.limits.most = most_points;
  d.info.default_value = value.empty() ? "" : text(value);
  d.default_passes = !value.empty();
  d.expected = fmt::format("a list of at least {} points [[x, y], ...]", key.at_least) + in_unit(key.unit);
  if (d.given(key.required, "[[x, y], [x, y], [x, y]]")) {
    const toml::array* array = d.node->as_array();
    if (!array || array->size() < key.at_least) throw d.wrong(d.expected);
    if (array->size() > most_points)
      throw d.wrong(fmt::format("at most {} points, this list has {}", most_points, array->size()),
                    "leave out points on straight runs");
    value.clear();
    for (const toml::node& point : *array) value.push_back(read_vector(d, point));
  }
  d.record(text(value), !value.empty());
}

CaseTable CaseTable::table(const std::string& name, const std::string& help) {
  Declaration d(*document_, path_, name, {.type = "table", .help = help});
  d.expected = "a table";
  const std::string path = d.info.path;
  document_->tables.insert(path);
  if (d.node && !d.node->is_table())
    throw d.wrong(d.expected, document_->set_of(path) ? document_->set_of_key(path, path)
                              : d.node->is_array_of_tables()
                                  ? "one table, [" + path + "], not a list"
                                  : "[" + path + "] on a line of its own, its keys below it");
  if (!help.empty()) d.record("", false);
  return {document_, path};
}

std::vector<CaseTable> CaseTable::tables(const std::string& name, const std::string& help) {
  Declaration d(*document_, path_, name, {.type = "table", .help = help});
  const std::string path = d.info.path;
  document_->tables.insert(path);
  std::vector<CaseTable> elements;
  if (document_->only_declares) elements.push_back({document_, path + "[]"});
  if (d.node) {
    const toml::array* array = d.node->as_array();
    const std::string fix = document_->set_of(path) ? document_->set_of_key(path, path + "[0]")
                                                    : "[[" + path + "]] on a line of its own, one for each";
    if (!array) throw d.wrong("a list of tables", fix);
    if (array->size() > most_tables)
      throw d.wrong(fmt::format("at most {} tables, this list has {}", most_tables, array->size()),
                    "divide the case");
    for (std::size_t i = 0; i < array->size(); ++i) {
      if (!array->get(i)->is_table()) throw d.wrong("a table", fix, array->get(i));
      elements.push_back({document_, fmt::format("{}[{}]", path, i)});
    }
  }
  for (const CaseTable& element : elements) document_->tables.insert(element.path_);
  if (!help.empty()) d.record("", false);
  return elements;
}

void CaseTable::knows(const std::vector<std::string>& names) {
  for (const std::string& name : names) document_->tables.insert(path_ + "." + name);
}

void CaseTable::accept_all() {
  document_->accepted.insert(path_);
}

std::vector<std::string> CaseTable::keys() const {
  const toml::node* node = document_->at(path_);
  if (!node || !node->is_table()) return {};
  std::vector<const toml::key*> order;
  for (auto&& [key, value] : *node->as_table()) order.push_back(&key);
  std::stable_sort(order.begin(), order.end(), [](const toml::key* a, const toml::key* b) {
    return a->source().begin < b->source().begin;
  });
  std::vector<std::string> names;
  for (const toml::key* key : order) names.emplace_back(key->str());
  return names;
}

bool CaseTable::has(const std::string& name) const {
  return document_->at(document_->join(path_, name));
}

bool CaseTable::present() const {
  return document_->only_declares || document_->at(path_);
}

std::string CaseTable::where(const std::string& name) const {
  return document_->where(document_->join(path_, name));
}

Error CaseTable::error(const std::string& name, const std::string& expected, const std::string& fix) const {
  const std::string text = expected.starts_with("expected ") ? expected : "expected " + expected;
  const std::string path = document_->join(path_, name);
  return document_->wrong(path, text, fix.empty() && document_->explained ? "strake explain " + path : fix);
}

}  // namespace strake
