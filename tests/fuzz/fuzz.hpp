#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// A fuzz target: libFuzzer calls it with bytes of its making, the replay with those of the corpus. It must
/// return, whatever the bytes are; a crash, a leak or an abort is a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Well-formed inputs to start from.
std::vector<std::string> seeds();
