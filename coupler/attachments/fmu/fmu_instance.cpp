#include "coupler/attachments/fmu/fmu_instance.hpp"

#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <dlfcn.h>
#include <type_traits>
#include <utility>

namespace strake {
namespace {

constexpr std::size_t kept_messages = 5, longest_message = 400;  // [bytes]
constexpr double same_time = 1e-9;                               // of a step

void on_message(fmi3InstanceEnvironment log, fmi3Status status, fmi3String category, fmi3String message) {
  if (log != nullptr) static_cast<FmuLog*>(log)->add(status, category, message);
}

const char* word_of(fmi3Status status) {
  constexpr std::array words = {"OK", "Warning", "Discard", "Error", "Fatal"};
  const auto k = static_cast<std::size_t>(status);
  return k < words.size() ? words[k] : "a status that FMI 3.0 does not know";
}

}  // namespace

bool takes_number(const std::string& type) {
  for (const char* known : {"Float64", "Float32", "Int32", "Int64", "Enumeration", "Boolean"})
    if (type == known) return true;
  return false;
}

/// Called from C, so it throws nothing; a message for which there is no memory is lost.
void FmuLog::add(fmi3Status status, fmi3String category, fmi3String message) noexcept {
  try {
    std::string text = message != nullptr ? message : "";
    if (text.size() > longest_message) text = text.substr(0, longest_message) + " …";
    lines_.push_back(
        visible(fmt::format("{} ({}): {}", word_of(status), category != nullptr ? category : "", text), ""));
    if (lines_.size() > kept_messages) lines_.pop_front();
  } catch (...) {
  }
}

std::string FmuLog::lines() const {
  std::string text;
  for (const std::string& line : lines_) text += "\n" + line;
  return text;
}

std::string FmuLog::last() const {
  return lines_.empty() ? std::string() : lines_.back();
}

FmuInstance::FmuInstance(const ModelDescription& model, const FmuPackage& package, std::string name)
    : name_(std::move(name)) {
  load(model, package);
  const std::string resources = package.resources();
  instance_ = f_.fmi3InstantiateCoSimulation(name_.c_str(), model.instantiation_token.c_str(),
                                             resources.empty() ? nullptr : resources.c_str(), false, true,
                                             false, false, nullptr, 0, &log_, on_message, nullptr);
  if (instance_ != nullptr) return;
  dlclose(library_);  // no destructor runs
  throw Error(
      ExitCode::solver_fault, name_,
      fmt::format("the FMU {} made no instance of its model{}", package.file().string(), log_.lines()),
      log_.lines().empty() ? "try it in another program: it gives no reason" : "");
}

FmuInstance::~FmuInstance() {
  if (health_ == Health::lost) return;  // the library stays loaded: nothing of it may be called
  if (kept_ != nullptr) f_.fmi3FreeFMUState(instance_, &kept_);
  if (health_ == Health::usable && in_step_mode_) f_.fmi3Terminate(instance_);
  f_.fmi3FreeInstance(instance_);
  dlclose(library_);
}

void FmuInstance::load(const ModelDescription& model, const FmuPackage& package) {
  const std::string file = package.file().string(), library = package.library(model.model_identifier);
  library_ = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library_ == nullptr) {
    const char* reason = dlerror();
    throw Error(ExitCode::case_file, file,
                fmt::format("its library cannot be loaded\n{}", reason != nullptr ? reason : library),
                "it must find all libraries that it was linked with; TMPDIR names a folder whose files may "
                "be executed");
  }
  std::vector<std::string> missing;
  const auto take = [&](const char* function, auto& to) {
    to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(dlsym(library_, function));
    if (to == nullptr) missing.emplace_back(function);
  };
  const auto take_setter = [&](const char* type, const char* function, auto& to) {
    const auto is_one = [&](const FmuVariable& variable) { return variable.type == type; };
    if (std::any_of(model.variables.begin(), model.variables.end(), is_one)) take(function, to);
  };
  take("fmi3InstantiateCoSimulation", f_.fmi3InstantiateCoSimulation);
  take("fmi3FreeInstance", f_.fmi3FreeInstance);
  take("fmi3EnterInitializationMode", f_.fmi3EnterInitializationMode);
  take("fmi3ExitInitializationMode", f_.fmi3ExitInitializationMode);
  take("fmi3Terminate", f_.fmi3Terminate);
  take("fmi3DoStep", f_.fmi3DoStep);
  take("fmi3SetFloat64", f_.fmi3SetFloat64);
  take("fmi3GetFloat64", f_.fmi3GetFloat64);
  take_setter("Float32", "fmi3SetFloat32", f_.fmi3SetFloat32);
  take_setter("Int32", "fmi3SetInt32", f_.fmi3SetInt32);
  take_setter("Int64", "fmi3SetInt64", f_.fmi3SetInt64);
  take_setter("Enumeration", "fmi3SetInt64", f_.fmi3SetInt64);
  take_setter("Boolean", "fmi3SetBoolean", f_.fmi3SetBoolean);
  if (model.can_get_and_set_state) {
    take("fmi3GetFMUState", f_.fmi3GetFMUState);
    take("fmi3SetFMUState", f_.fmi3SetFMUState);
    take("fmi3FreeFMUState", f_.fmi3FreeFMUState);
  }
  if (model.can_serialize_state) {
    take("fmi3SerializedFMUStateSize", f_.fmi3SerializedFMUStateSize);
    take("fmi3SerializeFMUState", f_.fmi3SerializeFMUState);
    take("fmi3DeserializeFMUState", f_.fmi3DeserializeFMUState);
  }
  if (missing.empty()) return;
  dlclose(library_);
  throw Error(ExitCode::case_file, file,
              "its library lacks functions that FMI 3.0 demands: " + joined(missing),
              "ask its exporter: the library does not fit to modelDescription.xml");
}

