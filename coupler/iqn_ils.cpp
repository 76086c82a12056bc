#include "coupler/iqn_ils.hpp"

namespace strake {

void IqnIls::start_window() {
  Accelerator::start_window();
  // Windows without columns (converged at once) leave no entry, so quiet spells do not wear the memory out.
  state_.secants.start_window(parameters_.reused_windows);
}

}  // namespace strake
