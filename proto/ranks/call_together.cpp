#include "proto/ranks/call_together.hpp"

#include "proto/error.hpp"

#include <algorithm>
#include <iterator>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strake {

namespace {

/// What the call throws on this rank, as an Error. Nothing: it ends well.
std::optional<Error> error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return Error(ExitCode::participant_lost, "", "is out of memory",
                 "a coarser spacing or mesh needs less, and so does each of more ranks on several machines");
  } catch (const std::exception& error) {
    return Error(ExitCode::our_bug, "", std::string("unexpected: ") + error.what(), "please report it");
  } catch (...) {
    return Error(ExitCode::our_bug, "", "unexpected", "please report it");
  }
  return {};
}

/// The same error with the rank in front of its place.
Error of_rank(int rank, const Error& error) {
  const std::string name = "rank " + std::to_string(rank);
  return {error.code(), error.where().empty() ? name : name + ", " + error.where(), error.problem(),
          error.fix()};
}

/// An Error as a message, and back.
Bytes packed(const std::optional<Error>& error) {
  Bytes bytes;
  if (!error) return bytes;
  append(bytes, error->code());
  for (const std::string* text : {&error->where(), &error->problem(), &error->fix()}) {
    append(bytes, text->size());
    for (const char c : *text) append(bytes, c);
  }
  return bytes;
}
Error unpacked(const Bytes& bytes) {
  const std::byte* at = bytes.data();
  const auto code = take<ExitCode>(at);
  std::string texts[3];
  for (std::string& text : texts) {
    text.resize(take<std::size_t>(at));
    for (char& c : text) c = take<char>(at);
  }
  return {code, texts[0], texts[1], texts[2]};
}

}  // namespace

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
