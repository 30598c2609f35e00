// SPDX-License-Identifier: BSD-3-Clause
#include "motion/landing.hpp"

namespace slipfront::motion {

Landing::Landing(const mesh::Mesh& mesh, const solid::Material& material,
                 const std::vector<mesh::Node>& interface_nodes, solid::Span own)
    : interface_nodes_(interface_nodes),
      own_(own),
      rows_(solid::assemble_rows(mesh, material, interface_nodes)),
      shift_m_(mesh.n_nodes(), 0.0) {}

void Landing::add(std::size_t i, double shift_m) {
  shift_m_[interface_nodes_[i]] = shift_m;
  nodes_.push_back(i);
}

double Landing::work(const solid::Field& u_m, const solid::Field& v_m_per_s, double dt_s) {
  if (nodes_.empty()) return 0;
  // A shift s between the places u, at which this sub-step's forces were taken, and u + s, from which it
  // moves to u'': of the strain energies 1/2 u K u' before and 1/2 u'' K (u + s) after, the kicks' works
  // leave open 1/2 s K (u + u''). All neighbours of the interface have moved by dt v.
  double s_K_u = 0, s_K_v = 0, s_K_s = 0;
  for (const auto i : nodes_) {
    if (static_cast<int>(i) < own_.begin || static_cast<int>(i) >= own_.end) continue;
    double u = 0, v = 0, s = 0;
    for (auto k = rows_.first[i]; k < rows_.first[i + 1]; ++k) {
      const auto n = rows_.neighbour[k];
      const auto& b = rows_.block[k];
      u += b[2] * u_m.x[n] + b[3] * u_m.y[n];
      v += b[2] * v_m_per_s.x[n] + b[3] * v_m_per_s.y[n];
      s += b[3] * shift_m_[n];
    }
    const double shift_m = shift_m_[interface_nodes_[i]];
    s_K_u += shift_m * u;
    s_K_v += shift_m * v;
    s_K_s += shift_m * s;
  }
  for (const auto i : nodes_) shift_m_[interface_nodes_[i]] = 0;
  nodes_.clear();
  K_v_ = s_K_v;
  K_u_ = 2 * s_K_u - s_K_s;
  return 0.5 * (2 * s_K_u - dt_s * s_K_v - s_K_s);
}

}  // namespace slipfront::motion
