#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace strake::report {

/// Text as it may stand between tags and in attributes.
std::string escape(std::string_view);
/// "1.742 mm" for 0.001742 m; four digits; "–" for none.
std::string quantity(std::optional<double> value, const std::string& unit);
/// "−1.5 %"; "–" for none.
std::string percent(std::optional<double> share);
/// "4 min 41 s"; "–" for none.
std::string duration(std::optional<double> seconds);
/// The shortest text that reads back to the same number; empty for none.
std::string exact(std::optional<double> value);

/// A table in a box of its own that scrolls where the page is narrow. Cells are HTML.
class HtmlTable {
 public:
  explicit HtmlTable(std::string caption) : caption_(std::move(caption)) {}
  /// Header cells, escaped here.
  void head(const std::vector<std::string>& names);
  /// The first cell of a row heads it.
  void row(const std::vector<std::string>& cells);
  bool empty() const { return rows_.empty(); }
  std::string html() const;

 private:
  std::string caption_, head_, rows_;
};

/// A number in a cell: what is read, and its exact value for programs (data-value).
std::string number_cell(std::optional<double> value, std::string_view shown);
/// Words in a cell, in which lines may break.
std::string words_cell(std::string_view);
/// The number as `quantity` shows it.
std::string quantity_cell(std::optional<double> value, const std::string& unit);
/// A section with a heading of the second level that the page's contents lead to.
std::string section(const std::string& id, const std::string& heading, const std::string& body);
/// "pass", "FAIL" and the like, marked by more than colour. kind: good | bad | open.
std::string badge(const std::string& kind, const std::string& text);

}  // namespace strake::report
