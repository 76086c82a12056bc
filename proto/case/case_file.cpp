#include "proto/case/case_file.hpp"

#include "proto/case/case_depth.hpp"
#include "proto/case/case_document.hpp"
#include "proto/files/file_kind.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace strake {
namespace {

struct SyntaxHelp {
  std::string problem, remark, fix;  // remark: beside the caret
};

/// The parser's words without its preamble, and a fix for the slips that people make.
SyntaxHelp syntax_help(const std::string& description, const std::string& line) {
  std::string remark = description;
  if (const std::size_t colon = remark.find(": ");
      remark.starts_with("Error while parsing") && colon != std::string::npos)
    remark = remark.substr(colon + 2);
  if (remark.starts_with("cannot redefine")) return {"given twice", remark, "keep one of the two"};
  SyntaxHelp help{"not TOML", remark, "a line is [table], key = value, or a # comment"};
  if (remark.find("invalid utf-8") != std::string::npos) {
    help.fix = "save the file as UTF-8; umlauts and accents of other encodings are no TOML";
    return help;
  }
  if (remark.find("closing ']'") != std::string::npos) {
    help.fix = "close the list with ]";
    return help;
  }
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos) return help;
  const std::string key(trimmed(line.substr(0, equals)));
  const std::string value(trimmed(line.substr(equals + 1, line.find('#', equals) - equals - 1)));
  if (key.empty()) return help;
  const bool is_word = !value.empty() && value.find_first_of("\"'[]{}=") == std::string::npos;
  const bool is_number = is_word && value.find_first_of("0123456789") < 2;
  if (value.empty())
    help.fix = "give " + key + " a value, or remove the line";
  else if (std::count(value.begin(), value.end(), '"') == 1)
    help.fix = "end the text with a quote";
  else if (is_number && value.find_first_of(" /") == std::string::npos &&
           value.find(',') != std::string::npos)
    help.fix = "a number has a decimal point, not a comma";
  else if (is_number && value.starts_with('.'))
    help.fix = "a number starts with a digit: 0" + value;
  else if (is_number)
    help.fix = "numbers are in SI units and stand without a unit: 0.01, 2.1e11";
  else if (is_word)
    help.fix = "text stands in quotes: " + key + " = \"" + value + "\"";
  return help;
}

bool is_toml_text(const std::string& text) {
  try {
    return toml::parse("value = " + to_toml(text)).contains("value");
  } catch (const toml::parse_error&) {
    return false;
  }
}

/// Refuses a file that is none of TOML's. Called where the parser has failed.
void refuse_other_kind(const std::string& name, const std::string& bytes) {
  if (const auto kind = foreign_kind(name, bytes))
    throw Error(ExitCode::case_file, name, kind->name + ", not a case file (TOML)", kind->fix);
}

/// The table for the last step of a --set path; missing tables of the path are made.
toml::table* table_for(toml::table& root, const std::vector<PathStep>& steps, const std::string& where) {
  toml::node* node = &root;
  std::string so_far;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    const PathStep& step = steps[i];
    if (step.is_index) {
      toml::array* array = node->as_array();
      const auto n = static_cast<long>(array ? array->size() : 0);
      if (!array || step.index < 0 || step.index > n)
        throw Error(ExitCode::case_file, where, fmt::format("{} has {} elements, counted from 0", so_far, n),
                    fmt::format("index {} appends one", n));
      if (step.index == n) array->push_back(toml::table{});
      node = array->get(static_cast<std::size_t>(step.index));
      so_far += fmt::format("[{}]", step.index);
    } else {
      toml::table* table = node->as_table();
      if (!table) break;
      so_far += (so_far.empty() ? "" : ".") + quoted_key(step.key);
      if (!table->contains(step.key)) {
        if (steps[i + 1].is_index)
          table->insert(step.key, toml::array{});
        else
          table->insert(step.key, toml::table{});
      }
      node = table->get(step.key);
    }
  }
  if (!node->is_table())
    throw Error(ExitCode::case_file, where, so_far + " is a value, not a table",
                "name the key as it stands in the file");
  return node->as_table();
}

}  // namespace

