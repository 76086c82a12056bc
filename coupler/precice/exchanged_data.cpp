#include "coupler/precice/exchanged_data.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake {
namespace {

/// True if the vertices are 0, 1, … n − 1: the usual case, in which nothing need be looked up.
bool are_all(std::span<const int> ids, int n) {
  if (static_cast<int>(ids.size()) != n) return false;
  for (int i = 0; i < n; ++i)
    if (ids[static_cast<std::size_t>(i)] != i) return false;
  return true;
}

}  // namespace

ExchangedData::Entry ExchangedData::entry(const PreciceConfig& config, const PreciceConfig::MeshData& id,
                                          const QuantityNames& names) const {
  const PreciceConfig::Data& data = *config.find_data(id.data);
  const int dimension = config.find_mesh(id.mesh)->dimension;
  Entry entry{.mesh = id.mesh,
              .data = id.data,
              .quantity = names.of(id.data, config.conservative(id)),
              .components = data.vector ? dimension : 1,
              .value = {},
              .given = {},
              .waveform = Waveform(data.waveform_degree)};
  const int needed = entry.quantity.components;
  if (needed != 0 && (needed == 1) == data.vector)
    throw Error(
        ExitCode::case_file, config.file.string(),
        fmt::format("{} is a {}, and Strake's {} is a {}", entry.text(), data.vector ? "vector" : "scalar",
                    entry.quantity.name, data.vector ? "scalar" : "vector"),
        fmt::format("give it a name of its own: STRAKE_PRECICE_NAMES=\"{}=my-{}\"", id.data, id.data));
  if (needed == 0) entry.quantity.components = entry.components;
  return entry;
}

ExchangedData::ExchangedData(const PreciceConfig& config, const PreciceConfig::Participant& participant,
                             const QuantityNames& names) {
  for (const auto& id : participant.writes) written_.push_back(entry(config, id, names));
  for (const auto& id : participant.reads) read_.push_back(entry(config, id, names));
  for (const std::string& mesh : participant.provided)
    for (const auto* list : {&written_, &read_})
      if (std::any_of(list->begin(), list->end(), [&](const Entry& one) { return one.mesh == mesh; }) &&
          (places_.empty() || places_.back().mesh != mesh))
        places_.push_back({mesh});
  check_quantities(config, written_, "writes");
  check_quantities(config, read_, "reads");
}

/// The coupler knows fields by their quantities: each stands on one mesh.
void ExchangedData::check_quantities(const PreciceConfig& config, const std::vector<Entry>& entries,
                                     const char* verb) const {
  if (places_.size() < 2) return;
  for (std::size_t i = 0; i < entries.size(); ++i)
    for (std::size_t k = i + 1; k < entries.size(); ++k)
      if (entries[i].quantity.name == entries[k].quantity.name)
        throw Error(ExitCode::case_file, config.file.string(),
                    fmt::format("a participant {} {} and {}: both are {}", verb, entries[i].text(),
                                entries[k].text(), entries[i].quantity.name),
                    "each quantity on one mesh; STRAKE_PRECICE_NAMES gives data names of their own");
}

std::vector<std::string> ExchangedData::meshes() const {
  std::vector<std::string> names;
  for (const Place& place : places_) names.push_back(place.mesh);
  return names;
}

std::map<std::string, std::string> ExchangedData::mesh_of(const std::vector<Entry>& entries) {
  std::map<std::string, std::string> meshes;
  for (const Entry& entry : entries) meshes[entry.quantity.name] = entry.mesh;
  return meshes;
}

const ExchangedData::Place& ExchangedData::place_of(const Entry& entry) const {
  return *std::find_if(places_.begin(), places_.end(),
                       [&](const Place& place) { return place.mesh == entry.mesh; });
}

void ExchangedData::resize(const std::string& mesh, int n_points) {
  int first = 0;
  for (Place& place : places_) {
    place.first = first;
    if (place.mesh == mesh && place.points != n_points) {
      place.points = n_points;
      for (Entry& entry : written_) {
        if (entry.mesh != mesh) continue;
        const Eigen::MatrixXd before = std::move(entry.value);
        entry.value = Eigen::MatrixXd::Zero(entry.quantity.components, n_points);
        if (before.cols() > 0 && before.cols() <= n_points) entry.value.leftCols(before.cols()) = before;
        entry.given.resize(static_cast<std::size_t>(n_points), false);
      }
    }
    first += place.points;
  }
}

