#include "coupler/plot/html.hpp"

#include "coupler/plot/ticks.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake::report {

std::string escape(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        // Control characters belong in no page; a tab and the ends of lines may stay.
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') safe += c;
    }
  }
  return safe;
}

std::string quantity(std::optional<double> value, const std::string& unit) {
  if (!value || !std::isfinite(*value)) return "–";
  const Prefix prefix = prefix_for(*value, unit);
  const double shown = prefix.factor * *value;
  const bool long_one = shown != 0 && (std::abs(shown) >= 1e5 || std::abs(shown) < 1e-3);
  std::string text = long_one ? fmt::format("{:.3e}", shown) : fmt::format("{:.4g}", shown);
  if (text.starts_with('-')) text = "−" + text.substr(1);
  const std::string name = with_prefix(prefix, unit);
  return name.empty() ? text : text + " " + name;
}

std::string percent(std::optional<double> share) {
  if (!share || !std::isfinite(*share)) return "–";
  const double value = 100 * *share;
  const std::string text = std::abs(value) >= 1000 ? fmt::format("{:.3g}", std::abs(value))
                                                   : fmt::format("{:.1f}", std::abs(value));
  return (value < 0 ? "−" : "+") + text + " %";
}

std::string exact(std::optional<double> value) {
  return value && std::isfinite(*value) ? fmt::format("{}", *value) : std::string();
}

std::string duration(std::optional<double> seconds) {
  if (!seconds) return "–";
  if (*seconds < 60) return fmt::format("{:.1f} s", *seconds);
  const auto whole = static_cast<long>(*seconds + 0.5);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string number_cell(std::optional<double> value, std::string_view shown) {
  return fmt::format("<span class=\"n\" data-value=\"{}\">{}</span>", exact(value), escape(shown));
}

std::string words_cell(std::string_view text) {
  return "<span class=\"words\">" + escape(text) + "</span>";
}

std::string quantity_cell(std::optional<double> value, const std::string& unit) {
  return number_cell(value, quantity(value, unit));
}

void HtmlTable::head(const std::vector<std::string>& names) {
  head_ += "<tr>";
  for (const std::string& name : names) head_ += "<th scope=\"col\">" + escape(name) + "</th>";
  head_ += "</tr>\n";
}

void HtmlTable::row(const std::vector<std::string>& cells) {
  rows_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i)
    rows_ += i == 0 ? "<th scope=\"row\">" + cells[i] + "</th>" : "<td>" + cells[i] + "</td>";
  rows_ += "</tr>\n";
}

std::string HtmlTable::html() const {
  return fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\">\n<table>\n"
      "<caption>{0}</caption>\n<thead>{1}</thead>\n<tbody>\n{2}</tbody>\n</table>\n</div>\n",
      escape(caption_), head_, rows_);
}

std::string section(const std::string& id, const std::string& heading, const std::string& body) {
  return fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-h\">\n<h2 id=\"{0}-h\">{1}</h2>\n{2}</section>\n", id,
      escape(heading), body);
}

std::string badge(const std::string& kind, const std::string& text) {
  return fmt::format("<span class=\"badge {}\">{}</span>", kind, escape(text));
}

}  // namespace strake::report
