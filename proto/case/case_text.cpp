// Declarations of texts: words to choose from, paths, lists.
#include "proto/case/case_declare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unistd.h>

namespace strake {
namespace {

std::string list_of(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + to_toml(text);
  return list;
}

/// The text of a value, or nothing. A --set value is text if the key is a text, in any form.
std::optional<std::string> as_text(const Declaration& d) {
  if (const auto* text = d.node->as_string()) return text->get();
  if (const std::string raw = d.raw_text(); !raw.empty()) return raw;
  return {};
}

std::filesystem::path absolute_below(const std::filesystem::path& folder, const std::string& text) {
  return (folder / text).lexically_normal();
}

std::string plain(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  return to_toml(node);
}

/// A table in place of a list of "KEY=VALUE", written as one; empty for anything else.
std::string pairs_as_texts(const Declaration& d) {
  const toml::table* table = d.node->as_table();
  if (table == nullptr || table->empty()) return {};
  std::vector<std::string> pairs;
  for (const auto& [key, value] : *table) pairs.push_back(std::string(key.str()) + "=" + plain(value));
  return d.name() + " = [" + list_of(pairs) + "]";
}

enum class PathKind { file, folder };

void read_path(Declaration& d, const std::filesystem::path& folder, std::filesystem::path& value,
               const TextKey& key, PathKind kind) {
  const std::string noun = kind == PathKind::file ? "file" : "folder";
  d.expected = "the path of a " + noun;
  d.info.limits.required = key.required;
  d.info.default_value = key.required ? "" : value.string();
  d.default_passes = false;
  if (d.given(key.required, "\"<path>\"")) {
    const std::optional<std::string> text = as_text(d);
    if (!text || text->empty()) throw d.wrong(d.expected);
    const std::filesystem::path path = absolute_below(folder, *text);
    const std::string fix = "relative paths start at the case file's folder; looked for " + path.string();
    std::error_code ignored;
    const auto type = std::filesystem::status(path, ignored).type();
    const bool is_folder = type == std::filesystem::file_type::directory;
    if (is_folder != (kind == PathKind::folder) || !std::filesystem::exists(path, ignored))
      throw d.wrong(std::filesystem::exists(path, ignored)
                        ? fmt::format("a {}; this is a {}", noun, is_folder ? "folder" : "file")
                        : fmt::format("a {} that exists", noun),
                    fix);
    if (kind == PathKind::file && type != std::filesystem::file_type::regular)
      throw d.wrong("a file; this is a pipe, a device or a socket, which may never end", fix);
    if (access(path.c_str(), R_OK) != 0) throw d.wrong(fmt::format("a {} that may be read", noun), fix);
    value = path;
  }
  d.record(value.string(), !value.empty());
}

}  // namespace

void CaseTable::text(const std::string& name, std::string& value, const TextKey& key) {
  Declaration d(*document_, path_, name, {.type = "text", .help = key.help});
  d.expected = "text in quotes";
  d.info.limits.required = key.required;
  d.info.default_value = key.required ? "" : value;
  d.default_passes = false;
  if (key.paper) d.info.paper_value = *key.paper;
  d.take([&] {
    if (d.given(key.required, "\"<text>\"")) {
      const std::optional<std::string> given = as_text(d);
      if (!given) throw d.wrong(d.expected, d.name() + " = " + to_toml(to_toml(*d.node)));
      value = key.path && !given->empty() ? absolute_below(document_->folder(), *given).string() : *given;
    } else if (d.takes_paper(key.paper.has_value())) {
      value = *key.paper;
    }
  });
  d.record(value, d.node || !value.empty());
}

void CaseTable::file(const std::string& name, std::filesystem::path& value, const TextKey& key) {
  Declaration d(*document_, path_, name, {.type = "file", .help = key.help});
  read_path(d, document_->folder(), value, key, PathKind::file);
}

void CaseTable::folder(const std::string& name, std::filesystem::path& value, const TextKey& key) {
  Declaration d(*document_, path_, name, {.type = "folder", .help = key.help});
  read_path(d, document_->folder(), value, key, PathKind::folder);
}

void CaseTable::choice(const std::string& name, std::string& value, const std::vector<std::string>& choices,
                       const ChoiceKey& key) {
  Declaration d(*document_, path_, name, {.type = "choice", .help = key.help, .choices = choices});
  const auto is_choice = [&](const std::string& text) {
    return std::find(choices.begin(), choices.end(), text) != choices.end();
  };
  d.expected = (choices.size() == 1 ? "" : "one of ") + list_of(choices) +
               (key.or_path ? ", or the path of a program" : "");
  d.info.range = key.or_path ? "or the path of a program" : "";
  d.info.limits = {.path = key.or_path, .required = key.required};
  d.info.default_value = key.required ? "" : value;
  d.default_passes = false;
  if (key.paper) d.info.paper_value = *key.paper;
  d.take_or_end([&] {
    if (d.given(key.required, choices.empty() ? "\"<text>\"" : to_toml(choices.front()))) {
      const std::optional<std::string> given = as_text(d);
      if (!given) throw d.wrong(d.expected);
      if (key.or_path && given->find('/') != std::string::npos) {
        value = absolute_below(document_->folder(), *given).string();  // perhaps of another machine
      } else if (is_choice(*given)) {
        value = *given;
      } else if (std::find(key.not_built.begin(), key.not_built.end(), *given) != key.not_built.end()) {
        throw d.wrong(d.expected + "; " + to_toml(*given) + " is not built yet", "choose another");
      } else {
        const std::string near = did_you_mean(*given, choices);
        const bool program = key.or_path && given->find('.') != std::string::npos;
        throw d.wrong(d.expected, !near.empty()      ? "did you mean " + to_toml(near) + "?"
                                  : program          ? d.name() + " = " + to_toml("./" + *given)
                                  : is_choice(value) ? d.name() + " = " + to_toml(value) + " is the default"
                                                     : "");
      }
    } else if (d.takes_paper(key.paper.has_value())) {
      value = *key.paper;
    }
  });
  d.record(value, d.node || is_choice(value));
}

void CaseTable::texts(const std::string& name, std::vector<std::string>& value, const TextKey& key) {
  Declaration d(*document_, path_, name, {.type = "texts", .help = key.help});
  d.expected = "text in quotes, or a list of them";
  d.info.limits.required = key.required;
  d.info.instead = key.instead;
  d.info.default_value = key.required ? "" : "[" + list_of(value) + "]";
  d.default_passes = !key.required;
  if (d.given(key.required, "[\"<text>\"]")) {
    std::vector<std::string> given;
    if (const toml::array* array = d.node->as_array()) {
      for (const toml::node& element : *array) {
        if (!element.is_string()) throw d.wrong("text in quotes", {}, &element);
        given.push_back(element.as_string()->get());
      }
    } else if (const std::optional<std::string> text = as_text(d)) {
      given.push_back(*text);
    } else {
      throw d.wrong(d.expected, pairs_as_texts(d));
    }
    value = given;
  }
  d.record("[" + list_of(value) + "]");
}

std::vector<std::string> CaseTable::scalars_as_text(const std::string& name, const std::string& help) {
  Declaration d(*document_, path_, name, {.type = "scalars", .help = help});
  d.expected = "a text, a number or a list of them";
  d.default_passes = false;
  std::vector<std::string> values;
  if (d.node) {
    if (d.node->is_table())
      throw d.wrong(d.expected, "a key with a dot stands in quotes: \"" + d.name() + ".…\" = …");
    const toml::array* array = d.node->as_array();
    const std::size_t n = array ? array->size() : 1;
    for (std::size_t i = 0; i < n; ++i) {
      const toml::node& element = array ? *array->get(i) : *d.node;
      if (element.is_table() || element.is_array()) throw d.wrong("a text or a number", {}, &element);
      if (const auto* x = element.as_floating_point(); x && x->get() != x->get())
        throw d.wrong("a text or a number", {}, &element);
      values.push_back(plain(element));
    }
  }
  d.record(d.node ? to_toml(*d.node) : "[]", d.node != nullptr);
  return values;
}

void CaseTable::not_built(const std::string& name, const std::string& help) {
  Declaration d(*document_, path_, name, {.type = "not built", .help = help});
  if (d.node) {
    const toml::source_position& at = document_->find(d.info.path).key->source().begin;
    const std::string problem = d.info.path + " is not built yet: " + help;
    if (d.set) throw Error(ExitCode::case_file, "--set " + d.set->argument, problem, "leave it out");
    throw Error(ExitCode::case_file, document_->place(at), problem, "remove the key");
  }
  d.record("", false);
}

}  // namespace strake
