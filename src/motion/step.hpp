// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "boundary/dashpot.hpp"
#include "boundary/machine_springs.hpp"
#include "mesh/mesh.hpp"
#include "motion/interface_side.hpp"
#include "motion/level.hpp"
#include "record/energies.hpp"
#include "solid/element.hpp"
#include "solid/operator.hpp"

// The time step, written to be read. All steppers compute this scheme, the others faster.
//
// Displacements u belong to whole steps, velocities v to half steps before them (Newmark with beta = 0,
// gamma = 1/2). In a step
//
//   cells kick their nodes            v <- v - dt/m K (u + beta_R v)
//   contact and friction              correct v at the interface
//   nodes move                        u <- u + dt v
//
// Cells are divided into levels, each with its own step: that of the cells next to the interface is one
// sub-step, the others' are multiples. A level kicks when its step begins, by its force times its step: the
// asynchronous variational integrator of Lew et al. (2003). A node moves with the finest of its cells; where
// a coarser level has cells there, too, the node is shared. That level sees the node's mean velocity over its
// own step. Its force on the node acts as a constant load, as large as in the equilibrium at the start, in
// every finer step, and what it has changed since comes as an impulse in the first of them; without this a
// stressed body at rest would not stay at rest.

namespace slipfront::motion {

/// Cells that take the same step. Fields: [nodes of the body].
struct PlainLevel {
  int period = 1;  ///< see step_plan.hpp
  double step_s = 0;
  std::vector<std::int32_t> cells;
  std::vector<mesh::Node> nodes;  ///< that move with this level
  std::vector<bool> is_shared;    ///< of its cells, and moves with a finer level
  // At the last kick: displacements, velocities that the cells saw, force, and the damping's part of it.
  solid::Field u_before_m, v_seen_m_per_s, force_N, damping_force_N;
};

/// A body of any mesh, its stiffness cell by cell. Fields: [nodes].
struct PlainBody {
  std::vector<mesh::Cell> cells;
  std::vector<solid::CellStiffness> stiffness_N_per_m;  ///< [cells]
  std::vector<double> mass_kg;
  double damping_s = 0;  ///< beta_R
  /// Nodes in contact are moved by it; those of the loaded edge keep their velocity.
  std::vector<bool> is_in_contact, is_loaded;
  std::vector<PlainLevel> levels;           ///< coarsest first
  std::vector<boundary::Dashpot> dashpots;  ///< of edge nodes not in contact, with d = 0 for all others
  boundary::MachineSprings springs;
  InterfaceSide side;
  /// What the contact moves.
  ContactBody contact() { return {&side, &u_m, &v_m_per_s}; }
  inline void kick(int k);
  inline void move(int k);

  solid::Field u_m, v_m_per_s;
  solid::Field load_m_per_s2, impulse_m_per_s;  ///< of coarser levels, on shared nodes
  solid::Field v_last_m_per_s;                  ///< with which a node has moved last
  record::Energies works;
};

inline constexpr auto components = {&solid::Field::x, &solid::Field::y};

/// K w of a level's cells.
solid::Field stiffness_product(const PlainBody& body, const PlainLevel& level, const solid::Field& w);
/// The velocities that a level's cells see.
solid::Field velocities_seen(const PlainBody& body, const PlainLevel& level);
/// Adds the works of a level's last kick, which are known at its next one: of mean velocities.
void add_works(const PlainBody& body, const PlainLevel& level, const solid::Field& v_seen_m_per_s,
               record::Energies& works);

/// The cells of a level kick their nodes.
inline void kick(PlainBody& body, PlainLevel& level) {
  const auto& u = body.u_m;
  const auto v = velocities_seen(body, level);
  add_works(body, level, v, body.works);
  level.damping_force_N = stiffness_product(body, level, v);
  level.force_N = stiffness_product(body, level, u);
  const double dt = level.step_s;
  for (const auto component : components) {
    auto &force = level.force_N.*component, &damping = level.damping_force_N.*component;
    for (std::size_t n = 0; n < u.size(); ++n) {
      damping[n] *= body.damping_s;
      force[n] += damping[n];
      if (body.mass_kg[n] == 0 || body.is_loaded[n]) continue;
      const double kick = -dt * force[n] / body.mass_kg[n];
      if (level.is_shared[n])
        (body.impulse_m_per_s.*component)[n] = kick - dt * (body.load_m_per_s2.*component)[n];
      else
        (body.v_m_per_s.*component)[n] += kick;
    }
  }
  for (std::size_t n = 0; n < u.size(); ++n)
    if (body.is_loaded[n]) body.works.far_edge_work += dt * level.force_N.x[n] * body.v_m_per_s.x[n];
  level.v_seen_m_per_s = v;
  level.u_before_m = u;
}

/// The nodes of a level that are not in contact move.
inline void move(PlainBody& body, const PlainLevel& level) {
  const double dt = level.step_s;
  auto &u = body.u_m, &v = body.v_m_per_s, &v_last = body.v_last_m_per_s;
  for (const auto n : level.nodes) {
    if (body.is_in_contact[n]) continue;
    if (body.is_loaded[n]) {
      u.x[n] += dt * v.x[n];
      continue;
    }
    const double kick_x = dt * body.load_m_per_s2.x[n] + body.impulse_m_per_s.x[n];
    const double kick_y = dt * body.load_m_per_s2.y[n] + body.impulse_m_per_s.y[n];
    body.impulse_m_per_s.x[n] = body.impulse_m_per_s.y[n] = 0;
    const auto after =
        boundary::damp(body.dashpots[n], body.springs, dt, body.mass_kg[n], {u.x[n], u.y[n]},
                       {v_last.x[n], v_last.y[n]}, {v.x[n] + kick_x, v.y[n] + kick_y}, body.works);
    body.works.coupling_work +=
        0.5 * body.mass_kg[n] * (kick_x * (after.x + v_last.x[n]) + kick_y * (after.y + v_last.y[n]));
    v.x[n] = v_last.x[n] = after.x;
    v.y[n] = v_last.y[n] = after.y;
    u.x[n] += dt * after.x;
    u.y[n] += dt * after.y;
  }
}

void PlainBody::kick(int k) {
  for (auto& level : levels)
    if (k % level.period == 0) motion::kick(*this, level);
}

void PlainBody::move(int k) {
  for (const auto& level : levels)
    if (k % level.period == 0) motion::move(*this, level);
}

/// A body without contact, as a step takes it.
template <class B>
concept SteppedBody = requires(B body, int k) {
  body.kick(k);  // the cells of all levels whose step begins with sub-step k
  body.move(k);  // the nodes of these levels that are not in contact
};

/// Takes a step of so many sub-steps, or the first ones of it.
/// @param contact  called at the end of each sub-step k: finds the tractions and moves the nodes in contact
template <SteppedBody B, std::invocable<int> Contact>
void take_step(std::span<B> bodies, int n_substeps, Contact&& contact) {
  for (int k = 0; k < n_substeps; ++k) {
    for (auto& body : bodies) body.kick(k);
    for (auto& body : bodies) body.move(k);
    contact(k);
  }
}

}  // namespace slipfront::motion