void CaseFile::Document::read_text() {
  std::istringstream in(bytes);
  for (std::string line; std::getline(in, line);) {
    if (lines.empty() && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
    while (line.ends_with('\r')) line.pop_back();
    lines.push_back(line);
  }
  try {
    require_shallow(bytes, name);
    root = toml::parse(bytes);
  } catch (const Error&) {
    refuse_other_kind(name, bytes);
    throw;
  } catch (const toml::parse_error& error) {
    refuse_other_kind(name, bytes);
    const toml::source_position& at = error.source().begin;
    const std::string line = at.line >= 1 && at.line <= lines.size() ? lines[at.line - 1] : "";
    const SyntaxHelp help = syntax_help(std::string(error.description()), line);
    throw Error(ExitCode::case_file, place(at), help.problem + "\n" + excerpt(at, help.remark), help.fix);
  }
}

void CaseFile::Document::apply(const std::string& argument) {
  const std::string where = "--set " + argument;
  if (!is_toml_text(argument))  // the resolved case could not be read again
    throw Error(ExitCode::command_line, "--set", "holds bytes that are no UTF-8 text", "type it again");
  std::size_t equals = std::string::npos;
  char quote = 0;  // an equals sign inside a quoted key does not end the key
  for (std::size_t i = 0; i < argument.size() && equals == std::string::npos; ++i) {
    const char c = argument[i];
    if (quote != 0)
      quote = c == quote ? '\0' : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '=')
      equals = i;
  }
  const std::string path(trimmed(argument.substr(0, equals)));
  std::vector<PathStep> steps = split_path(path);
  if (equals == std::string::npos || steps.empty() || steps.back().is_index)
    throw Error(ExitCode::command_line, where, "expected KEY=VALUE",
                "for instance --set fluid.spacing=0.005");
  if (steps.size() > deepest_key)
    throw Error(ExitCode::case_file, "--set " + steps.front().key + "...",
                fmt::format("the key has {} parts, expected at most {}", steps.size(), deepest_key),
                "strake explain lists the keys; none has more than five");
  const std::string value(trimmed(argument.substr(equals + 1)));
  if (value.starts_with('[') || value.starts_with('{')) require_shallow("value = " + value, "--set " + path);

  find_named(steps, where);
  toml::table* table = table_for(root, steps, where);
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    parsed.clear();  // no TOML: text, so that --set structure.solver=fem needs no quotes within quotes
  }
  if (parsed.size() == 1 && parsed.contains("value"))
    parsed.get("value")->visit(
        [&](auto&& node) { table->insert_or_assign(steps.back().key, std::move(node)); });
  else
    table->insert_or_assign(steps.back().key, value);

  Set set{argument, "", value};
  for (const PathStep& step : steps)
    set.path += step.is_index ? fmt::format("[{}]", step.index)
                              : (set.path.empty() ? "" : ".") + quoted_key(step.key);
  sets.push_back(set);
}

void CaseFile::Document::read_preset() {
  const toml::node* node = at("preset");
  if (!node) return;
  const auto* text = node->as_string();
  if (!text || (text->get() != "paper" && text->get() != "improved"))
    throw wrong("preset", "expected \"paper\" or \"improved\"", "preset = \"improved\" is the default");
  preset = text->get();
}

CaseFile::CaseFile(std::shared_ptr<Document> document) : document_(std::move(document)) {}

CaseFile CaseFile::load(const std::filesystem::path& file, const std::vector<std::string>& sets) {
  CaseFile read = parse(read_whole(file, largest_case, file.string()), file.string(), sets);
  if (read.document_->root.empty())
    throw Error(ExitCode::case_file, file.string(), "is empty: it gives no key",
                "strake new writes a case to begin with, strake explain lists the keys");
  return read;
}

CaseFile CaseFile::parse(const std::string& text, const std::string& name,
                         const std::vector<std::string>& sets) {
  auto document = std::make_shared<Document>();
  document->file = document->name = name;
  document->bytes = text;
  document->read_text();
  for (const std::string& set : sets) document->apply(set);
  document->read_preset();
  document->read_bodies();
  return CaseFile(document);
}

CaseFile CaseFile::declarations_only() {
  auto document = std::make_shared<Document>();
  document->file = document->name = "case.toml";
  document->only_declares = true;
  return CaseFile(document);
}

CaseTable CaseFile::root() {
  return {document_, ""};
}
void CaseFile::not_a_case() {
  document_->explained = false;
}
const std::vector<KeyInfo>& CaseFile::declared() const {
  return document_->keys;
}
std::filesystem::path CaseFile::path() const {
  return document_->file;
}
std::filesystem::path CaseFile::folder() const {
  return document_->folder();
}
const std::string& CaseFile::preset() const {
  return document_->preset;
}
bool CaseFile::has(const std::string& path) const {
  return document_->at(path) != nullptr;
}
bool CaseFile::is_true(const std::string& path) const {
  const toml::node* node = document_->at(path);
  const auto* flag = node == nullptr ? nullptr : node->as_boolean();
  return flag != nullptr && flag->get();
}
std::string CaseFile::text_at(const std::string& path) const {
  const toml::node* node = document_->at(path);
  return node == nullptr ? std::string() : node->value_or(std::string());
}

std::vector<double> CaseFile::numbers_at(const std::string& path) const {
  std::vector<double> numbers;
  std::vector<const toml::node*> rest{document_->at(path)};
  while (!rest.empty()) {
    const toml::node* node = rest.back();
    rest.pop_back();
    if (node == nullptr) continue;
    if (const toml::array* array = node->as_array()) {
      for (std::size_t i = array->size(); i-- > 0;) rest.push_back(array->get(i));
    } else if (const auto number = node->value<double>();
               node->is_number() && number && std::isfinite(*number)) {
      numbers.push_back(*number);
    }
  }
  return numbers;
}
bool CaseFile::is_right() const {
  return document_->refused.empty();
}
bool CaseFile::only_declares() const {
  return document_->only_declares;
}

}  // namespace strake
