// SPDX-License-Identifier: BSD-3-Clause
#include "solve/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "solid/kernels.hpp"

namespace slipfront::solve {

namespace {

/// For each cell, whether it is among the `rows` rows of cells next to the interface, counted in cells.
std::vector<bool> cells_next_to_interface(const mesh::Mesh& mesh, int rows) {
  std::vector<bool> near(mesh.cells.size(), false), reached(mesh.n_nodes(), false);
  for (const auto n : mesh.lower) reached[n] = true;
  for (int row = 0; row < rows; ++row) {
    const auto reached_before = reached;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      if (near[c] || std::ranges::none_of(mesh.cells[c], [&](mesh::Node n) { return reached_before[n]; }))
        continue;
      near[c] = true;
      for (const auto n : mesh.cells[c]) reached[n] = true;
    }
  }
  return near;
}

}  // namespace

void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time) {
  if (time.interface_rows >= mesh.grid.rows)
    throw UserError(
        "time.interface_rows = {} does not fit below the loaded edge of a mesh of {} rows; choose fewer",
        time.interface_rows, mesh.grid.rows);
}

Stepper::Stepper(const mesh::Mesh& mesh, const solid::Material& material, const interface::FrictionLaw& law,
                 const TimeStepping& time)
    : plate_(solid::make_operator(mesh, material)),
      damping_s_(material.stiffness_damping_s),
      law_(law),
      substeps_(time.interface_substeps),
      lower_(mesh.lower),
      interface_(mesh.lower.size()),
      trigger_force_N_(mesh.lower.size(), 0.0),
      u_(mesh.n_nodes()),
      v_(mesh.n_nodes()),
      start_u_(mesh.lower.size()),
      w_(6 * static_cast<std::size_t>(mesh.grid.stride())) {
  require_rows_fit(mesh, time);
  stable_step_s_ = solid::stable_step_s(solid::largest_frequency_rad_per_s(plate_), damping_s_);
  step_s_ = time.step_factor * stable_step_s_;
  divide_cells(mesh, material, time);

  const auto tributary = mesh::tributary_lengths_m(mesh);
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    interface_.initial_gap_m[k] = mesh.y_m[lower_[k]];
    interface_.mass_per_length_kg_m2[k] = plate_.mass_kg[lower_[k]] / tributary[k];
    lower_mass_kg_.push_back(plate_.mass_kg[lower_[k]]);
  }
}

void Stepper::divide_cells(const mesh::Mesh& mesh, const solid::Material& material,
                           const TimeStepping& time) {
  std::vector<int> level_of_cell(mesh.cells.size(), 0);
  levels_.resize(substeps_ > 1 ? 2 : 1);
  if (levels_.size() > 1) {
    const auto near = cells_next_to_interface(mesh, time.interface_rows);
    for (std::size_t c = 0; c < near.size(); ++c) level_of_cell[c] = near[c] ? 1 : 0;
  }
  // A node moves with the finest of its cells.
  std::vector<int> level_of_node(mesh.n_nodes(), -1);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto n : mesh.cells[c]) level_of_node[n] = std::max(level_of_node[n], level_of_cell[c]);
  std::vector<bool> in_contact(mesh.n_nodes(), false), is_shared(mesh.n_nodes(), false);
  for (const auto n : lower_) in_contact[n] = true;

  for (std::size_t l = 0; l < levels_.size(); ++l) {
    auto& level = levels_[l];
    level.period = l + 1 == levels_.size() ? 1 : substeps_;
    level.step_s = step_s_ * level.period / substeps_;
    std::vector<bool> in_level(mesh.cells.size());
    for (std::size_t c = 0; c < in_level.size(); ++c) in_level[c] = level_of_cell[c] == static_cast<int>(l);
    const int edge_row = levels_.size() > 1 ? time.interface_rows : 0;
    level.part =
        levels_.size() > 1 ? solid::make_part(mesh, material, plate_, in_level, edge_row) : plate_.whole;
    for (const auto n : mesh.top)
      if (level_of_node[n] == static_cast<int>(l)) level.top.push_back(n);
    const auto& irregular = level.part.irregular;
    std::vector<std::int32_t> irregular_row(mesh.n_nodes(), -1);
    for (std::size_t r = 0; r < irregular.size(); ++r)
      irregular_row[irregular.node[r]] = static_cast<std::int32_t>(r);
    std::vector<bool> shared(mesh.n_nodes(), false);
    for (std::size_t c = 0; c < in_level.size(); ++c)
      for (const auto n : mesh.cells[c])
        if (in_level[c] && level_of_node[n] > static_cast<int>(l) && !plate_.is_top[n]) shared[n] = true;
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
      if (!shared[n]) continue;
      level.shared.node.push_back(n);
      level.shared.irregular_row.push_back(irregular_row[n]);
      is_shared[n] = true;
    }
    const std::size_t n_shared = level.shared.node.size();
    level.shared.u_before_m = level.shared.push_m_per_s = level.shared.steady_m_per_s2 =
        solid::Field(n_shared);
    if (n_shared > 0) level.edge_push_m_per_s.resize(2 * static_cast<std::size_t>(mesh.grid.stride()));
    if (n_shared > shared_v_.size()) shared_v_ = solid::Field(n_shared);
    for (const auto n : irregular.node) {
      level.takes_push.push_back(!shared[n]);
      level.moves.push_back(!in_contact[n] && !is_shared[n]);
    }
    level.a_x.resize(irregular.size());
    level.a_y.resize(irregular.size());
  }
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (level_of_node[n] >= 0 && !plate_.is_top[n])
      node_updates_per_step_ += substeps_ / levels_[level_of_node[n]].period;
}

