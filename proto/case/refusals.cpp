#include "proto/case/refusals.hpp"

#include <algorithm>
#include <sstream>
#include <string>

namespace strake {

Error all_of(const std::vector<Error>& errors) {
  if (errors.size() == 1) return errors.front();
  std::vector<std::string> blocks;
  for (const Error& error : errors) {
    std::istringstream lines(to_text(error));
    bool first = true;
    for (std::string line; std::getline(lines, line); first = false) {
      if (first || !line.starts_with(' '))
        blocks.push_back(line);
      else
        blocks.back() += "\n" + line;
    }
  }
  std::string text;
  for (auto block = blocks.begin(); block != blocks.end(); ++block)
    if (std::find(blocks.begin(), block, *block) == block) text += (text.empty() ? "" : "\n") + *block;
  return {ExitCode::case_file, "", text};
}

}  // namespace strake
