// SPDX-License-Identifier: BSD-3-Clause
#include "solve/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "solid/kernels.hpp"

namespace slipfront::solve {

namespace {

/// Distance of each node from the interface, counted in cells.
std::vector<int> layers_from_interface(const mesh::Mesh& mesh, int most) {
  std::vector<int> layer(mesh.n_nodes(), std::numeric_limits<int>::max());
  for (const auto n : mesh.lower) layer[n] = 0;
  for (int l = 1; l <= most; ++l) {
    for (const auto& cell : mesh.cells) {
      const bool touches = std::ranges::any_of(cell, [&](mesh::Node n) { return layer[n] == l - 1; });
      if (!touches) continue;
      for (const auto n : cell) layer[n] = std::min(layer[n], l);
    }
  }
  return layer;
}

}  // namespace

void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time) {
  if (time.interface_rows >= mesh.grid.rows)
    throw UserError(
        "time.interface_rows = {} does not fit below the loaded edge of a mesh of {} rows; choose fewer",
        time.interface_rows, mesh.grid.rows);
}

Stepper::Stepper(const mesh::Mesh& mesh, const solid::Material& material,
                 const interface::ContactModel& contact, const TimeStepping& time)
    : damping_s_(material.stiffness_damping_s),
      contact_(contact),
      layer_rows_(time.interface_rows),
      substeps_(time.interface_substeps),
      lower_(mesh.lower),
      top_(mesh.top),
      interface_(mesh.lower.size()),
      trigger_force_N_(mesh.lower.size(), 0.0),
      u_(mesh.n_nodes()),
      v_(mesh.n_nodes()),
      start_u_(mesh.lower.size()),
      w_(6 * static_cast<std::size_t>(mesh.grid.stride())),
      w_above_layer_(2 * static_cast<std::size_t>(mesh.grid.stride())) {
  require_rows_fit(mesh, time);

  // The layer is the lowest rows of the grid and, around fillets, whatever lies as near to the interface.
  // Nodes whose stencil would mix the layer with the rest at one height get block rows.
  const auto layer = layers_from_interface(mesh, layer_rows_);
  std::vector<bool> in_layer(mesh.n_nodes()), mixed(mesh.n_nodes());
  const int stride = mesh.grid.stride();
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    in_layer[n] = n / stride < layer_rows_ || layer[n] < layer_rows_;
    mixed[n] = in_layer[n] && n / stride >= layer_rows_;
  }
  auto force_irregular = mixed;
  for (const auto& cell : mesh.cells)
    if (std::ranges::any_of(cell, [&](mesh::Node n) { return mixed[n]; }))
      for (const auto n : cell) force_irregular[n] = true;
  plate_ = solid::make_operator(mesh, material, force_irregular);
  divide_rows(mesh, in_layer);

  stable_step_s_ = solid::stable_step_s(solid::largest_frequency_rad_per_s(plate_), damping_s_);
  step_s_ = time.step_factor * stable_step_s_;

  double n_moving = 0, n_layer = 0;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    if (plate_.is_top[n] || plate_.mass_kg[n] == 0) continue;
    n_moving += 1;
    n_layer += in_layer[n] ? 1 : 0;
  }
  node_updates_per_step_ = n_moving + (substeps_ - 1) * n_layer;

  const auto tributary = mesh::tributary_lengths_m(mesh);
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    interface_.initial_gap_m[k] = mesh.y_m[lower_[k]];
    interface_.mass_per_length_kg_m2[k] = plate_.mass_kg[lower_[k]] / tributary[k];
    lower_mass_kg_.push_back(plate_.mass_kg[lower_[k]]);
  }
}

void Stepper::divide_rows(const mesh::Mesh& mesh, const std::vector<bool>& in_layer) {
  std::vector<bool> in_contact(mesh.n_nodes(), false);
  for (const auto n : lower_) in_contact[n] = true;
  const auto& all = plate_.irregular;
  for (std::size_t r = 0; r < all.size(); ++r) {
    IrregularRows& part = in_layer[all.node[r]] ? fast_ : slow_;
    if (part.rows.first.empty()) part.rows.first.push_back(0);
    part.rows.node.push_back(all.node[r]);
    part.in_contact.push_back(in_contact[all.node[r]]);
    for (auto k = all.first[r]; k < all.first[r + 1]; ++k) {
      part.rows.neighbour.push_back(all.neighbour[k]);
      part.rows.block.push_back(all.block[k]);
      part.interpolated.push_back(in_layer[all.neighbour[k]] ? 0.0 : 1.0);
    }
    part.rows.first.push_back(static_cast<std::int32_t>(part.rows.neighbour.size()));
  }
  for (auto* part : {&slow_, &fast_}) {
    part->a_x.resize(part->rows.size());
    part->a_y.resize(part->rows.size());
  }
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
  start_contact(contact_, interface_);
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

void Stepper::compute_irregular(IrregularRows& part, double remaining_s) {
  const auto& rows = part.rows;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double x = 0, y = 0;
    for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      const auto n = rows.neighbour[k];
      const double lead = damping_s_ - remaining_s * part.interpolated[k];
      const double w_x = u_.x[n] + lead * v_.x[n];
      const double w_y = u_.y[n] + lead * v_.y[n];
      const auto& b = rows.block[k];
      x += b[0] * w_x + b[1] * w_y;
      y += b[2] * w_x + b[3] * w_y;
    }
    part.a_x[r] = x;
    part.a_y[r] = y;
  }
}

