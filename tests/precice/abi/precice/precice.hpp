#pragma once
// Names of preCICE 3.0 as a program compiled long ago knows them, and with STRAKE_NAMES_OF = 302 those that 3.2
// added. Not Strake's header: it shows that names and layouts of the library are those of such a program.

#include <cstddef>
#include <string>
#include <vector>

namespace precice {

template <class T, std::size_t N = static_cast<std::size_t>(-1)>
class span {
 public:
  span(T* first, std::size_t size) : first_(first), size_(size) {}
  template <class Owner>
  span(Owner& owner) : first_(owner.data()), size_(owner.size()) {}
  span(const char* text) : first_(text), size_(std::char_traits<char>::length(text)) {}

 private:
  T* first_;
  std::size_t size_;
};
using text = span<const char>;

class Participant {
 public:
  Participant(text name, text configuration, int rank, int ranks);
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;
  ~Participant();
  void initialize();
  void advance(double time_step);
  void finalize();
  bool isCouplingOngoing() const;
  double getMaxTimeStepSize() const;
  bool requiresWritingCheckpoint();
  bool requiresReadingCheckpoint();
  void setMeshVertices(text mesh, span<const double> positions, span<int> ids);
  void writeData(text mesh, text data, span<const int> ids, span<const double> values);
  void readData(text mesh, text data, span<const int> ids, double time, span<double> values) const;
#if STRAKE_NAMES_OF >= 302
  void startProfilingSection(text name);
  void stopLastProfilingSection();
#endif

 private:
  void* made_;  // a std::unique_ptr: one pointer
};

}  // namespace precice
