#pragma once

#include <precice/Exceptions.hpp>
#include <precice/Types.hpp>
#include <precice/Version.h>
#include <precice/export.h>
#include <precice/span.hpp>

#include <memory>

namespace precice {

namespace impl {
class ParticipantImpl;
}

using string_view = ::precice::span<const char>;

/// One solver in a run that Strake's coupler leads, with the functions of preCICE 3. Every function throws
/// precice::Error for a call that comes at the wrong time, names what the configuration does not have, or
/// brings arrays of the wrong length. The units of data are those of the two solvers; Strake's own solvers
/// use SI.
///
/// Arrays: coordinates and vectors point by point, "x y" or "x y z" by the dimension of the mesh.
class PRECICE_API Participant {
 public:
  /// `name` stands in the configuration file, `config` is its path. Rank 0 of 1 is all that is taken today.
  Participant(::precice::string_view name, ::precice::string_view config, int rank, int size);
  /// The same; the communicator is not looked at.
  Participant(::precice::string_view name, ::precice::string_view config, int rank, int size,
              void* communicator);
  /// Does what finalize() does. While an exception unwinds, the run ends with a fault of this participant.
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  // ---- steps of a run
  /// Sends the mesh and the initial data; returns with the first window.
  void initialize();
  /// Ends a time step of `dt` [s], greater than 0 and at most getMaxTimeStepSize().
  void advance(double dt);
  /// Leaves the run. Before its end this is a fault of this participant.
  void finalize();

  // ---- state of the run
  bool isCouplingOngoing() const;
  /// True after an advance() that ended a window for good.
  bool isTimeWindowComplete() const;
  /// What is left of the window [s]; 0 after the end.
  double getMaxTimeStepSize() const;

  // ---- what the solver has to do
  /// True if the configuration asks for initial data of this participant.
  bool requiresInitialData();
  /// True at the beginning of a window that may be computed again.
  bool requiresWritingCheckpoint();
  /// True when the window is computed again.
  bool requiresReadingCheckpoint();

  // ---- meshes and data by name
  /// 2 or 3.
  int getMeshDimensions(::precice::string_view mesh) const;
  /// Components of the data at a point: 1, or the dimension of the mesh.
  int getDataDimensions(::precice::string_view mesh, ::precice::string_view data) const;
  /// True if the faces of that mesh are used.
  bool requiresMeshConnectivityFor(::precice::string_view mesh) const;
  /// Refused: a mesh stays as it is.
  void resetMesh(::precice::string_view mesh);

  // ---- the mesh, before initialize()
  VertexID setMeshVertex(::precice::string_view mesh, ::precice::span<const double> position);
  int getMeshVertexSize(::precice::string_view mesh) const;
  /// `positions` has `ids.size()` points.
  void setMeshVertices(::precice::string_view mesh, ::precice::span<const double> positions,
                       ::precice::span<VertexID> ids);
  void setMeshEdge(::precice::string_view mesh, VertexID first, VertexID second);
  void setMeshEdges(::precice::string_view mesh, ::precice::span<const VertexID> ids);
  void setMeshTriangle(::precice::string_view mesh, VertexID first, VertexID second, VertexID third);
  void setMeshTriangles(::precice::string_view mesh, ::precice::span<const VertexID> ids);
  /// A quadrilateral becomes two triangles, cut along its shorter diagonal.
  void setMeshQuad(::precice::string_view mesh, VertexID first, VertexID second, VertexID third,
                   VertexID fourth);
  void setMeshQuads(::precice::string_view mesh, ::precice::span<const VertexID> ids);
  /// Tetrahedra are taken and not used.
  void setMeshTetrahedron(::precice::string_view mesh, VertexID first, VertexID second, VertexID third,
                          VertexID fourth);
  void setMeshTetrahedra(::precice::string_view mesh, ::precice::span<const VertexID> ids);

  // ---- data
  void writeData(::precice::string_view mesh, ::precice::string_view data,
                 ::precice::span<const VertexID> ids, ::precice::span<const double> values);
  /// The values at `relative_time` [s] after now, at most getMaxTimeStepSize().
  void readData(::precice::string_view mesh, ::precice::string_view data, ::precice::span<const VertexID> ids,
                double relative_time, ::precice::span<double> values) const;
  /// Refused, as the two below: Strake maps between two meshes that stay.
  void writeAndMapData(::precice::string_view mesh, ::precice::string_view data,
                       ::precice::span<const double> coordinates, ::precice::span<const double> values);
  void mapAndReadData(::precice::string_view mesh, ::precice::string_view data,
                      ::precice::span<const double> coordinates, double relative_time,
                      ::precice::span<double> values) const;
  void setMeshAccessRegion(::precice::string_view mesh, ::precice::span<const double> box) const;
  /// Of a mesh of this participant; refused for one of the partner's.
  void getMeshVertexIDsAndCoordinates(::precice::string_view mesh, ::precice::span<VertexID> ids,
                                      ::precice::span<double> coordinates) const;
  /// False: no mapping of Strake's uses gradients.
  bool requiresGradientDataFor(::precice::string_view mesh, ::precice::string_view data) const;
  /// Refused.
  void writeGradientData(::precice::string_view mesh, ::precice::string_view data,
                         ::precice::span<const VertexID> ids, ::precice::span<const double> gradients);

  // ---- clocks: sections may lie in one another
  void startProfilingSection(::precice::string_view name);
  void stopLastProfilingSection();

 private:
  std::unique_ptr<impl::ParticipantImpl> impl_;
};

}  // namespace precice