const ExchangedData::Entry* ExchangedData::find(const std::vector<Entry>& entries, const std::string& mesh,
                                                const std::string& data) const {
  for (const Entry& entry : entries)
    if (entry.mesh == mesh && entry.data == data) return &entry;
  return nullptr;
}

bool ExchangedData::writes(const std::string& mesh, const std::string& data) const {
  return find(written_, mesh, data) != nullptr;
}
bool ExchangedData::reads(const std::string& mesh, const std::string& data) const {
  return find(read_, mesh, data) != nullptr;
}

std::string ExchangedData::listed(const std::vector<Entry>& entries) const {
  std::string text;
  for (const Entry& entry : entries) text += (text.empty() ? "" : ", ") + entry.text();
  return text.empty() ? "none" : text;
}

void ExchangedData::check_sizes(const Entry& entry, std::size_t ids, std::size_t values) const {
  const auto components = static_cast<std::size_t>(entry.components);
  if (values != ids * components)
    throw Error(ExitCode::solver_fault, entry.text(),
                fmt::format("came with {} vertices and {} numbers", ids, values),
                fmt::format("{} numbers: {} for each vertex", ids * components, components));
}

void ExchangedData::write(const std::string& mesh, const std::string& data, std::span<const int> ids,
                          std::span<const double> values) {
  const Entry* found = find(written_, mesh, data);
  if (!found)
    throw Error(ExitCode::solver_fault, fmt::format("data \"{}\" of mesh \"{}\"", data, mesh),
                "is not written by this participant", "it writes " + listed(written_));
  check_sizes(*found, ids.size(), values.size());
  Entry& entry = written_[static_cast<std::size_t>(found - written_.data())];
  const auto k = static_cast<std::size_t>(entry.components);
  if (!all_finite(
          Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())))) {
    const auto first = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
    throw Error(ExitCode::solver_fault, entry.text(),
                fmt::format("is {} at vertex {}, which is not finite", *first,
                            ids[static_cast<std::size_t>(first - values.begin()) / k]),
                "");
  }
  const int n_points = place_of(entry).points;
  const bool all = are_all(ids, n_points);
  const bool whole = entry.components == entry.quantity.components;
  if (all && whole) entry.value.resize(entry.components, n_points);
  if (entry.value.size() == 0) entry.value = Eigen::MatrixXd::Zero(entry.quantity.components, n_points);
  entry.given.resize(static_cast<std::size_t>(n_points), false);
  if (all) entry.given.assign(static_cast<std::size_t>(n_points), true);
  for (const int id : all ? std::span<const int>() : ids) entry.given[static_cast<std::size_t>(id)] = true;
  if (all && whole) {
    std::copy(values.begin(), values.end(), entry.value.data());
    return;
  }
  if (all && k == 2 && entry.value.rows() == 3) {
    entry.value.topRows<2>() = Eigen::Map<const Eigen::Matrix2Xd>(values.data(), 2, n_points);
    return;
  }
  for (std::size_t i = 0; i < ids.size(); ++i) std::copy_n(&values[i * k], k, entry.value.col(ids[i]).data());
}