void Stepper::start(const Equilibrium& equilibrium, double top_speed_m_per_s) {
  u_ = equilibrium.u_m;
  top_speed_ = top_speed_m_per_s;
  for (std::size_t n = 0; n < v_.size(); ++n) {
    v_.x[n] = top_speed_ * equilibrium.u_per_shear.x[n];
    v_.y[n] = top_speed_ * equilibrium.u_per_shear.y[n];
  }
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    start_u_.x[k] = u_.x[lower_[k]];
    interface_.slip_rate_m_per_s[k] = v_.x[lower_[k]];
    interface_.t_Pa[k] = equilibrium.tractions.t_s_Pa[k];
    interface_.p_Pa[k] = equilibrium.tractions.p_s_Pa[k];
    interface_.slipping[k] = equilibrium.contact[k] == Contact::slip;
  }
  for (auto& level : levels_) {
    // The first look at the forces gives their steady part; it must not move anything.
    auto& shared = level.shared;
    if (shared.node.empty()) continue;
    const solid::Field u = u_, v = v_;
    const auto set_places_before = [&] {
      for (std::size_t k = 0; k < shared.node.size(); ++k) {
        const auto n = shared.node[k];
        shared.u_before_m.x[k] = u_.x[n] - level.step_s * v_.x[n];
        shared.u_before_m.y[k] = u_.y[n] - level.step_s * v_.y[n];
      }
    };
    shared.steady_m_per_s2 = shared.push_m_per_s = solid::Field(shared.node.size());
    set_places_before();
    push(level);
    for (std::size_t k = 0; k < shared.node.size(); ++k) {
      shared.steady_m_per_s2.x[k] = shared.push_m_per_s.x[k] / level.step_s;
      shared.steady_m_per_s2.y[k] = shared.push_m_per_s.y[k] / level.step_s;
    }
    u_ = u;
    v_ = v;
    shared.push_m_per_s = solid::Field(shared.node.size());
    set_places_before();
  }
  set_trigger({}, std::vector<double>(lower_.size(), 0.0));
  trigger_work_ = 0;
  step_ = 0;
}

void Stepper::set_trigger(const interface::Trigger& trigger, std::vector<double> force_N_per_m) {
  trigger_ = trigger;
  trigger_force_N_ = std::move(force_N_per_m);
  trigger_nodes_.clear();
  for (std::size_t i = 0; i < trigger_force_N_.size(); ++i)
    if (trigger_force_N_[i] != 0) trigger_nodes_.push_back(i);
}

