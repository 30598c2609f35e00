// SPDX-License-Identifier: BSD-3-Clause
#include "statics/prestress.hpp"

#include <numeric>
#include <utility>

namespace slipfront::statics {

Equilibrium prestressed(const mesh::Mesh& mesh, record::StaticState tractions, const mesh::Mesh* below) {
  Equilibrium e;
  if (!mesh.is_interface()) {
    e.u_m = e.u_per_shear = solid::Field(mesh.n_nodes());
    for (const auto n : mesh.far_edge_nodes) e.u_per_shear.x[n] = 1;
    if (below != nullptr) e.below_u_m = e.below_u_per_shear = solid::Field(below->n_nodes());
  }
  e.contact.assign(mesh.interface_nodes.size(), Contact::stick);
  e.tractions = std::move(tractions);
  e.inside_from_m = e.tractions.x_m.front();
  e.inside_to_m = e.tractions.x_m.back();
  e.peak_x_m = e.inside_from_m;
  const auto& t_Pa = e.tractions.t_s_Pa;
  const double direction = std::reduce(t_Pa.begin(), t_Pa.end()) < 0 ? -1 : 1;  // of the load
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    const double ratio = t_Pa[k] / e.tractions.p_s_Pa[k];
    if (direction * ratio <= direction * e.peak_ratio) continue;
    e.peak_ratio = ratio;
    e.peak_x_m = e.tractions.x_m[k];
  }
  return e;
}

}  // namespace slipfront::statics
