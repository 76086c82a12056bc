#include "coupler/new_case/case_lines.hpp"

#include "coupler/new_case/scenes.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace strake {
namespace {

constexpr std::size_t comment_column = 40;
constexpr double frames_of_run = 50;  // of a run

std::string corners_text(const NewScene& s, double top, double right) {
  return fmt::format("[{}, {}]", toml_vector(s.left, s.bottom, s.back), toml_vector(right, top, s.front));
}

}  // namespace

std::string toml_number(double x) {
  std::string text = fmt::format("{:.9g}", x);
  if (const auto e = text.find('e'); e != std::string::npos) {
    const int exponent = std::atoi(text.c_str() + e + 1);  // 6 instead of +06
    const std::string digits = text.substr(0, e);
    return fmt::format("{}{}e{}", digits, digits.find('.') == std::string::npos ? ".0" : "", exponent);
  }
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

std::string toml_vector(double x, double y, double z) {
  return fmt::format("[{}, {}, {}]", toml_number(x), toml_number(y), toml_number(z));
}

CaseLines& CaseLines::table(const std::string& head) {
  text_ += "\n" + head + "\n";
  return *this;
}

CaseLines& CaseLines::key(const std::string& name, const std::string& value, const std::string& comment) {
  const std::string line = name + " = " + value;
  const std::size_t gap = line.size() + 1 < comment_column ? comment_column - line.size() : 2;
  text_ += line + std::string(gap, ' ') + "# " + comment + "\n";
  return *this;
}

CaseLines& CaseLines::number(const std::string& name, double value, const std::string& comment) {
  return key(name, toml_number(value), comment);
}

CaseLines& CaseLines::text(const std::string& name, const std::string& value, const std::string& comment) {
  std::string quoted;
  for (const char c : visible(value))
    quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
  return key(name, "\"" + quoted + "\"", comment);
}

CaseLines& CaseLines::comment(const std::string& words) {
  text_ += "# " + visible(words, "") + "\n";
  return *this;
}

std::string case_file_text(const std::string& kind, const NewScene& s) {
  CaseLines lines;
  lines.comment(s.physics)
      .comment(fmt::format(
          "Written by `strake new {}`. `strake check FILE` says what a run of it costs and what", kind))
      .comment(
          "its spacings resolve; `strake run FILE` runs it. Units are SI. `strake explain KEY` explains a "
          "key.");
  if (!s.warning.empty()) lines.comment("Warning: " + s.warning);
  lines.text("title", s.title, "headline of the run")
      .number("end_time", two_digits(s.end_time), "s, " + s.end_reason);
  lines.table("[fluid]")
      .key("dimension", fmt::format("{}", s.dimension),
           s.dimension == 2 ? "2: the plane, masses and forces are per metre of depth" : "3: space")
      .number(
          "spacing", s.spacing,
          "m, between particles" + s.spacing_limit + "; half of it, to judge a result: " + cost_of_half(s))
      .number("density", 1000, "kg/m^3, of the water")
      .number("kinematic_viscosity", 1e-6, "m^2/s, of the water")
      .key("gravity", "[0.0, -9.81, 0.0]", "m/s^2")
      .key("sound_speed", s.submerged ? "inf" : toml_number(1500), "m/s, of the water; inf: incompressible")
      .key("tank", corners_text(s, s.top, s.right), "m, corners of its inner faces; it is open above")
      .key("water", corners_text(s, s.surface, s.water_right), "m, corners of the water at the start");
  if (s.submerged)
    lines.key("submerged", "true", "the water gives way to the body that stands in it at the start");
  std::string text = lines.str() + s.body;
  CaseLines rest;
  rest.table("[output]")
      .number("every", round_number(s.end_time / frames_of_run), "s, between frames of the fields");
  rest.table("[coupling.surface]");
  rest.comment("window, the time between exchanges, is left out: it follows shape, speed and spacing.")
      .comment("`strake check FILE` says which it is, and why.");
  return text + rest.str();
}

}  // namespace strake
