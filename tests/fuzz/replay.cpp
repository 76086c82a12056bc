// Runs a fuzz target on its own seeds and on the files of a folder: replay FOLDER. Or writes the seeds there
// for libFuzzer to start from: replay --seeds FOLDER.

#include "tests/fuzz/fuzz.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace fs = std::filesystem;

namespace {

void run(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// What a little damage makes of an input: cut short, and one byte changed at a time.
void run_damaged(const std::string& bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    run(bytes.substr(0, i));
    for (const char change : {'\x01', '\x80', '\xff'}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ change);
      run(damaged);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "--seeds") {
    int number = 0;
    for (const std::string& seed : seeds())
      std::ofstream(fs::path(argv[2]) / fmt::format("seed-{:02}", ++number), std::ios::binary) << seed;
    return 0;
  }
  std::size_t inputs = 0;
  for (const std::string& seed : seeds()) {
    run(seed);
    run_damaged(seed);
    ++inputs;
  }
  for (int i = 1; i < argc; ++i) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(argv[i]))
      if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
      std::ifstream in(file, std::ios::binary);
      run({std::istreambuf_iterator<char>(in), {}});
      ++inputs;
    }
  }
  fmt::print("{} inputs\n", inputs);
  return inputs == 0;
}
