// precice::Participant: the mesh, point by point and face by face.

#include "coupler/precice/guarded_call.hpp"

#include <fmt/format.h>
#include <precice/Participant.hpp>

#include <string>

namespace precice {
namespace {

using strake::Error;
using strake::ExitCode;
using strake::guarded_call;
using strake::SolverMesh;
using strake::SolverRun;
using strake::text_of;

/// The solver's own mesh, while it may be changed.
SolverMesh& open_mesh(SolverRun& run, string_view name) {
  strake::before_initialize(run);
  return run.mesh(text_of(name));
}

/// The array must have `expected` numbers for each of `count` things.
void check_size(std::size_t size, std::size_t expected, const std::string& what) {
  if (size != expected)
    throw Error(ExitCode::solver_fault, what, fmt::format("has {} numbers", size),
                fmt::format("{} numbers", expected));
}

/// Calls add(first id of each) for faces of `corners` vertices.
template <class Add>
void for_each_face(span<const VertexID> ids, std::size_t corners, const char* what, Add&& add) {
  if (ids.size() % corners != 0)
    throw Error(ExitCode::solver_fault, fmt::format("vertices of {}", what),
                fmt::format("are {}", ids.size()), fmt::format("a multiple of {}", corners));
  for (std::size_t i = 0; i < ids.size(); i += corners) add(ids.data() + i);
}

}  // namespace

VertexID Participant::setMeshVertex(string_view mesh, span<const double> position) {
  return guarded_call("setMeshVertex()", &impl_->run, [&] {
    SolverMesh& own = open_mesh(impl_->run, mesh);
    check_size(position.size(), static_cast<std::size_t>(own.dimension()), "the position");
    return own.add_vertex({position.data(), position.size()});
  });
}

int Participant::getMeshVertexSize(string_view mesh) const {
  return guarded_call("getMeshVertexSize()", &impl_->run,
                      [&] { return impl_->run.mesh(text_of(mesh)).size(); });
}

void Participant::setMeshVertices(string_view mesh, span<const double> positions, span<VertexID> ids) {
  guarded_call("setMeshVertices()", &impl_->run, [&] {
    SolverMesh& own = open_mesh(impl_->run, mesh);
    const auto dimension = static_cast<std::size_t>(own.dimension());
    check_size(positions.size(), dimension * ids.size(),
               fmt::format("positions of {} vertices in {} dimensions", ids.size(), dimension));
    for (std::size_t i = 0; i < ids.size(); ++i)
      ids[i] = own.add_vertex({positions.data() + i * dimension, dimension});
  });
}

void Participant::setMeshEdge(string_view mesh, VertexID first, VertexID second) {
  guarded_call("setMeshEdge()", &impl_->run, [&] { open_mesh(impl_->run, mesh).add_edge(first, second); });
}

void Participant::setMeshEdges(string_view mesh, span<const VertexID> ids) {
  guarded_call("setMeshEdges()", &impl_->run, [&] {
    SolverMesh& own = open_mesh(impl_->run, mesh);
    for_each_face(ids, 2, "edges", [&](const VertexID* v) { own.add_edge(v[0], v[1]); });
  });
}

void Participant::setMeshTriangle(string_view mesh, VertexID first, VertexID second, VertexID third) {
  guarded_call("setMeshTriangle()", &impl_->run,
               [&] { open_mesh(impl_->run, mesh).add_triangle(first, second, third); });
}

void Participant::setMeshTriangles(string_view mesh, span<const VertexID> ids) {
  guarded_call("setMeshTriangles()", &impl_->run, [&] {
    SolverMesh& own = open_mesh(impl_->run, mesh);
    for_each_face(ids, 3, "triangles", [&](const VertexID* v) { own.add_triangle(v[0], v[1], v[2]); });
  });
}

void Participant::setMeshQuad(string_view mesh, VertexID first, VertexID second, VertexID third,
                              VertexID fourth) {
  guarded_call("setMeshQuad()", &impl_->run,
               [&] { open_mesh(impl_->run, mesh).add_quad(first, second, third, fourth); });
}

void Participant::setMeshQuads(string_view mesh, span<const VertexID> ids) {
  guarded_call("setMeshQuads()", &impl_->run, [&] {
    SolverMesh& own = open_mesh(impl_->run, mesh);
    for_each_face(ids, 4, "quadrilaterals", [&](const VertexID* v) { own.add_quad(v[0], v[1], v[2], v[3]); });
  });
}

void Participant::setMeshTetrahedron(string_view mesh, VertexID first, VertexID second, VertexID third,
                                     VertexID fourth) {
  guarded_call("setMeshTetrahedron()", &impl_->run,
               [&] { open_mesh(impl_->run, mesh).add_tetrahedron(first, second, third, fourth); });
}

void Participant::setMeshTetrahedra(string_view mesh, span<const VertexID> ids) {
  guarded_call("setMeshTetrahedra()", &impl_->run, [&] {
    SolverMesh& own = open_mesh(impl_->run, mesh);
    for_each_face(ids, 4, "tetrahedra",
                  [&](const VertexID* v) { own.add_tetrahedron(v[0], v[1], v[2], v[3]); });
  });
}

void Participant::getMeshVertexIDsAndCoordinates(string_view mesh, span<VertexID> ids,
                                                 span<double> coordinates) const {
  guarded_call("getMeshVertexIDsAndCoordinates()", &impl_->run, [&] {
    const SolverMesh& own = impl_->run.mesh(text_of(mesh));
    const auto n = static_cast<std::size_t>(own.size()),
               dimension = static_cast<std::size_t>(own.dimension());
    check_size(ids.size(), n, "the array of vertices");
    check_size(coordinates.size(), n * dimension, "the array of coordinates");
    for (std::size_t i = 0; i < n; ++i) {
      ids[i] = static_cast<VertexID>(i);
      for (std::size_t k = 0; k < dimension; ++k)
        coordinates[i * dimension + k] = own.point(ids[i])[static_cast<Eigen::Index>(k)];
    }
  });
}

void Participant::resetMesh(string_view) {
  guarded_call("resetMesh()", &impl_->run, [&] {
    strake::refuse_function(
        "a mesh stays as it was at initialize(): records, checkpoints and the accelerator hold "
        "a column for each of its points",
        "run a case of its own for each mesh");
  });
}

void Participant::setMeshAccessRegion(string_view, span<const double>) const {
  guarded_call("setMeshAccessRegion()", &impl_->run, [&] {
    strake::refuse_function("a participant sees its own mesh alone",
                            "let Strake map the data onto that mesh");
  });
}

}  // namespace precice
