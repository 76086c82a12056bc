#include "proto/mesh_files/stl.hpp"

#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/mesh_files/byte_order_mark.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace strake {
namespace {

constexpr std::size_t header = 84, record = 50;  // [bytes] of the binary form

Error wrong(const std::string& where, const std::string& problem,
            const std::string& fix = "export the STL file anew") {
  return {ExitCode::case_file, where, problem, fix};
}

Error too_many(const std::string& where, double count) {
  return wrong(where, fmt::format("{:.0f} triangles, at most {} are read", count, most_stl_triangles),
               "export with a coarser tolerance: edges of about structure.surface_spacing are enough");
}

/// Words of a text with their lines.
class Words {
 public:
  Words(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  /// The next word in small letters; empty at the end of the file.
  std::string next() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front()))) {
      if (rest_.front() == '\n') ++line_;
      rest_.remove_prefix(1);
    }
    std::size_t length = 0;
    while (length < rest_.size() && !std::isspace(static_cast<unsigned char>(rest_[length]))) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return lower_case(word);
  }

  void skip_line() { rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size())); }

  void expect(std::string_view word) {
    if (const std::string found = next(); found != word) throw other(fmt::format("\"{}\"", word), found);
  }

  double number() {
    const std::string word = next();
    const auto value = number_from<double>(word.starts_with('+') ? word.substr(1) : word);
    if (!value) throw other("a number", word);
    return *value;
  }

  Error other(const std::string& expected, const std::string& found) const {
    constexpr std::size_t most = 30;  // letters of a word that is shown
    return wrong(where(), found.empty() ? "the file ends here, expected " + expected
                                        : fmt::format("expected {}, found \"{}\"", expected,
                                                      visible(found.substr(0, most))));
  }
  std::string where() const { return fmt::format("{}:{}", file_, line_); }

 private:
  std::string_view rest_;
  std::string file_;
  std::size_t line_ = 1;
};

void read_facet(Words& words, std::vector<double>& corner) {
  words.expect("normal");
  for (int k = 0; k < 3; ++k) words.next();  // the normal itself: some programs write what is no number
  words.expect("outer");
  words.expect("loop");
  for (int k = 0; k < 3; ++k) {
    words.expect("vertex");
    for (int axis = 0; axis < 3; ++axis) corner.push_back(words.number());
  }
  words.expect("endloop");
  words.expect("endfacet");
}

std::vector<double> read_text(std::string_view bytes, const std::string& file) {
  Words words(bytes, file);
  std::vector<double> corner;
  words.expect("solid");
  for (words.skip_line();;) {
    const std::string word = words.next();
    if (word == "facet") {
      read_facet(words, corner);
      if (corner.size() / 9 > static_cast<std::size_t>(most_stl_triangles))
        throw too_many(words.where(), static_cast<double>(corner.size() / 9));
    } else if (word == "endsolid") {
      words.skip_line();
      const std::string after = words.next();
      if (after.empty()) return corner;
      if (after != "solid") throw words.other("\"solid\" or the end of the file", after);
      words.skip_line();
    } else {
      throw words.other("\"facet\" or \"endsolid\"", word);
    }
  }
}

/// Number of triangles that a binary file's head gives; 0 for a shorter file.
std::size_t binary_count(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= header) std::memcpy(&count, bytes.data() + header - sizeof count, sizeof count);
  return count;
}

std::vector<double> read_binary(std::string_view bytes, const std::string& file) {
  const std::size_t count = binary_count(bytes), expected = header + record * count;
  if (bytes.size() < header)
    throw wrong(file, fmt::format("{} bytes, a binary STL file has at least {}", bytes.size(), header));
  if (bytes.size() != expected)
    throw wrong(file, fmt::format("a binary STL file of {} triangles has {} bytes, this one has {}{}", count,
                                  expected, bytes.size(), bytes.size() < expected ? ": it is cut off" : ""));
  if (count > static_cast<std::size_t>(most_stl_triangles)) throw too_many(file, static_cast<double>(count));
  std::vector<double> corner;
  corner.reserve(9 * count);
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t k = 3; k < 12; ++k) {  // after the normal
      float value = 0;
      std::memcpy(&value, bytes.data() + header + record * t + sizeof value * k, sizeof value);
      corner.push_back(static_cast<double>(value));
    }
  return corner;
}

bool looks_like_text(std::string_view bytes) {
  constexpr std::size_t looked_at = 1024;
  return lower_case(bytes.substr(0, 5)) == "solid" &&
         bytes.substr(0, looked_at).find('\0') == std::string_view::npos;
}

}  // namespace

bool is_stl(const std::filesystem::path& path) {
  return lower_case(path.extension().string()) == ".stl";
}

Points read_stl(const std::filesystem::path& path) {
  const std::string file = path.string(), bytes = read_whole(path, largest_mesh, file);
  const bool sized = bytes.size() >= header && bytes.size() == header + record * binary_count(bytes);
  const std::string_view text = without_byte_order_mark(bytes);
  const std::vector<double> corner =
      !sized && looks_like_text(text) ? read_text(text, file) : read_binary(bytes, file);
  if (corner.empty()) throw wrong(file, "no triangles");
  Points points = Eigen::Map<const Points>(corner.data(), 3, static_cast<Eigen::Index>(corner.size() / 3));
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    if (!points.col(k).allFinite())
      throw wrong(file, fmt::format("triangle {} has a corner that is not finite", k / 3 + 1));
  return points;
}

}  // namespace strake
