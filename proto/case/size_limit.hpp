#pragma once

#include <string>
#include <vector>

namespace strake {

class CaseFile;

/// A number of items that a case makes, estimated from its keys before anything is built.
struct SizeEstimate {
  /// A key that the number follows from: count ~ value^power.
  struct Key {
    std::string path;  // "fluid.spacing"
    double value = 0, power = 1;
  };
  std::string what;            // "water particles"
  double count = 0;            // no integer: it may be too large for one
  double bytes_each = 0;       // of memory, while they are built and used
  double seconds_each = 0;     // to build one on one core; of a check's work
  std::vector<Key> keys = {};  // the likeliest slip first
  std::string remedy = {};     // what else makes fewer
};
using SizeEstimates = std::vector<SizeEstimate>;

/// Memory of all items [bytes], and the time that one process takes to build them [s].
double memory_of(const SizeEstimates&);
double seconds_of(const SizeEstimates&);

/// Memory that one program of a run may take [bytes]: four fifths of what this machine has.
double usable_memory();

/// True if a case is too large to build for `strake check`. It takes too much memory, or `times` its building
/// time is too long.
bool is_large(const SizeEstimates&, double times = 1);

/// What makes fewer of the items that take most memory, "a smaller structure.fem.refinement"; empty where
/// their estimate names nothing.
std::string remedy_of(const SizeEstimates&);

/// "60 MB", "3.2 GB", "4e3 GB".
std::string memory_text(double bytes);

/// "about 10 000 water particles, 4 000 wall particles: 60 MB".
std::string size_text(const SizeEstimates&);

/// How lines of a program's --check begin: the size, and that it was not built for its size.
inline constexpr const char *size_words = "size   ", *not_built_words = "not built   ";

/// Refuses a case that is too large. Either the items of a kind are more than their numbers can count, or all
/// items together need more memory than `most` bytes. The error names the key that makes most of them, and
/// values that would fit.
void refuse_oversized(const CaseFile&, const SizeEstimates&, double most = usable_memory());

}  // namespace strake
