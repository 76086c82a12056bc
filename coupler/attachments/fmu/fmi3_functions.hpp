#pragma once
// The part of FMI 3.0's interface in C that a co-simulation needs, with the standard's names. Source:
// Modelica Association, Functional Mock-up Interface Specification 3.0, sections 2.2, 2.3 and 4.2. Its header
// files are not in Debian; what stands here follows the text.

#include <cstddef>
#include <cstdint>

namespace strake {

using fmi3Instance = void*;             // one model in computation
using fmi3InstanceEnvironment = void*;  // what the FMU hands back to logMessage
using fmi3FMUState = void*;             // a state that the FMU keeps
using fmi3ValueReference = std::uint32_t;
using fmi3Float32 = float;
using fmi3Float64 = double;
using fmi3Int32 = std::int32_t;
using fmi3Int64 = std::int64_t;
using fmi3Boolean = bool;
using fmi3Byte = std::uint8_t;
using fmi3String = const char*;

/// What a call came to.
enum fmi3Status : int {
  fmi3OK,
  fmi3Warning,  // done, but look at the log
  fmi3Discard,  // not done; other values or a shorter step may succeed
  fmi3Error,    // not done; the instance may only be freed
  fmi3Fatal,    // no function of the library may be called any more
};

using fmi3LogMessageCallback = void (*)(fmi3InstanceEnvironment, fmi3Status, fmi3String category,
                                        fmi3String message);
/// Never called, as no intermediate variables are requested.
using fmi3IntermediateUpdateCallback = void (*)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean,
                                                fmi3Boolean, fmi3Boolean, fmi3Boolean, fmi3Boolean*,
                                                fmi3Float64*);

template <class Value>
using fmi3Set = fmi3Status (*)(fmi3Instance, const fmi3ValueReference*, std::size_t n_references,
                               const Value*, std::size_t n_values);
template <class Value>
using fmi3Get = fmi3Status (*)(fmi3Instance, const fmi3ValueReference*, std::size_t n_references, Value*,
                               std::size_t n_values);

/// The functions of one library, found by these names.
struct Fmi3Functions {
  fmi3Instance (*fmi3InstantiateCoSimulation)(
      fmi3String instance_name, fmi3String instantiation_token, fmi3String resource_path, fmi3Boolean visible,
      fmi3Boolean logging_on, fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed,
      const fmi3ValueReference* intermediate_variables, std::size_t n_intermediate_variables,
      fmi3InstanceEnvironment, fmi3LogMessageCallback, fmi3IntermediateUpdateCallback) = nullptr;
  void (*fmi3FreeInstance)(fmi3Instance) = nullptr;
  fmi3Status (*fmi3EnterInitializationMode)(fmi3Instance, fmi3Boolean tolerance_defined,
                                            fmi3Float64 tolerance, fmi3Float64 start_time,
                                            fmi3Boolean stop_time_defined, fmi3Float64 stop_time) = nullptr;
  fmi3Status (*fmi3ExitInitializationMode)(fmi3Instance) = nullptr;
  fmi3Status (*fmi3Terminate)(fmi3Instance) = nullptr;
  fmi3Status (*fmi3DoStep)(fmi3Instance, fmi3Float64 current_communication_point,
                           fmi3Float64 communication_step_size, fmi3Boolean no_state_before_is_set,
                           fmi3Boolean* event_handling_needed, fmi3Boolean* terminate_simulation,
                           fmi3Boolean* early_return, fmi3Float64* last_successful_time) = nullptr;

  fmi3Set<fmi3Float64> fmi3SetFloat64 = nullptr;
  fmi3Get<fmi3Float64> fmi3GetFloat64 = nullptr;
  fmi3Set<fmi3Float32> fmi3SetFloat32 = nullptr;
  fmi3Set<fmi3Int32> fmi3SetInt32 = nullptr;
  fmi3Set<fmi3Int64> fmi3SetInt64 = nullptr;
  fmi3Set<fmi3Boolean> fmi3SetBoolean = nullptr;

  // Of FMUs with canGetAndSetFMUState.
  fmi3Status (*fmi3GetFMUState)(fmi3Instance, fmi3FMUState*) = nullptr;
  fmi3Status (*fmi3SetFMUState)(fmi3Instance, fmi3FMUState) = nullptr;
  fmi3Status (*fmi3FreeFMUState)(fmi3Instance, fmi3FMUState*) = nullptr;
  // Of FMUs with canSerializeFMUState.
  fmi3Status (*fmi3SerializedFMUStateSize)(fmi3Instance, fmi3FMUState, std::size_t*) = nullptr;
  fmi3Status (*fmi3SerializeFMUState)(fmi3Instance, fmi3FMUState, fmi3Byte*, std::size_t) = nullptr;
  fmi3Status (*fmi3DeserializeFMUState)(fmi3Instance, const fmi3Byte*, std::size_t, fmi3FMUState*) = nullptr;
};

}  // namespace strake
