// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mesh/mesh.hpp"
#include "solid/material.hpp"
#include "verification/verification.hpp"

/// Convergence with the mesh, dt/h fixed.
namespace slipfront::verification {

/// Slope of log(error) over log(h) by least squares.
double observed_order(const std::vector<double>& h_m, const std::vector<double>& error);

/// A line of that slope through the last error.
Curve order_line(int order, const std::vector<double>& h_m, double last_error);

/// Step factor with which a mesh steps by step_s.
double factor_of_step(const mesh::Mesh& mesh, const solid::Material& material, double step_s);

/// Steps of 0.85 h/c_L or less, at all meshes the same fraction of h, that end at time_s exactly.
struct Steps {
  int n = 0;
  double step_s = 0;
};
Steps steps_to(double time_s, double h_m, double coarsest_h_m, const solid::Material& material);

}  // namespace slipfront::verification
