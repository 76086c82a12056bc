#pragma once

#include "coupler/plot/sheet.hpp"

#include <string>
#include <vector>

namespace strake::picture {

/// A figure of a page: inline SVG that the page's style sheet colours, so that it is dark on a dark page.
class PageCanvas final : public Sheet {
 public:
  PageCanvas(double width, double height) : width_(width), height_(height) {}
  void path(const std::vector<Place>&, const Style&, const std::string& title = {}) override;
  void circle(const Place&, double radius, const Style&) override;
  void text(double x, double y, const std::string&, double size, Align = Align::left,
            bool bold = false) override;
  double text_width(const std::string&, double size, bool bold = false) override;
  void clip(double x, double y, double width, double height) override;
  void unclip() override;

  /// Several lines as one shape, so that one inside another is a hole.
  void shape(const std::vector<std::vector<Place>>&, const std::string& style, bool closed);
  /// The element. kind: its class; label: its words for who does not see it; empty: it is an ornament.
  std::string svg(const std::string& kind, const std::string& label = {}) const;

 private:
  double width_, height_;
  std::string content_;
};

}  // namespace strake::picture