void Stepper::compute_irregular(Level& level) {
  const auto& rows = level.part.irregular;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double x = 0, y = 0;
    for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      const auto n = rows.neighbour[k];
      const double w_x = u_.x[n] + damping_s_ * v_.x[n];
      const double w_y = u_.y[n] + damping_s_ * v_.y[n];
      const auto& b = rows.block[k];
      x += b[0] * w_x + b[1] * w_y;
      y += b[2] * w_x + b[3] * w_y;
    }
    level.a_x[r] = x;
    level.a_y[r] = y;
  }
}

void Stepper::apply_irregular(const Level& level) {
  const auto& node = level.part.irregular.node;
  for (std::size_t r = 0; r < node.size(); ++r) {
    if (!level.takes_push[r]) continue;
    const auto n = node[r];
    v_.x[n] -= level.step_s * level.a_x[r];
    v_.y[n] -= level.step_s * level.a_y[r];
    if (!level.moves[r]) continue;
    u_.x[n] += level.step_s * v_.x[n];
    u_.y[n] += level.step_s * v_.y[n];
  }
}

void Stepper::sweep(Level& level) {
  const int stride = plate_.grid.stride();
  const double dt = level.step_s;
  const auto interior = solid::scaled(plate_.interior, -dt);
  const auto w_row = [&](int j) {
    double* row = w_.data() + static_cast<std::ptrdiff_t>(j % 3) * 2 * stride;
    return solid::ConstRow{row, row + stride};
  };
  // Rows of w = u + beta_R v are filled just before the first row that reads them moves.
  int next = 0;
  const auto fill_to = [&](int first, int last) {
    for (next = std::max(next, first); next <= last; ++next) {
      const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(next) * stride;
      double* row = w_.data() + static_cast<std::ptrdiff_t>(next % 3) * 2 * stride;
      solid::combine_row(stride, damping_s_, &u_.x[o], &u_.y[o], &v_.x[o], &v_.y[o], row, row + stride);
    }
  };
  for (const auto& [j, squares, scale, spans] : level.part.stencil) {
    const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(j) * stride;
    fill_to(squares == solid::Squares::above ? j : j - 1, squares == solid::Squares::below ? j : j + 1);
    if (squares == solid::Squares::all) {
      for (const auto span : spans) {
        solid::add_interior_row(interior, span, w_row(j - 1), w_row(j), w_row(j + 1), &v_.x[o], &v_.y[o]);
        solid::move_row(span, dt, &v_.x[o], &v_.y[o], &u_.x[o], &u_.y[o]);
      }
    } else if (squares == solid::Squares::above) {
      // The plate's lower edge, moved by the contact update; or nodes shared with the next level.
      const auto edge = solid::scaled(plate_.edge, -dt * scale);
      double* v_x = &v_.x[o];
      double* v_y = &v_.y[o];
      if (j > 0) {
        std::ranges::fill(level.edge_push_m_per_s, 0.0);
        v_x = level.edge_push_m_per_s.data();
        v_y = v_x + stride;
      }
      for (const auto span : spans) solid::add_edge_row(edge, span, w_row(j), w_row(j + 1), v_x, v_y);
    } else {
      const auto edge = solid::mirrored(solid::scaled(plate_.edge, -dt * scale));
      for (const auto span : spans)
        solid::add_edge_row(edge, span, w_row(j), w_row(j - 1), &v_.x[o], &v_.y[o]);
    }
  }
}

void Stepper::gather_push(Level& level) {
  const int stride = plate_.grid.stride();
  auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto r = s.irregular_row[k];
    const auto column = s.node[k] % stride;
    const double x = r < 0 ? level.edge_push_m_per_s[column] : -level.step_s * level.a_x[r];
    const double y = r < 0 ? level.edge_push_m_per_s[stride + column] : -level.step_s * level.a_y[r];
    s.push_m_per_s.x[k] = x - level.step_s * s.steady_m_per_s2.x[k];
    s.push_m_per_s.y[k] = y - level.step_s * s.steady_m_per_s2.y[k];
  }
}

