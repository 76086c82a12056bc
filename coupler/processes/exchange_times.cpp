#include "coupler/processes/exchange_times.hpp"

#include <algorithm>

namespace strake {

void ClockOffset::learn(const Exchange& exchange) {
  if (exchange.received == 0) return;
  const std::int64_t low = exchange.answered - exchange.heard, high = exchange.received - exchange.sent;
  if (low > high) return;  // the participant's clock does not run with ours; nothing can be learnt
  const bool apart = known_ && (low > high_ || high < low_);  // the clocks have drifted
  low_ = known_ && !apart ? std::max(low_, low) : low;
  high_ = known_ && !apart ? std::min(high_, high) : high;
  known_ = true;
}

std::int64_t ClockOffset::offset() const {
  if (!known_ || (low_ <= 0 && high_ >= 0)) return 0;
  return low_ + (high_ - low_) / 2;
}

ClockOffset::Span ClockOffset::computing(const Exchange& exchange) const {
  if (exchange.received == 0) return {exchange.sent, exchange.heard};
  const std::int64_t begin = std::clamp(exchange.received - offset(), exchange.sent, exchange.heard);
  return {begin, std::clamp(exchange.answered - offset(), begin, exchange.heard)};
}

}  // namespace strake
