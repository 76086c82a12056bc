#include "coupler/plot/html.hpp"
#include "coupler/report/sections.hpp"
#include "coupler/report/style.hpp"
#include "coupler/run/run_folder.hpp"
#include "proto/version.hpp"

#include <fmt/format.h>

namespace strake::report {
namespace {

/// A link to each <section id="…"> by its heading.
std::string contents(const std::string& body) {
  const std::string begin = "<section id=\"", heading = "-h\">";
  std::string links;
  for (auto at = body.find(begin); at != std::string::npos; at = body.find(begin, at + 1)) {
    const auto id = at + begin.size(), id_end = body.find('"', id);
    const auto text = body.find("<h2 id=", id), from = body.find(heading, text) + heading.size();
    links += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", body.substr(id, id_end - id),
                         body.substr(from, body.find("</h2>", from) - from));
  }
  return links;
}

}  // namespace

std::string page(const std::string& title, const std::string& lead, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<meta name=\"generator\" content=\"strake {}\">\n"
      "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">To the "
      "content</a>\n"
      "<header>\n<h1>{}</h1>\n{}</header>\n<nav aria-label=\"contents\"><ul>\n{}</ul></nav>\n"
      "<main id=\"main\">\n{}</main>\n<footer><p>Made by strake {} ({}), {}. SI units; 2-D values are per "
      "metre of "
      "depth.</p></footer>\n</body>\n</html>\n",
      strake_version(), escape(title), style_sheet, escape(title), lead, contents(body), body,
      strake_version(), escape(strake_commit()), utc_now());
}

}  // namespace strake::report
