// precice::Participant: data on the mesh.

#include "coupler/precice/guarded_call.hpp"

#include <fmt/format.h>
#include <precice/Participant.hpp>

namespace precice {
namespace {

using strake::Error;
using strake::ExitCode;
using strake::guarded_call;
using strake::SolverRun;
using strake::text_of;

/// The mesh is the solver's own and has all these vertices.
void check_vertices(const SolverRun& run, const std::string& mesh, span<const VertexID> ids) {
  const strake::SolverMesh& own = run.mesh(mesh);
  if (const int* invalid = own.find_invalid({ids.data(), ids.size()}))
    throw Error(ExitCode::solver_fault, fmt::format("mesh \"{}\"", mesh),
                fmt::format("has no vertex {}", *invalid),
                own.size() == 0 ? "set the vertices first"
                                : fmt::format("vertices are numbered from 0 to {}", own.size() - 1));
}

constexpr const char* no_mapping_in_between = "Strake maps between two meshes that stay";
constexpr const char* set_the_mesh = "set the mesh before initialize() and use readData() and writeData()";

}  // namespace

void Participant::writeData(string_view mesh, string_view data, span<const VertexID> ids,
                            span<const double> values) {
  guarded_call("writeData()", &impl_->run, [&] {
    SolverRun& run = impl_->run;
    strake::not_finished(run);
    if (run.initialized()) strake::in_coupling(run);
    check_vertices(run, text_of(mesh), ids);
    run.fit_data();
    run.data().write(text_of(mesh), text_of(data), {ids.data(), ids.size()}, {values.data(), values.size()});
  });
}

void Participant::readData(string_view mesh, string_view data, span<const VertexID> ids, double relative_time,
                           span<double> values) const {
  guarded_call("readData()", &impl_->run, [&] {
    const SolverRun& run = impl_->run;
    strake::initialized(run);
    check_vertices(run, text_of(mesh), ids);
    run.check_time(relative_time);
    run.data().read(text_of(mesh), text_of(data), {ids.data(), ids.size()}, run.now() + relative_time,
                    {values.data(), values.size()});
  });
}

void Participant::writeAndMapData(string_view, string_view, span<const double>, span<const double>) {
  guarded_call("writeAndMapData()", &impl_->run,
               [&] { strake::refuse_function(no_mapping_in_between, set_the_mesh); });
}

void Participant::mapAndReadData(string_view, string_view, span<const double>, double, span<double>) const {
  guarded_call("mapAndReadData()", &impl_->run,
               [&] { strake::refuse_function(no_mapping_in_between, set_the_mesh); });
}

bool Participant::requiresGradientDataFor(string_view mesh, string_view data) const {
  return guarded_call("requiresGradientDataFor()", &impl_->run, [&] {
    strake::data_of_mesh(impl_->run, strake::used_mesh(impl_->run, text_of(mesh)), text_of(data));
    return false;
  });
}

void Participant::writeGradientData(string_view, string_view, span<const VertexID>, span<const double>) {
  guarded_call("writeGradientData()", &impl_->run, [&] {
    strake::refuse_function("no mapping of Strake uses gradients",
                            "ask requiresGradientDataFor(), which is false");
  });
}

}  // namespace precice