void Stepper::apply_irregular(const IrregularRows& part, double dt) {
  for (std::size_t r = 0; r < part.rows.size(); ++r) {
    const auto n = part.rows.node[r];
    v_.x[n] -= dt * part.a_x[r];
    v_.y[n] -= dt * part.a_y[r];
    if (part.in_contact[r]) continue;
    u_.x[n] += dt * v_.x[n];
    u_.y[n] += dt * v_.y[n];
  }
}

void Stepper::sweep(int first_row, int last_row, double dt, double remaining_s, const double* w_last_row) {
  const int stride = plate_.grid.stride();
  const auto interior = solid::scaled(plate_.interior, -dt);
  const auto lower_edge = solid::scaled(plate_.lower_edge, -dt);
  const auto w_row = [&](int j) {
    double* row = w_.data() + static_cast<std::ptrdiff_t>(j % 3) * 2 * stride;
    return solid::ConstRow{row, row + stride};
  };
  // u + beta_R v; the row above the layer stands `remaining_s` ahead of a sub-step and is taken back to its
  // time.
  const auto fill = [&](int j) {
    const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(j) * stride;
    const double lead = j == last_row ? damping_s_ - remaining_s : damping_s_;
    double* row = w_.data() + static_cast<std::ptrdiff_t>(j % 3) * 2 * stride;
    if (j == last_row && w_last_row != nullptr) {
      std::copy(w_last_row, w_last_row + 2 * stride, row);
    } else {
      solid::combine_row(stride, lead, &u_.x[o], &u_.y[o], &v_.x[o], &v_.y[o], row, row + stride);
    }
  };
  if (first_row > 0) fill(first_row - 1);
  if (first_row < last_row) fill(first_row);
  for (int j = first_row; j < last_row; ++j) {
    fill(j + 1);
    const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(j) * stride;
    for (const auto span : plate_.spans[j]) {
      if (j == 0) {
        solid::add_lower_row(lower_edge, span, w_row(0), w_row(1), &v_.x[o], &v_.y[o]);
      } else {
        solid::add_interior_row(interior, span, w_row(j - 1), w_row(j), w_row(j + 1), &v_.x[o], &v_.y[o]);
        solid::move_row(span, dt, &v_.x[o], &v_.y[o], &u_.x[o], &u_.y[o]);
      }
    }
  }
}

void Stepper::advance(Recorder& recorder, fronts::History* sample) {
  // Block rows read the old motion of their neighbours, so they are computed before and applied after the
  // sweep. The first sub-step of the layer, too, sees the motion before the step; with it, one sub-step is
  // the plain scheme.
  compute_irregular(slow_, 0);
  compute_irregular(fast_, 0);
  const int stride = plate_.grid.stride();
  const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(layer_rows_) * stride;
  solid::combine_row(stride, damping_s_, &u_.x[o], &u_.y[o], &v_.x[o], &v_.y[o], w_above_layer_.data(),
                     w_above_layer_.data() + stride);
  sweep(layer_rows_, plate_.grid.rows, step_s_, 0, nullptr);
  apply_irregular(slow_, step_s_);
  for (const auto n : top_) u_.x[n] += step_s_ * v_.x[n];

  for (int k = 0; k < substeps_; ++k) take_substep(k, recorder, k == 0 ? sample : nullptr);
  ++step_;
}

void Stepper::take_substep(int k, Recorder& recorder, fronts::History* sample) {
  const double dt = substep_s();
  const double remaining = step_s_ - k * dt;
  const double time = time_s() + k * dt;
  if (k > 0) compute_irregular(fast_, remaining);
  sweep(0, layer_rows_, dt, remaining, k == 0 ? w_above_layer_.data() : nullptr);
  apply_irregular(fast_, dt);

  for (std::size_t i = 0; i < lower_.size(); ++i) {
    const auto n = lower_[i];
    interface_.v_x_m_per_s[i] = v_.x[n];
    interface_.v_y_m_per_s[i] = v_.y[n];
    interface_.u_y_m[i] = u_.y[n];
  }
  const double impulse_s = dt * trigger_factor(trigger_, time);
  for (const auto i : trigger_nodes_)
    interface_.v_x_m_per_s[i] += impulse_s * trigger_force_N_[i] / lower_mass_kg_[i];
  const bool changed = interface::update_contact(contact_, dt, interface_);
  recorder.observe(time, interface_, changed);
  if (sample != nullptr) append_sample(*sample);
  for (std::size_t i = 0; i < lower_.size(); ++i) {
    const auto n = lower_[i];
    v_.x[n] = interface_.v_x_m_per_s[i];
    v_.y[n] = interface_.v_y_m_per_s[i];
    u_.x[n] += dt * v_.x[n];
    u_.y[n] = interface_.u_y_m[i] + dt * v_.y[n];
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
