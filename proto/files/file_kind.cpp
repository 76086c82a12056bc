#include "proto/files/file_kind.hpp"

#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <string_view>

namespace strake {
namespace {

/// Bytes with which a file begins that no text does.
struct Magic {
  std::string_view bytes;
  const char* name;
};
constexpr std::array<Magic, 8> magics{{{"\x7f"
                                        "ELF",
                                        "is a compiled program"},
                                       {"\x89HDF", "is an HDF5 file, such as a frame or a record of a run"},
                                       {"PK\x03\x04", "is a ZIP archive"},
                                       {"\x1f\x8b", "is a compressed file (gzip)"},
                                       {"\x89PNG", "is a picture"},
                                       {"%PDF", "is a PDF file"},
                                       {"\xff\xfe", "is UTF-16 text"},
                                       {"\xfe\xff", "is UTF-16 text"}}};

/// Whether more than a twentieth of the first bytes are control characters, which a text does not have.
bool is_binary(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 4096);
  const auto controls = std::count_if(head.begin(), head.end(), [](unsigned char c) {
    return c < ' ' && c != '\t' && c != '\n' && c != '\r' && c != '\f';
  });
  return 20 * static_cast<std::size_t>(controls) > head.size();
}

/// The case of the run in whose folder the file lies, or how to come to a case.
std::string way_to_a_case(const std::filesystem::path& file) {
  std::error_code none;
  for (std::filesystem::path folder : {file.parent_path(), file.parent_path() / ".."})
    if (std::filesystem::is_regular_file(folder / "case.toml", none))
      return "the case of that run is " + (folder / "case.toml").lexically_normal().string();
  return "name a case file (.toml); strake new writes one";
}

}  // namespace

std::optional<FileKind> foreign_kind(const std::filesystem::path& file, const std::string& bytes) {
  const std::string path = file.string(), name = file.filename().string();
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const auto ends = [&](std::initializer_list<const char*> known) {
    return std::find(known.begin(), known.end(), ending) != known.end();
  };
  const std::string as_solver =
      fmt::format("a case names it: structure.solver = \"./{}\"; strake run takes the case", name);
  if (ends({".fmu"}))
    return FileKind{
        "is a co-simulation unit (FMU)",
        fmt::format("a case names it in [[attachments]]: solver = \"fmu\" and fmu.file = \"{}\"", name)};
  for (const Magic& magic : magics)
    if (bytes.starts_with(magic.bytes)) {
      const std::string_view what = magic.name;
      return FileKind{std::string(what), what.find("program") != std::string_view::npos  ? as_solver
                                         : what.find("UTF-16") != std::string_view::npos ? "save it as UTF-8"
                                         : what.find("gzip") != std::string_view::npos
                                             ? "unpack it with gunzip"
                                             : way_to_a_case(file)};
    }
  if (ends({".stl", ".msh", ".inp"}))
    return FileKind{"is a mesh file", "strake new mesh " + path + " writes a case for it"};
  if (is_binary(bytes)) return FileKind{"is a binary file", way_to_a_case(file)};
  const std::string begin(trimmed(std::string_view(bytes).substr(0, 400)));
  if (begin.starts_with("#!") || ends({".py", ".sh"}))
    return FileKind{ending == ".py" || begin.substr(0, begin.find('\n')).find("python") != std::string::npos
                        ? "is a program in Python"
                        : "is a script",
                    as_solver + "; a script that starts runs itself is started without strake run"};
  if (ends({".csv"}))
    return FileKind{"is a table (CSV)",
                    "strake compare RUN " + path + " holds a run against it; " + way_to_a_case(file)};
  if (ends({".json", ".ipynb"}) || begin.starts_with('{')) return FileKind{"is JSON", way_to_a_case(file)};
  if (begin.starts_with('<'))
    return begin.find("precice") != std::string::npos ||
                   bytes.find("<precice-configuration") != std::string::npos
               ? FileKind{"is a preCICE configuration (XML)",
                          "strake import " + path + " writes a case from it"}
               : FileKind{"is XML", way_to_a_case(file)};
  if (ends({".yaml", ".yml"})) return FileKind{"is YAML", way_to_a_case(file)};
  if (ends({".md", ".log"})) return FileKind{"is a page of text", way_to_a_case(file)};
  return std::nullopt;
}

}  // namespace strake