void ExchangedData::read(const std::string& mesh, const std::string& data, std::span<const int> ids,
                         double time, std::span<double> values) const {
  const Entry* entry = find(read_, mesh, data);
  if (!entry)
    throw Error(ExitCode::solver_fault, fmt::format("data \"{}\" of mesh \"{}\"", data, mesh),
                "is not read by this participant", "it reads " + listed(read_));
  check_sizes(*entry, ids.size(), values.size());
  was_read_ = true;
  latest_read_ = std::max(latest_read_.value_or(time), time);
  if (ids.empty()) return;
  if (entry->waveform.empty()) throw Error(ExitCode::solver_fault, entry->text(), "has no values yet", "");
  const Values now = entry->waveform.at(time);
  const auto k = static_cast<std::size_t>(entry->components);
  if (now.rows() == entry->components && are_all(ids, place_of(*entry).points)) {
    std::copy_n(now.data(), values.size(), values.data());
    return;
  }
  if (k == 2 && now.rows() == 3 && are_all(ids, place_of(*entry).points)) {  // by far the most frequent
    Eigen::Map<Eigen::Matrix2Xd>(values.data(), 2, now.cols()) = now.topRows<2>();
    return;
  }
  // In two dimensions the third component of the partner's vectors is zero and is left out.
  const auto rows = static_cast<std::size_t>(now.rows());
  for (std::size_t i = 0; i < ids.size(); ++i)
    std::copy_n(now.data() + static_cast<std::size_t>(ids[i]) * rows, k, &values[i * k]);
}

void ExchangedData::check_written(const Entry& entry) const {
  const std::vector<bool>& given = entry.given;
  const auto missing = static_cast<std::size_t>(std::count(given.begin(), given.end(), false));
  if (!given.empty() && (missing == 0 || (entry.quantity.conservative && missing < given.size()))) return;
  if (given.empty() || missing == given.size())
    throw Error(ExitCode::solver_fault, entry.text(), "was not written before this advance()",
                "call writeData() for it before each advance(), also where the values are 0;\n"
                "a solver that has no such data: take their <write-data> out of the configuration");
  throw Error(
      ExitCode::solver_fault, entry.text(),
      fmt::format("was written before this advance() at {} of {} vertices; vertex {} has no value",
                  given.size() - missing, given.size(),
                  std::find(given.begin(), given.end(), false) - given.begin()),
      "call writeData() for all vertices of the mesh before each advance(), with 0 where nothing moves");
}

void ExchangedData::check_written() const {
  for (const Entry& entry : written_) check_written(entry);
}

void ExchangedData::check_read() const {
  if (was_read_ || read_.empty()) return;
  throw Error(ExitCode::solver_fault, listed(read_),
              "was not read so far: the partner has no effect on this solver",
              "call readData() before each time step;\n"
              "a solver that needs no such data: take their <read-data> out of the configuration");
}

bool ExchangedData::read_start_alone(double start, double round_off) const {
  return latest_read_ && *latest_read_ <= start + round_off;
}

std::vector<Field> ExchangedData::take_fields() {
  std::vector<Field> fields;
  for (Entry& entry : written_) {
    const Place& place = place_of(entry);
    Eigen::MatrixXd value = std::exchange(entry.value, {});
    entry.given.clear();
    if (value.size() == 0) value = Eigen::MatrixXd::Zero(entry.quantity.components, place.points);
    if (place.points < all_points()) {
      const Eigen::MatrixXd own = std::move(value);
      value = Eigen::MatrixXd::Zero(entry.quantity.components, all_points());
      value.middleCols(place.first, place.points) = own;
    }
    fields.push_back(
        {entry.quantity.name, entry.quantity.unit, entry.quantity.conservative, std::move(value)});
  }
  return fields;
}

void ExchangedData::check_components(const Entry& entry, const Field& field, int points) const {
  if (field.value.rows() != entry.quantity.components || field.value.cols() != points)
    throw Error(ExitCode::case_file, entry.text(),
                fmt::format("is the partner's {}, which has {} components at {} points; expected {} at {}",
                            field.quantity, field.value.rows(), field.value.cols(), entry.quantity.components,
                            points),
                "both participants must mean the same by it");
}

Values ExchangedData::from_partner(const Entry& entry, const Field& field) const {
  check_components(entry, field, all_points());
  const Place& place = place_of(entry);
  if (place.points == all_points()) return field.value;
  return Eigen::MatrixXd(field.value.middleCols(place.first, place.points));
}

