#include "coupler/processes/stranger_log.hpp"

#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {
namespace {

constexpr std::size_t most_kinds = 20;
constexpr std::chrono::seconds first_quiet{10}, longest_quiet{600};
const std::string others = "others";  // what one more kind is counted as

}  // namespace

std::vector<std::string> StrangerLog::note(const std::string& what, int times, Clock::time_point now) {
  const bool known = kinds_.contains(what);
  const std::string& kind = known || kinds_.size() < most_kinds ? what : others;
  const auto [entry, is_new] = kinds_.try_emplace(kind, Kind{0, now, first_quiet});
  entry->second.untold += is_new ? times - 1 : times;
  if (!is_new) return {};
  return {kind};
}

std::vector<std::string> StrangerLog::due(Clock::time_point now) {
  std::vector<std::string> lines;
  for (auto entry = kinds_.begin(); entry != kinds_.end();) {
    Kind& kind = entry->second;
    const auto since = now - kind.told;
    if (since >= longest_quiet && kind.untold == 0) {
      entry = kinds_.erase(entry);
      continue;
    }
    if (since >= kind.quiet && kind.untold > 0) {
      lines.push_back(fmt::format("{} ({} more in {:.0f} s)", entry->first, kind.untold,
                                  std::chrono::duration<double>(since).count()));
      kind = {0, now, std::min<Clock::duration>(2 * kind.quiet, longest_quiet)};
    }
    ++entry;
  }
  return lines;
}

std::string harmless(const std::string& text) {
  constexpr std::size_t longest = 200;
  const std::string plain = visible(std::string_view(text).substr(0, longest), "");
  return text.size() > longest ? plain + "..." : plain;
}

}  // namespace strake
