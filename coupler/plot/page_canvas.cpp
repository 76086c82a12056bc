#include "coupler/plot/canvas.hpp"
#include "coupler/plot/html.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake::picture {
namespace {

using report::escape;

std::string points_of(const std::vector<Place>& points, bool closed) {
  std::string d;
  for (const Place& p : points) d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : "L", p.x, p.y);
  return d + (closed ? "Z" : "");
}

}  // namespace

void PageCanvas::path(const std::vector<Place>& points, const Style& style, const std::string& title) {
  content_ += fmt::format("<path class=\"{}\" d=\"{}\"", style.name, points_of(points, style.filled));
  content_ += title.empty() ? "/>\n" : "><title>" + escape(title) + "</title></path>\n";
}

void PageCanvas::shape(const std::vector<std::vector<Place>>& lines, const std::string& style, bool closed) {
  std::string d;
  for (const auto& line : lines) d += points_of(line, closed);
  if (!d.empty()) content_ += fmt::format("<path class=\"{}\" d=\"{}\"/>\n", style, d);
}

void PageCanvas::circle(const Place& centre, double radius, const Style& style) {
  content_ += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>\n", style.name,
                          centre.x, centre.y, radius);
}

void PageCanvas::text(double x, double y, const std::string& words, double /*size*/, Align align,
                      bool /*bold*/) {
  const char* anchor = align == Align::left ? "start" : align == Align::right ? "end" : "middle";
  const std::string place = align == Align::upwards
                                ? fmt::format("transform=\"translate({:.1f} {:.1f}) rotate(-90)\"", x, y)
                                : fmt::format("x=\"{:.1f}\" y=\"{:.1f}\"", x, y);
  content_ += fmt::format("<text {} text-anchor=\"{}\">{}</text>\n", place, anchor, escape(words));
}

// The page's letters are not known here: as wide as digits of a common face.
double PageCanvas::text_width(const std::string& words, double size, bool /*bold*/) {
  const auto letters = std::count_if(words.begin(), words.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return 0.65 * size * static_cast<double>(letters);
}

// An inner svg shows nothing outside its box.
void PageCanvas::clip(double x, double y, double width, double height) {
  content_ += fmt::format(
      "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" viewBox=\"{0:.1f} {1:.1f} "
      "{2:.1f} "
      "{3:.1f}\">\n",
      x, y, width, height);
}

void PageCanvas::unclip() {
  content_ += "</svg>\n";
}

std::string PageCanvas::svg(const std::string& kind, const std::string& label) const {
  const std::string head =
      fmt::format("<svg class=\"{}\" viewBox=\"0 0 {:.0f} {:.0f}\"", kind, width_, height_);
  if (label.empty()) return head + " aria-hidden=\"true\">" + content_ + "</svg>";
  return fmt::format("{0} role=\"img\" aria-label=\"{1}\">\n<title>{1}</title>\n{2}</svg>", head,
                     escape(label), content_);
}

}  // namespace strake::picture
