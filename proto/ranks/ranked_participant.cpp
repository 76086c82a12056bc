#include "proto/ranks/ranked_participant.hpp"

#include "proto/error.hpp"
#include "proto/ranks/agreement.hpp"
#include "proto/wire/wire.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

namespace strake {

namespace {

/// What is announced: one byte, then the data of the call as a message to a participant.
enum class Call : std::uint8_t {
  build,
  start,
  finish,
  rewind,
  commit,
  commit_with_output,
  checkpoint,
  resume,
  flush,
  end
};

void append(Bytes& bytes, std::span<const std::byte> more) {
  const std::size_t size = more.size();
  const auto* const length = reinterpret_cast<const std::byte*>(&size);
  bytes.insert(bytes.end(), length, length + sizeof size);
  bytes.insert(bytes.end(), more.begin(), more.end());
}

Bytes announcement(Call call) {
  return {static_cast<std::byte>(call)};
}
Bytes announcement(Call call, wire::Request request) {
  Bytes bytes = announcement(call);
  for (const wire::Part& part : wire::encode(std::move(request), "the first rank")) append(bytes, part.bytes);
  return bytes;
}

/// The message of an announcement.
wire::Request message_of(const Bytes& bytes) {
  const auto owner = std::make_shared<Bytes>(bytes);
  wire::Parts parts;
  for (std::size_t at = 1; at < owner->size();) {
    std::size_t size = 0;
    std::memcpy(&size, owner->data() + at, sizeof size);
    at += sizeof size;
    parts.push_back({std::span<const std::byte>(*owner).subspan(at, size), owner});
    at += size;
  }
  return wire::decode_request(parts, "the first rank");
}

}  // namespace

RankedParticipant::RankedParticipant(MpiCommunicator& ranks, const Setup& setup, const RankFactory& build)
    : ranks_(ranks) {
  ranks_.announce(announcement(Call::build, {0, setup}));
  call_together(ranks_, [&] { own_ = build(setup); });
}

void announce_end(MpiCommunicator& ranks) {
  ranks.announce(announcement(Call::end));
}

void RankedParticipant::start(const Window& window, const Input& input) {
  wire::Advance advance;
  advance.window = window;
  advance.input = input;
  ranks_.announce(announcement(Call::start, {0, std::move(advance)}));
  call_together(ranks_, [&] { own_->start(window, input); });
}

Advanced RankedParticipant::finish() {
  ranks_.announce(announcement(Call::finish));
  Advanced advanced;
  call_together(ranks_, [&] { advanced = own_->finish(); });
  return advanced;
}

void RankedParticipant::rewind() {
  ranks_.announce(announcement(Call::rewind));
  call_together(ranks_, [&] { own_->rewind(); });
}

void RankedParticipant::commit(bool write_output) {
  ranks_.announce(announcement(write_output ? Call::commit_with_output : Call::commit));
  call_together(ranks_, [&] { own_->commit(write_output); });
}

void RankedParticipant::checkpoint(const std::filesystem::path& folder) {
  wire::Checkpoint to;
  to.folder = folder.string();
  ranks_.announce(announcement(Call::checkpoint, {0, std::move(to)}));
  call_together(ranks_, [&] { own_->checkpoint(folder); });
}

void RankedParticipant::resume(const std::filesystem::path& folder) {
  wire::Checkpoint from;
  from.folder = folder.string();
  from.resume = true;
  ranks_.announce(announcement(Call::resume, {0, std::move(from)}));
  call_together(ranks_, [&] { own_->resume(folder); });
}

void RankedParticipant::flush() {
  ranks_.announce(announcement(Call::flush));
  call_together(ranks_, [&] { own_->flush(); });
}

namespace {

/// Does on this rank what the first one has announced.
void do_own_part(std::unique_ptr<Participant>& own, Call call, const Bytes& bytes, const RankFactory& build) {
  if (call == Call::build) {
    own = build(std::get<Setup>(message_of(bytes).what));
  } else if (own == nullptr) {
    return;  // it could not be built, which the first rank says
  } else if (call == Call::start) {
    const auto advance = std::get<wire::Advance>(message_of(bytes).what);
    own->start(advance.window, advance.input);
  } else if (call == Call::finish) {
    own->finish();
  } else if (call == Call::rewind) {
    own->rewind();
  } else if (call == Call::commit || call == Call::commit_with_output) {
    own->commit(call == Call::commit_with_output);
  } else if (call == Call::checkpoint) {
    own->checkpoint(std::get<wire::Checkpoint>(message_of(bytes).what).folder);
  } else if (call == Call::resume) {
    own->resume(std::get<wire::Checkpoint>(message_of(bytes).what).folder);
  } else if (call == Call::flush) {
    own->flush();
  }
}

}  // namespace

void work_for_first_rank(MpiCommunicator& ranks, const RankFactory& build) {
  std::unique_ptr<Participant> own;
  while (true) {
    const Bytes bytes = ranks.await_announcement();
    const auto call = static_cast<Call>(bytes.front());
    if (call == Call::end) return;
    try {
      call_together(ranks, [&] { do_own_part(own, call, bytes, build); });
    } catch (const Error&) {
      if (ranks.is_broken()) throw;
      // The first rank has the same error and tells the coupler.
    }
  }
}

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