void Stepper::move_shared(Level& coarser, double dt) {
  auto& s = coarser.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    v_.x[n] += dt * s.steady_m_per_s2.x[k] + s.push_m_per_s.x[k];
    v_.y[n] += dt * s.steady_m_per_s2.y[k] + s.push_m_per_s.y[k];
    u_.x[n] += dt * v_.x[n];
    u_.y[n] += dt * v_.y[n];
    s.push_m_per_s.x[k] = s.push_m_per_s.y[k] = 0;
  }
}

void Stepper::push(Level& level) {
  // For the level, a shared node's velocity is the mean one since its last push.
  auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    shared_v_.x[k] = std::exchange(v_.x[n], (u_.x[n] - s.u_before_m.x[k]) / level.step_s);
    shared_v_.y[k] = std::exchange(v_.y[n], (u_.y[n] - s.u_before_m.y[k]) / level.step_s);
    s.u_before_m.x[k] = u_.x[n];
    s.u_before_m.y[k] = u_.y[n];
  }
  compute_irregular(level);
  sweep(level);
  gather_push(level);
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    v_.x[s.node[k]] = shared_v_.x[k];
    v_.y[s.node[k]] = shared_v_.y[k];
  }
}

void Stepper::advance(Recorder& recorder, fronts::History* sample) {
  for (int k = 0; k < substeps_; ++k) {
    const auto is_due = [&](const Level& level) { return k % level.period == 0; };
    // All forces are those of the places and velocities before the sub-step.
    for (auto& level : levels_)
      if (is_due(level)) push(level);
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      const auto& level = levels_[l];
      if (!is_due(level)) continue;
      apply_irregular(level);
      if (l > 0) move_shared(levels_[l - 1], level.step_s);
      for (const auto n : level.top) u_.x[n] += level.step_s * v_.x[n];
    }
    take_contact(time_s() + k * substep_s(), recorder, k == 0 ? sample : nullptr);
  }
  ++step_;
}

void Stepper::take_contact(double time, Recorder& recorder, fronts::History* sample) {
  const double dt = substep_s();
  for (std::size_t i = 0; i < lower_.size(); ++i) {
    const auto n = lower_[i];
    interface_.v_x_m_per_s[i] = v_.x[n];
    interface_.v_y_m_per_s[i] = v_.y[n];
    interface_.u_y_m[i] = u_.y[n];
  }
  const double impulse_s = dt * trigger_factor(trigger_, time);
  for (const auto i : trigger_nodes_)
    interface_.v_x_m_per_s[i] += impulse_s * trigger_force_N_[i] / lower_mass_kg_[i];
  const bool changed = interface::update_contact(law_, dt, interface_);
  recorder.observe(time, interface_, changed);
  if (sample != nullptr) append_sample(*sample);
  for (std::size_t i = 0; i < lower_.size(); ++i) {
    const auto n = lower_[i];
    v_.x[n] = interface_.v_x_m_per_s[i];
    v_.y[n] = interface_.v_y_m_per_s[i];
    u_.x[n] += dt * v_.x[n];
    u_.y[n] += dt * v_.y[n];
  }
  for (const auto i : trigger_nodes_)
    trigger_work_ += impulse_s * trigger_force_N_[i] * interface_.v_x_m_per_s[i];
}

void Stepper::append_sample(fronts::History& history) const {
  history.time_s.push_back(time_s());
  for (std::size_t i = 0; i < lower_.size(); ++i) history.slip_m.push_back(u_.x[lower_[i]] - start_u_.x[i]);
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(history.slip_rate_m_per_s, interface_.slip_rate_m_per_s);
  append(history.t_Pa, interface_.t_Pa);
  append(history.p_Pa, interface_.p_Pa);
}

double Stepper::kinetic_energy_J_per_m() const {
  return solid::kinetic_energy_J_per_m(plate_, v_);
}

double Stepper::energy_J_per_m() const {
  return solid::strain_energy_J_per_m(plate_, u_) + kinetic_energy_J_per_m();
}

double Stepper::top_force_x_N_per_m() const {
  solid::Field w = u_;
  for (const auto n : plate_.top.neighbour) {
    w.x[n] = u_.x[n] + damping_s_ * v_.x[n];
    w.y[n] = u_.y[n] + damping_s_ * v_.y[n];
  }
  return solid::top_force_x_N_per_m(plate_, w);
}

}  // namespace slipfront::solve
