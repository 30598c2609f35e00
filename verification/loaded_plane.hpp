// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "interface/friction.hpp"
#include "verification/body.hpp"

namespace slipfront::verification {

/// A body at rest on the plane under uniform pressure, with edges that let waves out. Its friction does not
/// see changes of pressure: strength mu p, p the pressure at the start.
struct LoadedPlane {
  double width_m = 0, height_m = 0, h_m = 0;
  double pressure_Pa = 0;
  interface::FrictionLaw law;
  std::function<double(double x_m)> strength_fraction = {};  ///< see interface::Interface; none: 1 everywhere
  /// Traction under which nodes slide at V_i, of a law with a state.
  std::function<double(double x_m)> t_at_V_i_Pa = {};
};

/// Its mesh, and a stepper that starts from rest. A place x is counted from the middle of the interface.
class LoadedBody {
 public:
  explicit LoadedBody(const LoadedPlane& plane);

  /// Shear traction on the interface, by place.
  void load(const std::function<double(double x_m)>& t0_Pa);

  void advance() { verification::advance(stepper_); }
  double time_s() const { return stepper_.time_s(); }
  const interface::Interface& interface_state() const { return stepper_.interface_state(); }
  const std::vector<double>& x_m() const { return x_m_; }  ///< [interface nodes]
  double slip_m(std::size_t i) const { return stepper_.u_m().x[mesh_.interface_nodes[i]]; }

 private:
  std::vector<double> at(const std::function<double(double)>& f) const;
  LoadedPlane plane_;
  mesh::Mesh mesh_;
  std::vector<double> x_m_;
  motion::Stepper stepper_;
};

/// Shear stiffness of a half-space on the plane against slip: t = -Y0 |k| u at the wavenumber k.
double sliding_stiffness_Pa();

}  // namespace slipfront::verification
