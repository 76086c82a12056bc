#include "proto/ranks/call_together.hpp"

#include "proto/ranks/error_message.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace strake {

void call_together(MpiCommunicator& ranks, const std::function<void()>& call) {
  const std::optional<Error> own = error_of(call);
  const auto failed = ranks.end_call(own.has_value());
  if (!failed) {  // the first rank tells the coupler; another one prints it behind its own name
    if (ranks.rank() == 0) throw of_rank(0, *own);
    throw *own;
  }
  const auto first = std::ranges::find(*failed, true);
  if (first == failed->end()) return;
  const auto rank = static_cast<int>(first - failed->begin());
  const std::vector<Bytes> errors = ranks.gather(packed(own));
  const Error error = unpacked(errors[static_cast<std::size_t>(rank)]);
  const bool of_all = std::ranges::count(*failed, true) == ranks.size() && !error.where().empty();
  throw of_all ? error : of_rank(rank, error);
}

}  // namespace strake
