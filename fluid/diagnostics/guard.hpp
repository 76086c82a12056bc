#pragma once

#include "fluid/particles/member_list.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <array>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace strake::fluid {

/// What the guard of a run watches. The words for each stand in coupler/summary/notes.cpp.
enum class Alarm { speed, pressure, dry, momentum, volume, hollow };
constexpr int alarm_kinds = 6;
constexpr std::array<const char*, alarm_kinds> alarm_names = {"speed",    "pressure", "dry",
                                                              "momentum", "volume",   "hollow"};

/// A largest value, where and when it was, and the length of the step.
struct Extreme {
  double value = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // [m]
  double time = 0, step = 0;                     // [s]
};

/// The largest values of the steps of one window.
struct WindowExtremes {
  Extreme speed;     // of a particle [m/s]
  Extreme pressure;  // on a piece of a body's face [Pa]
};

/// One piece of a body's face, about a spacing long.
struct FacePiece {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();        // [m]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // into the water
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // [m/s]
  double area = 0;                                     // [m, m² in 3-D]
  double pressure = 0;                                 // [Pa] of the last step
  bool wet = false;
  bool on_wall = false;  // within a spacing of the tank's wall, where there is no room for water
};

/// The numbers of a case from which all bounds follow.
struct GuardScales {
  double density = 1000;                                         // ρ [kg/m³]
  double sound_speed = std::numeric_limits<double>::infinity();  // c [m/s]
  double spacing = 0.01;                                         // l0 [m]
  double cfl = 0.6;                                              // speed times step over l0
  double gravity = 0;                                            // g [m/s²]
  double gravity_ramp = 0;                                       // [s]
  double top = 0;                                                // of the water at the start [m]
  double drop = 0;         // H, the height that water can fall through [m]
  double half_width = 0;   // a of the body along x [m]; 0: no body
  double tank_speed = 0;   // largest of the tank's walls [m/s]
  double water_speed = 0;  // largest that the case gives the water at t = 0 [m/s]
  bool enters = false;     // the body comes from outside the water
  bool submerged = false;  // it begins in the water
  bool has_faces = true;   // the pressure on the body's faces is measured: in volume coupling it has none
};

/// What the guard keeps from t = 0 on. It is copied to rewind and written to resume, as Measurements is.
struct GuardRecord {
  double jet = 0;             // [m/s] largest speed that a face could give the water so far
  double normal_speed = 0;    // [m/s] largest at which a face pushed the water so far
  double dry_since = -1;      // [s] pushing faces under water have been dry from here on; < 0: they are wet
  double dry_path = 0;        // [m] that they have advanced since then
  double speed_share = 0;     // largest speed over its bound so far
  double pressure_share = 0;  // likewise
  /// A column per Alarm: time [s], x, y, z [m], value, bound, step [s]. The time is < 0 before the alarm.
  Eigen::Matrix<double, 7, alarm_kinds> alarm = none();

  static Eigen::Matrix<double, 7, alarm_kinds> none();
  bool raised(Alarm kind) const { return alarm(0, static_cast<int>(kind)) >= 0; }

  static constexpr auto values() {
    return std::tuple(std::pair("jet", &GuardRecord::jet),                        //
                      std::pair("normal_speed", &GuardRecord::normal_speed),      //
                      std::pair("dry_since", &GuardRecord::dry_since),            //
                      std::pair("dry_path", &GuardRecord::dry_path),              //
                      std::pair("speed_share", &GuardRecord::speed_share),        //
                      std::pair("pressure_share", &GuardRecord::pressure_share),  //
                      std::pair("alarm", &GuardRecord::alarm));
  }
};
static_assert(listed_bytes(GuardRecord::values()) == sizeof(GuardRecord),
              "a member of GuardRecord is not listed in values()");

/// Writes the record to an archive, and reads it back. A checkpoint of a version without a guard has none:
/// it then begins anew.
void save(const GuardRecord&, Archive&);
GuardRecord load_guard(const Archive&);

/// Compares a run with what its water and its body can do. It acts on nothing, and raises each alarm once.
/// All bounds stand in guard.cpp and in fluid/THEORY.md, section 15.
class Guard {
 public:
  Guard() = default;
  explicit Guard(const GuardScales&);

  /// Takes the faces at time t [s]: the speeds that they can give.
  void faces(GuardRecord&, const std::vector<FacePiece>&);
  /// Takes the largest speed of a body without faces, as in volume coupling [m/s]. Its slope is unknown.
  void body(GuardRecord&, double speed) const;
  /// Looks at the faces at the end of a window of length dt [s]: whether they have lost their water.
  void water_on_faces(GuardRecord&, double t, double dt, const std::vector<FacePiece>&) const;
  /// Compares the extremes of a window with their bounds.
  void extremes(GuardRecord&, const WindowExtremes&) const;
  /// Compares measures of the whole water with their bounds, at time t [s]. Shares of 1.
  void momentum(GuardRecord&, double t, double gap) const;
  void volume(GuardRecord&, double t, double drift) const;
  void hollow(GuardRecord&, double t, double openings) const;

  /// The largest speed that a face of that slope gives the water [m/s]. normal_speed: at which the face
  /// pushes [m/s]; sine: of its angle against the level.
  double jet(double normal_speed, double sine) const;
  double speed_bound(const GuardRecord&) const;                  // [m/s]; 0: unknown
  double pressure_bound(const GuardRecord&, double step) const;  // [Pa]; 0: unknown

  /// Adds "alarm.<kind>.time", ".x" … of the raised alarms, and the shares of the bounds (proto/WIRE.md).
  void report(const GuardRecord&, std::map<std::string, double>& monitor) const;

 private:
  void find_neighbours(const std::vector<FacePiece>&);

  GuardScales scales_;
  std::vector<std::vector<int>> beside_;  // pieces within 1.5 l0 of each, at the first call
};

}  // namespace strake::fluid
