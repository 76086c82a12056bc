#include "proto/ranks/agreement.hpp"

#include <algorithm>
#include <new>
#include <optional>
#include <string>

namespace strake {

void on_all_ranks(Communicator& ranks, const std::function<void()>& todo) {
  std::optional<Error> own = error_of(todo);
  if (!ranks.any(own.has_value())) return;
  if (own && own->where().empty()) own = of_rank(ranks.rank(), *own);
  const std::vector<Bytes> all = ranks.gather(packed(own));
  throw unpacked(*std::ranges::find_if(all, [](const Bytes& bytes) { return !bytes.empty(); }));
}

void on_first_rank(Communicator& ranks, const std::function<void()>& todo) {
  on_all_ranks(ranks, [&] {
    if (ranks.rank() == 0) todo();
  });
}

std::vector<FilePart> parts_of_all(Communicator& ranks, const FilePart& own) {
  Bytes bytes;
  append(bytes, own.length);
  append(bytes, own.bytes);
  append_text(bytes, own.file);
  std::vector<FilePart> parts;
  for (const Bytes& one : ranks.gather(bytes)) {
    const std::byte* at = one.data();
    FilePart& part = parts.emplace_back();
    part.length = take<std::int64_t>(at);
    part.bytes = take<std::int64_t>(at);
    part.file = take_text(at);
  }
  return parts;
}

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

Error of_rank(int rank, const Error& error) {
  const std::string name = "rank " + std::to_string(rank);
  return {error.code(), error.where().empty() ? name : name + ", " + error.where(), error.problem(),
          error.fix()};
}

void append_text(Bytes& bytes, const std::string& text) {
  append(bytes, text.size());
  const auto* const from = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), from, from + text.size());
}

std::string take_text(const std::byte*& at) {
  const auto size = take<std::size_t>(at);
  std::string text(reinterpret_cast<const char*>(at), size);
  at += size;
  return text;
}

Bytes packed(const std::optional<Error>& error) {
  Bytes bytes;
  if (!error) return bytes;
  append(bytes, error->code());
  for (const std::string* text : {&error->where(), &error->problem(), &error->fix()})
    append_text(bytes, *text);
  return bytes;
}

Error unpacked(const Bytes& bytes) {
  const std::byte* at = bytes.data();
  const auto code = take<ExitCode>(at);
  const std::string where = take_text(at), problem = take_text(at), fix = take_text(at);
  return {code, where, problem, fix};
}

}  // namespace strake
