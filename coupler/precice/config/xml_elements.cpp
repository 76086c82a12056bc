#include "coupler/precice/config/xml_elements.hpp"

#include "proto/error.hpp"

#include <expat.h>
#include <fmt/format.h>

#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

namespace strake {
namespace {

constexpr std::size_t largest_file = 16 << 20;  // [bytes] far above any configuration; Expat counts in int

/// What Expat's callbacks know.
struct Reading {
  XML_Parser parser;
  std::filesystem::path file;
  const std::function<void(const XmlElement&)>& open;
  std::vector<std::string> around;  // names of the open elements
  std::exception_ptr error;         // none may pass through Expat, which is C
};

int line_of(XML_Parser parser) {
  return static_cast<int>(XML_GetCurrentLineNumber(parser));
}
int column_of(XML_Parser parser) {
  return static_cast<int>(XML_GetCurrentColumnNumber(parser)) + 1;
}

void on_start(void* data, const XML_Char* name, const XML_Char** attributes) {
  auto& reading = *static_cast<Reading*>(data);
  XmlElement element{.file = reading.file,
                     .line = line_of(reading.parser),
                     .column = column_of(reading.parser),
                     .depth = static_cast<int>(reading.around.size()),
                     .parent = reading.around.empty() ? "" : reading.around.back(),
                     .name = name,
                     .attributes = {}};
  for (; *attributes; attributes += 2) element.attributes[attributes[0]] = attributes[1];
  reading.around.push_back(element.name);
  try {
    reading.open(element);
  } catch (...) {
    reading.error = std::current_exception();
    XML_StopParser(reading.parser, XML_FALSE);
  }
}

void on_end(void* data, const XML_Char*) {
  static_cast<Reading*>(data)->around.pop_back();
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file || std::filesystem::is_directory(path))
    throw Error(ExitCode::case_file, path.string(), "cannot be read",
                "the path of precice-config.xml, seen from the current folder, " +
                    std::filesystem::current_path().string());
  if (text.size() > largest_file)
    throw Error(ExitCode::case_file, path.string(), "is too large to be a preCICE configuration", "");
  return text;
}

}  // namespace

std::string_view XmlElement::kind() const {
  return std::string_view(name).substr(0, name.find(':'));
}

std::string_view XmlElement::type() const {
  const std::size_t colon = name.find(':');
  return colon == std::string::npos ? std::string_view() : std::string_view(name).substr(colon + 1);
}

std::string XmlElement::text(const std::string& attribute) const {
  const auto found = attributes.find(attribute);
  if (found == attributes.end())
    refuse(fmt::format("has no {}", attribute), fmt::format("<{} {}=\"…\" … />", name, attribute));
  return found->second;
}

std::string XmlElement::text_or(const std::string& attribute, const std::string& otherwise) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() ? otherwise : found->second;
}

bool XmlElement::flag(const std::string& attribute) const {
  const std::string word = text_or(attribute, "no");
  for (const char* yes : {"yes", "true", "on", "1"})
    if (word == yes) return true;
  for (const char* no : {"no", "false", "off", "0"})
    if (word == no) return false;
  refuse(fmt::format("{} = \"{}\"", attribute, word), "true or false");
}

void XmlElement::refuse(const std::string& problem, const std::string& fix) const {
  throw Error(ExitCode::case_file, fmt::format("{}:{}:{}: <{}>", file.string(), line, column, name), problem,
              fix);
}

void read_xml(const std::filesystem::path& path, const std::function<void(const XmlElement&)>& open) {
  const std::string text = content_of(path);
  const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr),
                                                                       XML_ParserFree);
  Reading reading{parser.get(), path, open, {}, {}};
  XML_SetUserData(parser.get(), &reading);
  XML_SetElementHandler(parser.get(), on_start, on_end);
  const XML_Status status = XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE);
  if (reading.error) std::rethrow_exception(reading.error);
  if (status == XML_STATUS_OK) return;
  throw Error(ExitCode::case_file,
              fmt::format("{}:{}:{}", path.string(), line_of(parser.get()), column_of(parser.get())),
              fmt::format("is no XML: {}", XML_ErrorString(XML_GetErrorCode(parser.get()))), "");
}

}  // namespace strake
