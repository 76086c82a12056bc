// A case file of any bytes must be read, or refused with an Error that names the place. A case that was read
// can be written and read again.
//
// Bytes → case: the TOML text up to the first zero byte, then up to four --set strings, each up to the next.

#include "proto/error.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/proto/plate_case.hpp"

#include <cstdlib>
#include <sstream>

using namespace strake;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream bytes(std::string(reinterpret_cast<const char*>(data), size));
  std::string toml;
  std::getline(bytes, toml, '\0');
  std::vector<std::string> sets;
  for (std::string set; sets.size() < 4 && std::getline(bytes, set, '\0');) sets.push_back(set);

  std::string echo;
  try {
    CaseFile file = CaseFile::parse(toml, "case.toml", sets);
    const std::vector<std::string> keys = file.root().keys();
    for (const std::string& key : keys) static_cast<void>(file.root().where(key));
    read_plate(file);
    file.refuse_unknown();
    echo = file.echo();
    if (keys_from_json(to_json(file.declared())).size() != file.declared().size()) std::abort();
  } catch (const Error& error) {
    if (to_text(error).empty() || to_text(error).size() > 65536) std::abort();  // a refusal says why, briefly
    return 0;
  }
  try {
    CaseFile again = CaseFile::parse(echo);
    read_plate(again);
    again.refuse_unknown();
  } catch (const Error&) {
    std::abort();  // the resolved case is a case
  }
  return 0;
}

std::vector<std::string> seeds() {
  const std::string plate =
      "title = \"plate\"\nend_time = 0.03\n[fluid]\nspacing = 0.01\ngravity = [0, -9.81]\ntank = [[0, 0], "
      "[1, 1]]\n"
      "[structure]\nsolver = \"particle\"\nparts = [\"bottom\", 'side']\n[structure.material]\nyoung = "
      "2.1e11\nmodel = \"linear\"\n"
      "[[output.probe]]\nname = \"mid\"\nof = \"structure\"\nat = [0.0, 0.0, 0.0]\n";
  using namespace std::string_literals;
  return {plate,
          plate +
              "[[compare]]\nprobe = \"mid.y\"\nwhen = { \"structure.solver\" = [\"fem\", \"particle\"] "
              "}\nvalue = { peak = 1e-3 }\n",
          plate + "\0fluid.spacing=0.02\0output.probe[1].name=\"p\"\0preset=paper"s,
          "end_time = inf\n",
          "a.b.\"c d\" = 1979-05-27T07:32:00Z\nx = 0x1F\n[[a.b.c]]\n",
          "end_time = 0.1\ntitle = \"\"\"\nlong\\\n  text\"\"\"\n[fluid]\nspacng = 0.1 # a slip\n"};
}