void ExchangedData::begin(const InterfaceMesh& partner, const std::vector<Field>& fields,
                          const std::vector<InterfaceMesh>& own) {
  const Points& theirs = partner.position;
  for (const InterfaceMesh& mesh : own) {
    const Points& ours = mesh.position;
    const double same = 1e-9 * (1 + ours.cwiseAbs().maxCoeff());  // [m]
    if (theirs.cols() != ours.cols() || (theirs - ours).cwiseAbs().maxCoeff() > same) continue;
    for (Entry& entry : read_) {
      const Field* field = entry.mesh == mesh.name ? strake::find(fields, entry.quantity.name) : nullptr;
      if (!field) continue;
      check_components(entry, *field, static_cast<int>(ours.cols()));
      entry.waveform.begin(0, field->value);
    }
  }
}

void ExchangedData::receive(const Window& window, const Input& input) {
  latest_read_.reset();
  for (Entry& entry : read_) {
    std::vector<Waveform::Knot> knots;
    for (const Sample& sample : input.samples) {
      const Field* field = strake::find(sample.fields, entry.quantity.name);
      if (!field) {
        std::string sent;
        for (const Field& other : sample.fields) sent += (sent.empty() ? "" : ", ") + other.quantity;
        throw Error(
            ExitCode::case_file, entry.text(),
            fmt::format("is not sent by the partner (looked for {}); it sends {}", entry.quantity.name,
                        sent.empty() ? "nothing" : sent),
            fmt::format("say in the case which it is: precice_names = [\"{}={}\"]; or by "
                        "STRAKE_PRECICE_NAMES",
                        entry.data, sample.fields.empty() ? "quantity" : sample.fields.front().quantity));
      }
      knots.push_back({sample.time, from_partner(entry, *field)});
    }
    if (knots.size() == 1) knots.front().time = window.t + window.dt;
    if (knots.empty()) throw Error(ExitCode::case_file, entry.text(), "has no partner in this run", "");
    entry.waveform.set_window(window.t, std::move(knots));
  }
}

void ExchangedData::commit() {
  for (Entry& entry : read_) entry.waveform.commit();
}

namespace {

/// Lagrange's polynomial through `count` knots from `first` on.
Values polynomial(const std::vector<Waveform::Knot>& knots, std::size_t first, std::size_t count,
                  double time) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(knots[first].value.rows(), knots[first].value.cols());
  for (std::size_t i = first; i < first + count; ++i) {
    double weight = 1;
    for (std::size_t j = first; j < first + count; ++j)
      if (j != i) weight *= (time - knots[j].time) / (knots[i].time - knots[j].time);
    sum += weight * knots[i].value;
  }
  return sum;
}

}  // namespace

void Waveform::begin(double time, Values value) {
  start_ = {time, std::move(value)};
}

void Waveform::set_window(double start, std::vector<Knot> samples) {
  start_.time = start;
  const Knot& last = samples.back();
  if (start_.value.cols() != last.value.cols() || start_.value.rows() != last.value.rows())
    start_.value = Values(Eigen::MatrixXd(Eigen::MatrixXd::Zero(last.value.rows(), last.value.cols())));
  const double same = 1e-9 * (last.time - start);
  knots_.clear();
  if (samples.front().time > start + same) knots_.push_back(start_);
  for (Knot& sample : samples) knots_.push_back(std::move(sample));
}

void Waveform::commit() {
  if (!knots_.empty()) start_ = knots_.back();
}

Values Waveform::at(double time) const {
  const Knot& last = knots_.back();
  const double same = 1e-9 * (last.time - start_.time);
  if (std::abs(time - last.time) <= same || knots_.size() == 1) return last.value;
  if (degree_ == 0) {  // constant up to each sample; at the start what held there
    const auto upto = std::find_if(knots_.begin(), knots_.end(),
                                   [&](const Knot& knot) { return knot.time >= time - same; });
    return upto == knots_.end() ? last.value : upto->value;
  }
  const auto after =
      std::find_if(knots_.begin(), knots_.end(), [&](const Knot& knot) { return knot.time > time + same; });
  const auto next =
      static_cast<std::size_t>(after - knots_.begin());  // at least 1 where the window has begun
  const std::size_t count = std::min(static_cast<std::size_t>(degree_) + 1, knots_.size());
  const std::size_t before = next < (count + 1) / 2 ? 0 : next - (count + 1) / 2;
  return polynomial(knots_, std::min(before, knots_.size() - count), count, time);
}

}  // namespace strake