void FmuInstance::fail(const std::string& problem) {
  if (health_ == Health::usable) health_ = Health::failed;
  throw Error(ExitCode::solver_fault, fmt::format("{}, t = {:.9g} s", name_, time_), problem + log_.lines());
}

void FmuInstance::check(fmi3Status status, const char* function, OnDiscard on_discard) {
  if (status == fmi3OK) return;
  if (status == fmi3Warning) {
    if (warned_.insert(function).second)
      spdlog::warn(fmt::format("{}, t = {:.9g} s: the FMU warns in {}, said once{}", name_, time_, function,
                               log_.lines()));
    return;
  }
  if (status == fmi3Discard && on_discard == OnDiscard::retry && in_step_mode_)
    throw FmuDiscarded{
        fmt::format("the FMU discards {}{}{}", function, log_.last().empty() ? "" : ": ", log_.last())};
  if (status != fmi3Error && status != fmi3Discard) health_ = Health::lost;
  fail(fmt::format("the FMU fails: {} returns {}", function, word_of(status)));
}

void FmuInstance::set_parameter(const FmuVariable& variable, double value) {
  const auto one = [&](auto function, const char* name, auto number) {
    log_.clear();
    check(function(instance_, &variable.reference, 1, &number, 1), name);
  };
  if (variable.type == "Float64") one(f_.fmi3SetFloat64, "fmi3SetFloat64", value);
  if (variable.type == "Float32") one(f_.fmi3SetFloat32, "fmi3SetFloat32", static_cast<fmi3Float32>(value));
  if (variable.type == "Int32") one(f_.fmi3SetInt32, "fmi3SetInt32", static_cast<fmi3Int32>(value));
  if (variable.type == "Int64" || variable.type == "Enumeration")
    one(f_.fmi3SetInt64, "fmi3SetInt64", static_cast<fmi3Int64>(value));
  if (variable.type == "Boolean") one(f_.fmi3SetBoolean, "fmi3SetBoolean", value != 0);
}

void FmuInstance::enter_initialization(double start_time) {
  time_ = start_time;
  log_.clear();
  check(f_.fmi3EnterInitializationMode(instance_, false, 0, start_time, false, 0),
        "fmi3EnterInitializationMode");
}

void FmuInstance::exit_initialization() {
  log_.clear();
  check(f_.fmi3ExitInitializationMode(instance_), "fmi3ExitInitializationMode");
  in_step_mode_ = true;
}

void FmuInstance::set(const std::vector<fmi3ValueReference>& references, const std::vector<double>& values) {
  if (references.empty()) return;
  log_.clear();
  check(f_.fmi3SetFloat64(instance_, references.data(), references.size(), values.data(), values.size()),
        "fmi3SetFloat64", OnDiscard::retry);
}

std::vector<double> FmuInstance::get(const std::vector<fmi3ValueReference>& references) {
  std::vector<double> values(references.size());
  log_.clear();
  check(f_.fmi3GetFloat64(instance_, references.data(), references.size(), values.data(), values.size()),
        "fmi3GetFloat64", OnDiscard::retry);
  return values;
}

void FmuInstance::step(double t, double dt) {
  fmi3Boolean event = false, ends = false, early = false;
  fmi3Float64 reached = t;
  time_ = t;
  log_.clear();
  check(f_.fmi3DoStep(instance_, t, dt, false, &event, &ends, &early, &reached), "fmi3DoStep",
        OnDiscard::retry);
  if (ends) fail("the FMU ends the simulation (terminateSimulation)");
  if (early && !(std::abs(reached - (t + dt)) <= same_time * dt))
    fail(fmt::format("the FMU returned early, at t = {:.9g} s of {:.9g} s, which it was not allowed to",
                     reached, t + dt));
  time_ = t + dt;
}

void FmuInstance::keep_state() {
  log_.clear();
  check(f_.fmi3GetFMUState(instance_, &kept_), "fmi3GetFMUState");
}

void FmuInstance::restore_state() {
  log_.clear();
  check(f_.fmi3SetFMUState(instance_, kept_), "fmi3SetFMUState");
}

std::vector<fmi3Byte> FmuInstance::serialized() {
  std::size_t size = 0;
  log_.clear();
  check(f_.fmi3SerializedFMUStateSize(instance_, kept_, &size), "fmi3SerializedFMUStateSize");
  std::vector<fmi3Byte> bytes(size);
  check(f_.fmi3SerializeFMUState(instance_, kept_, bytes.data(), size), "fmi3SerializeFMUState");
  return bytes;
}

void FmuInstance::deserialize(const std::vector<fmi3Byte>& bytes) {
  fmi3FMUState state = nullptr;
  log_.clear();
  check(f_.fmi3DeserializeFMUState(instance_, bytes.data(), bytes.size(), &state), "fmi3DeserializeFMUState");
  std::swap(kept_, state);
  if (state != nullptr) check(f_.fmi3FreeFMUState(instance_, &state), "fmi3FreeFMUState");
  restore_state();
}

}  // namespace strake
