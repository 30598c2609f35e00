// SPDX-License-Identifier: BSD-3-Clause
#include "solve/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "solid/element.hpp"
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

/// Least damping beta_R with which blocks take steps of their own, in steps of the lowest one. Undamped, the
/// coupling feeds resonant modes, which grow by some thousandths in a step; 0.02 was enough wherever it was
/// tried (docs/graded.md).
constexpr double least_damping_in_steps = 0.05;

/// The block to which each cell belongs; the transition between two blocks belongs to the lower one. All
/// cells of a mesh that knows no grid are in one block.
std::vector<int> block_of_cells(const mesh::Mesh& mesh) {
  const auto grids = mesh::blocks(mesh);
  std::vector<int> block;
  for (const auto& cell : mesh.cells) {
    const auto lowest = *std::ranges::min_element(cell);
    const auto above = std::ranges::upper_bound(grids, lowest, {}, &mesh::Grid::first);
    block.push_back(static_cast<int>(above - grids.begin()) - 1);
  }
  return block;
}

}  // namespace

void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time) {
  if (mesh.grid.columns == 0 || time.interface_rows < mesh.grid.rows) return;
  if (!mesh.coarser.empty())
    throw UserError(
        "time.interface_rows = {} does not fit below the larger elements above {} rows; choose fewer, or a "
        "larger plate.fine_height_m",
        time.interface_rows, mesh.grid.rows);
  throw UserError(
      "time.interface_rows = {} does not fit below the loaded edge of a mesh of {} rows; choose fewer",
      time.interface_rows, mesh.grid.rows);
}

Stepper::Stepper(const mesh::Mesh& mesh, const solid::Material& material,
                 const interface::ContactModel& contact, const TimeStepping& time)
    : plate_(solid::make_operator(mesh, material)),
      damping_s_(material.stiffness_damping_s),
      contact_(contact),
      substeps_(time.interface_substeps),
      lower_(mesh.lower),
      tributary_m_(mesh::tributary_lengths_m(mesh)),
      v_x_before_(mesh.lower.size()),
      v_y_before_(mesh.lower.size()),
      v_y_trial_(mesh.lower.size()),
      interface_(mesh.lower.size()),
      trigger_force_N_(mesh.lower.size(), 0.0),
      u_(mesh.n_nodes()),
      v_(mesh.n_nodes()),
      start_u_(mesh.lower.size()),
      w_(mesh.grid.stride()) {
  require_rows_fit(mesh, time);
  stable_step_s_ = solid::stable_step_s(solid::largest_frequency_rad_per_s(plate_), damping_s_);
  const auto multiples = choose_multiples(mesh, material, time);
  multiple_ = multiples.back();
  substeps_ *= multiple_;
  step_s_ = time.step_factor * stable_step_s_ * multiple_;
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    interface_.initial_gap_m[k] = mesh.y_m[lower_[k]];
    interface_.mass_per_length_kg_m2[k] = plate_.mass_kg[lower_[k]] / tributary_m_[k];
    lower_mass_kg_.push_back(plate_.mass_kg[lower_[k]]);
  }
  contact_mass_kg_ = lower_mass_kg_;
  interior_mass_kg_ = material.density_kg_per_m3 * mesh.grid.spacing_m * mesh.grid.spacing_m;
  if (contact.algorithm == interface::ContactAlgorithm::predictor_corrector) {
    lower_rows_ = solid::assemble_rows(mesh, material, lower_);
    landing_shift_m_.assign(mesh.n_nodes(), 0.0);
  }
  divide_cells(mesh, material, time, multiples);
}

std::vector<int> Stepper::choose_multiples(const mesh::Mesh& mesh, const solid::Material& material,
                                           const TimeStepping& time) const {
  std::vector<int> multiples(1 + mesh.coarser.size(), 1);
  const bool damped = damping_s_ >= least_damping_in_steps * time.step_factor * stable_step_s_;
  if (!time.local_steps || mesh.coarser.empty() || !damped) return multiples;
  // The largest frequency of its free cells bounds a block's from above. Squares do so the more closely the
  // more of them there are: what the lowest block's squares show is no more than what larger ones would.
  const double h = mesh.grid.spacing_m;
  const double of_square = solid::cell_frequency_rad_per_s({0, 0, h, 0, h, h, 0, h}, material);
  const double overestimate = std::max(1.0, stable_step_s_ / solid::stable_step_s(of_square, damping_s_));
  const auto block_of_cell = block_of_cells(mesh);
  for (std::size_t b = 1; b < multiples.size(); ++b) {
    std::vector<bool> in_block;
    for (const int of_cell : block_of_cell) in_block.push_back(of_cell == static_cast<int>(b));
    const double omega = solid::largest_cell_frequency_rad_per_s(mesh, material, in_block);
    const double ratio = overestimate * solid::stable_step_s(omega, damping_s_) / stable_step_s_;
    for (multiples[b] = 1 << b; multiples[b] > ratio * (1 + 1e-9) && multiples[b] > 1;) multiples[b] /= 2;
  }
  for (std::size_t b = multiples.size() - 1; b > 0; --b)
    multiples[b - 1] = std::min(multiples[b - 1], multiples[b]);
  return multiples;
}

void Stepper::divide_cells(const mesh::Mesh& mesh, const solid::Material& material, const TimeStepping& time,
                           std::span<const int> multiples) {
  // Levels by their steps, those of the blocks and that of the interface rows.
  const bool layered = time.interface_substeps > 1;
  std::vector<int> periods;
  for (const int multiple : multiples)
    if (const int period = multiple * time.interface_substeps; periods.empty() || periods.back() != period)
      periods.push_back(period);
  if (layered) periods.insert(periods.begin(), 1);
  std::ranges::reverse(periods);
  levels_.resize(periods.size());
  std::vector<int> level_of_cell = block_of_cells(mesh);
  for (int& of_cell : level_of_cell) {
    const int period = multiples[of_cell] * time.interface_substeps;
    of_cell = static_cast<int>(std::ranges::find(periods, period) - periods.begin());
  }
  if (layered) {
    const auto near = cells_next_to_interface(mesh, time.interface_rows);
    for (std::size_t c = 0; c < near.size(); ++c)
      if (near[c]) level_of_cell[c] = static_cast<int>(levels_.size()) - 1;
  }
  // A node moves with the finest of its cells.
  std::vector<int> level_of_node(mesh.n_nodes(), -1);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto n : mesh.cells[c]) level_of_node[n] = std::max(level_of_node[n], level_of_cell[c]);
  std::vector<bool> in_contact(mesh.n_nodes(), false), is_shared(mesh.n_nodes(), false);
  for (const auto n : lower_) in_contact[n] = true;

  for (std::size_t l = 0; l < levels_.size(); ++l) {
    auto& level = levels_[l];
    level.period = periods[l];
    level.step_s = step_s_ * level.period / substeps_;
    std::vector<bool> in_level(mesh.cells.size());
    for (std::size_t c = 0; c < in_level.size(); ++c) in_level[c] = level_of_cell[c] == static_cast<int>(l);
    const int edge_row = layered ? time.interface_rows : 0;
    level.part =
        levels_.size() > 1 ? solid::make_part(mesh, material, plate_, in_level, edge_row) : plate_.whole;
    for (const auto n : mesh.top)
      if (level_of_node[n] == static_cast<int>(l)) level.top.push_back(n);
    auto& irregular = level.irregular;
    irregular = level.part.irregular.node;
    irregular.insert(irregular.end(), level.part.general.node().begin(), level.part.general.node().end());
    level.general_space = level.part.general.workspace();
    std::vector<std::int32_t> irregular_row(mesh.n_nodes(), -1);
    for (std::size_t r = 0; r < irregular.size(); ++r)
      irregular_row[irregular[r]] = static_cast<std::int32_t>(r);
    std::vector<bool> shared(mesh.n_nodes(), false), in_cells(mesh.n_nodes(), false);
    for (std::size_t c = 0; c < in_level.size(); ++c)
      if (in_level[c])
        for (const auto n : mesh.cells[c]) in_cells[n] = true;
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
    for (const auto& row : level.part.stencil)
      if (row.squares != solid::Squares::all)
        level.edge_kick_m_per_s.emplace_back(2 * static_cast<std::size_t>(mesh.grid.stride()));
    for (const auto n : irregular) {
      level.takes_push.push_back(!shared[n]);
      level.moves.push_back(!in_contact[n] && !is_shared[n]);
    }
    const auto used = [&](auto from, auto to) { return std::find(from, to, true) - from; };
    level.node_begin = used(in_cells.begin(), in_cells.end());
    level.node_end = in_cells.size() - used(in_cells.rbegin(), in_cells.rend());
    std::vector<mesh::Node> top;
    for (const auto n : mesh.top)
      if (in_cells[n]) top.push_back(n);
    level.top_rows = solid::assemble_rows(mesh, material, top, {}, in_level);
    level.top_force_N.resize(top.size());
    level.a_x.resize(irregular.size());
    level.a_y.resize(irregular.size());
  }
  set_dashpots(mesh, material, level_of_node);
  for (const int l : level_of_node) node_step_s_.push_back(l < 0 ? 0 : levels_[l].step_s);
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (level_of_node[n] >= 0 && !plate_.is_top[n])
      node_updates_per_step_ += substeps_ / levels_[level_of_node[n]].period;
}

void Stepper::set_dashpots(const mesh::Mesh& mesh, const solid::Material& material,
                           std::span<const int> level_of_node) {
  const double c_L = solid::longitudinal_speed_m_per_s(material), c_S = solid::shear_speed_m_per_s(material);
  const auto place = [](const std::vector<mesh::Node>& nodes, mesh::Node n) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(nodes, n);
    if (found == nodes.end()) return std::nullopt;
    return static_cast<std::size_t>(found - nodes.begin());
  };
  for (const auto& [n, side_m, top_m] : mesh.absorbing) {
    const std::size_t l = level_of_node[n];
    auto& level = levels_[l];
    const double factor = 0.5 * level.step_s * material.density_kg_per_m3 / plate_.mass_kg[n];
    Dashpot dashpot{0, n, factor * (c_L * side_m + c_S * top_m), factor * (c_S * side_m + c_L * top_m)};
    if (const auto i = place(lower_, n)) {
      dashpot.at = *i;
      contact_mass_kg_[*i] *= 1 + dashpot.d_y;
      interface_.mass_per_length_kg_m2[*i] *= 1 + dashpot.d_y;
      interface_.tangential_mass_ratio[*i] = (1 + dashpot.d_x) / (1 + dashpot.d_y);
      contact_dashpots_.push_back(dashpot);
      continue;
    }
    if (const auto k = l > 0 ? place(levels_[l - 1].shared.node, n) : std::nullopt) {
      dashpot.at = *k;
      levels_[l - 1].shared.dashpots.push_back(dashpot);
      continue;
    }
    const auto row = place(level.irregular, n);
    SLIPFRONT_ASSERT(row, "an absorbing node without a block row");
    dashpot.at = *row;
    level.takes_push[*row] = false;
    level.dashpots.push_back(dashpot);
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
    interface_.v_x_m_per_s[k] = v_.x[lower_[k]];
    interface_.v_y_m_per_s[k] = v_.y[lower_[k]];
    interface_.t_Pa[k] = equilibrium.tractions.t_s_Pa[k];
    interface_.p_Pa[k] = equilibrium.tractions.p_s_Pa[k];
    interface_.slipping[k] = equilibrium.contact[k] == Contact::slip;
  }
  for (auto& level : levels_) {
    // The first look at the forces gives their steady part; it must not move anything.
    auto& shared = level.shared;
    if (shared.node.empty()) continue;
    const solid::Field u = u_, v = v_;
    const auto zero = solid::Field(shared.node.size());
    shared.steady_m_per_s2 = shared.v_last_m_per_s = shared.v_mean_before_m_per_s = zero;
    shared.a_m_per_s2 = zero;
    set_motion_before(level);
    push(level);
    for (std::size_t k = 0; k < shared.node.size(); ++k) {
      shared.steady_m_per_s2.x[k] = shared.push_m_per_s.x[k] / level.step_s;
      shared.steady_m_per_s2.y[k] = shared.push_m_per_s.y[k] / level.step_s;
    }
    u_ = u;
    v_ = v;
    shared.push_m_per_s = shared.a_m_per_s2 = zero;
    set_motion_before(level);
  }
  std::ranges::fill(interface_.intact, 1.0);
  start_contact(contact_, interface_);
  set_trigger({}, std::vector<double>(lower_.size(), 0.0));
  prestress_t_Pa_.clear();
  prestress_p_Pa_.clear();
  works_ = {};
  step_ = 0;
  if (damping_s_ > 0) begin_damping_work();
}

void Stepper::begin_damping_work() {
  solid::Field before(u_.size());
  for (auto& level : levels_) {
    for (std::size_t n = level.node_begin; n < level.node_end; ++n) {
      before.x[n] = u_.x[n] - level.step_s * v_.x[n];
      before.y[n] = u_.y[n] - level.step_s * v_.y[n];
    }
    stiffness_product(level, before, scratch_);
    level.products = {.u_K_u = inner_product(level, scratch_, before, before)};
  }
}

void Stepper::set_motion_before(Level& level) {
  auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    s.u_before_m.x[k] = u_.x[n] - level.step_s * v_.x[n];
    s.u_before_m.y[k] = u_.y[n] - level.step_s * v_.y[n];
    s.v_last_m_per_s.x[k] = v_.x[n];
    s.v_last_m_per_s.y[k] = v_.y[n];
  }
}

void Stepper::set_trigger(const interface::Trigger& trigger, std::vector<double> force_N_per_m) {
  trigger_ = trigger;
  trigger_force_N_ = std::move(force_N_per_m);
  trigger_nodes_.clear();
  for (std::size_t i = 0; i < trigger_force_N_.size(); ++i)
    if (trigger_force_N_[i] != 0) trigger_nodes_.push_back(i);
}

void Stepper::set_prestress(std::vector<double> t0_Pa, std::vector<double> p0_Pa) {
  SLIPFRONT_ASSERT(t0_Pa.size() == lower_.size() && p0_Pa.size() == lower_.size(),
                   "prestress of other nodes");
  prestress_t_Pa_ = std::move(t0_Pa);
  prestress_p_Pa_ = std::move(p0_Pa);
}

void Stepper::set_intact(std::vector<double> intact) {
  SLIPFRONT_ASSERT(intact.size() == lower_.size(), "intact of other nodes");
  interface_.intact = std::move(intact);
}

void Stepper::compute_irregular(Level& level) {
  const auto w = [&](mesh::Node n) {
    return solid::Pair{u_.x[n] + damping_s_ * v_.x[n], u_.y[n] + damping_s_ * v_.y[n]};
  };
  solid::for_each_row_product(level.part.irregular, w, [&](std::size_t r, double x, double y) {
    level.a_x[r] = x;
    level.a_y[r] = y;
  });
  const std::size_t n_block_rows = level.part.irregular.size();
  level.part.general.multiply(u_, damping_s_, v_, level.general_space, level.a_x.data() + n_block_rows,
                              level.a_y.data() + n_block_rows);
  solid::for_each_row_product(level.top_rows, w, [&](std::size_t r, double x, double y) {
    level.top_force_N[r] = {x, y};
    works_.top_work += level.step_s * x * v_.x[level.top_rows.node[r]];
  });
}

void Stepper::damp(const Dashpot& dashpot, double before_x, double before_y, double& trial_x,
                   double& trial_y) {
  const auto [at, node, d_x, d_y] = dashpot;
  const double mean_x = 0.5 * (before_x + trial_x) / (1 + d_x);
  const double mean_y = 0.5 * (before_y + trial_y) / (1 + d_y);
  trial_x -= 2 * d_x * mean_x;
  trial_y -= 2 * d_y * mean_y;
  works_.boundary_work -= 2 * plate_.mass_kg[node] * (d_x * mean_x * mean_x + d_y * mean_y * mean_y);
}

void Stepper::apply_irregular(const Level& level) {
  for (const auto& dashpot : level.dashpots) {
    const auto n = dashpot.node;
    double v_x = v_.x[n] - level.step_s * level.a_x[dashpot.at];
    double v_y = v_.y[n] - level.step_s * level.a_y[dashpot.at];
    damp(dashpot, v_.x[n], v_.y[n], v_x, v_y);
    v_.x[n] = v_x;
    v_.y[n] = v_y;
    u_.x[n] += level.step_s * v_x;
    u_.y[n] += level.step_s * v_y;
  }
  const auto& node = level.irregular;
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

Stepper::ForceProducts Stepper::sweep(Level& level) {
  const int stride = plate_.grid.stride();
  const double dt = level.step_s;
  const auto w_row = [&](int j) { return solid::ConstRow{w_.x(j), w_.y(j)}; };
  // Rows of w = u + beta_R v are filled just before the first row that reads them moves.
  int next = 0;
  const auto fill_to = [&](const mesh::Grid& grid, int first, int last) {
    for (next = std::max(next, first); next <= last; ++next) {
      const std::ptrdiff_t o = grid.node(0, next);
      solid::combine_row(grid.stride(), damping_s_, &u_.x[o], &u_.y[o], &v_.x[o], &v_.y[o], w_.x(next),
                         w_.y(next));
    }
  };
  solid::KickSums sums;
  ForceProducts products;
  const auto take_sums = [&](double scale) {
    const double m_over_dt = interior_mass_kg_ / (dt * scale);
    products.u_K_w -= m_over_dt * (sums.w_d - damping_s_ * sums.v_d);
    products.v_K_w -= m_over_dt * sums.v_d;
    products.after_K_w -= m_over_dt * (sums.v_d + sums.d_d);
    sums = {};
  };
  auto edge_kick = level.edge_kick_m_per_s.begin();
  int block_before = -1;
  double scale_before = 1;
  for (const auto& [j, squares, scale, spans, block] : level.part.stencil) {
    const auto& grid = plate_.blocks[block];
    if (block != block_before) {
      if (block_before >= 0) take_sums(scale_before);
      block_before = block;
      next = 0;
    }
    if (squares == solid::Squares::all) scale_before = scale;
    const auto interior = solid::scaled(plate_.interior, -dt * scale);
    const std::ptrdiff_t o = grid.node(0, j);
    double* v_x = &v_.x[o];
    double* v_y = &v_.y[o];
    fill_to(grid, squares == solid::Squares::above ? j : j - 1, squares == solid::Squares::below ? j : j + 1);
    if (squares == solid::Squares::all) {
      const auto push_row = damping_s_ > 0 ? solid::push_interior_row<true> : solid::push_interior_row<false>;
      for (const auto span : spans)
        push_row(interior, span, dt, w_row(j - 1), w_row(j), w_row(j + 1), v_x, v_y, &u_.x[o], &u_.y[o],
                 sums);
      continue;
    }
    const auto above = solid::scaled(plate_.edge, -dt * scale);
    const auto edge = squares == solid::Squares::above ? above : solid::mirrored(above);
    const auto inner = w_row(squares == solid::Squares::above ? j + 1 : j - 1);
    std::ranges::fill(*edge_kick, 0.0);
    double* kick_x = edge_kick->data();
    double* kick_y = kick_x + stride;
    for (const auto span : spans) solid::add_edge_row(edge, span, w_row(j), inner, kick_x, kick_y);
    ++edge_kick;
    if (damping_s_ > 0)
      for (const auto span : spans) {
        const double* mass = &plate_.mass_kg[o];
        const solid::ConstRow kick{kick_x, kick_y};
        products.u_K_w -= solid::row_product(span, mass, kick, {&u_.x[o], &u_.y[o]}) / dt;
        products.v_K_w -= solid::row_product(span, mass, kick, {v_x, v_y}) / dt;
      }
    // Nodes shared with the next level get the kick as a push; the others wait for the contact update or for
    // the level before.
    if (squares == solid::Squares::above && j > 0) continue;
    for (const auto span : spans) solid::move_row(span, 1, kick_x, kick_y, v_x, v_y);
  }
  take_sums(scale_before);
  return products;
}

void Stepper::gather_push(Level& level) {
  const int stride = plate_.grid.stride();
  auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto r = s.irregular_row[k];
    const auto column = s.node[k] % stride;
    const double x = r < 0 ? level.edge_kick_m_per_s[0][column] : -level.step_s * level.a_x[r];
    const double y = r < 0 ? level.edge_kick_m_per_s[0][stride + column] : -level.step_s * level.a_y[r];
    s.a_m_per_s2.x[k] = -x / level.step_s;
    s.a_m_per_s2.y[k] = -y / level.step_s;
    s.push_m_per_s.x[k] = x - level.step_s * s.steady_m_per_s2.x[k];
    s.push_m_per_s.y[k] = y - level.step_s * s.steady_m_per_s2.y[k];
  }
}

void Stepper::move_shared(Level& coarser, double dt) {
  auto& s = coarser.shared;
  for (const auto& dashpot : s.dashpots) {
    const auto k = dashpot.at;
    const auto n = dashpot.node;
    const double kick_x = dt * s.steady_m_per_s2.x[k] + s.push_m_per_s.x[k];
    const double kick_y = dt * s.steady_m_per_s2.y[k] + s.push_m_per_s.y[k];
    double v_x = v_.x[n] + kick_x, v_y = v_.y[n] + kick_y;
    damp(dashpot, s.v_last_m_per_s.x[k], s.v_last_m_per_s.y[k], v_x, v_y);
    v_.x[n] = v_x - kick_x;
    v_.y[n] = v_y - kick_y;
  }
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    const double kick_x = dt * s.steady_m_per_s2.x[k] + s.push_m_per_s.x[k];
    const double kick_y = dt * s.steady_m_per_s2.y[k] + s.push_m_per_s.y[k];
    v_.x[n] += kick_x;
    v_.y[n] += kick_y;
    const double half_mass = 0.5 * plate_.mass_kg[n];
    works_.coupling_work +=
        half_mass * (kick_x * (v_.x[n] + s.v_last_m_per_s.x[k]) + kick_y * (v_.y[n] + s.v_last_m_per_s.y[k]));
    s.v_last_m_per_s.x[k] = v_.x[n];
    s.v_last_m_per_s.y[k] = v_.y[n];
    u_.x[n] += dt * v_.x[n];
    u_.y[n] += dt * v_.y[n];
    s.push_m_per_s.x[k] = s.push_m_per_s.y[k] = 0;
  }
}

void Stepper::push(Level& level) {
  exchange_velocities(level);
  if (!level.shared.node.empty()) add_coupling_work(level);
  const double after_K_w = level.products.after_K_w + late_product(level);
  auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    s.u_before_m.x[k] = u_.x[s.node[k]];
    s.u_before_m.y[k] = u_.y[s.node[k]];
  }
  compute_irregular(level);
  const auto sums = sweep(level);
  if (damping_s_ > 0) add_damping_work(level, after_K_w, sums);
  gather_push(level);
  restore_velocities(level);
}

void Stepper::exchange_velocities(const Level& level) {
  const auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    v_.x[n] = (u_.x[n] - s.u_before_m.x[k]) / level.step_s;
    v_.y[n] = (u_.y[n] - s.u_before_m.y[k]) / level.step_s;
  }
}

void Stepper::restore_velocities(const Level& level) {
  const auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    v_.x[s.node[k]] = s.v_last_m_per_s.x[k];
    v_.y[s.node[k]] = s.v_last_m_per_s.y[k];
  }
}

double Stepper::coupling_work(const Level& level) const {
  // What the level's force at its last push has not done through the mean velocities around it; the works of
  // its parts through the sub-steps' velocities are summed as they happen.
  const auto& s = level.shared;
  double work = 0;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    const double impulse = 0.5 * level.step_s * plate_.mass_kg[n];
    work += impulse * (s.a_m_per_s2.x[k] * (s.v_mean_before_m_per_s.x[k] + v_.x[n]) +
                       s.a_m_per_s2.y[k] * (s.v_mean_before_m_per_s.y[k] + v_.y[n]));
  }
  return work;
}

double Stepper::inner_product(const Level& level, const solid::Field& a, const solid::Field& w,
                              const solid::Field& z) const {
  double sum = 0;
  for (std::size_t n = level.node_begin; n < level.node_end; ++n)
    sum += plate_.mass_kg[n] * (z.x[n] * a.x[n] + z.y[n] * a.y[n]);
  solid::for_each_row_product(level.top_rows, w, [&](std::size_t r, double x, double y) {
    sum += z.x[level.top_rows.node[r]] * x + z.y[level.top_rows.node[r]] * y;
  });
  return sum;
}

void Stepper::stiffness_product(const Level& level, const solid::Field& w, solid::Field& a) const {
  a.x.resize(w.size());
  a.y.resize(w.size());
  std::fill(a.x.begin() + static_cast<std::ptrdiff_t>(level.node_begin),
            a.x.begin() + static_cast<std::ptrdiff_t>(level.node_end), 0.0);
  std::fill(a.y.begin() + static_cast<std::ptrdiff_t>(level.node_begin),
            a.y.begin() + static_cast<std::ptrdiff_t>(level.node_end), 0.0);
  solid::add_part(plate_, level.part, w, a);
}

double Stepper::late_product(const Level& level) const {
  if (damping_s_ == 0) return 0;
  double sum = 0;
  const auto& irregular = level.irregular;
  for (std::size_t r = 0; r < irregular.size(); ++r)
    sum += plate_.mass_kg[irregular[r]] *
           (v_.x[irregular[r]] * level.a_x[r] + v_.y[irregular[r]] * level.a_y[r]);
  const int stride = plate_.grid.stride();
  auto edge_kick = level.edge_kick_m_per_s.begin();
  for (const auto& row : level.part.stencil) {
    if (row.squares == solid::Squares::all) continue;
    const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(row.row) * stride;
    const double* kick_x = edge_kick->data();
    const double* kick_y = kick_x + stride;
    ++edge_kick;
    for (const auto span : row.spans)
      sum -=
          solid::row_product(span, &plate_.mass_kg[o], {kick_x, kick_y}, {&v_.x[o], &v_.y[o]}) / level.step_s;
  }
  for (std::size_t r = 0; r < level.top_rows.size(); ++r) {
    const auto n = level.top_rows.node[r];
    sum += v_.x[n] * level.top_force_N[r].x + v_.y[n] * level.top_force_N[r].y;
  }
  return sum;
}

void Stepper::add_damping_work(Level& level, double after_K_w, ForceProducts sums) {
  const auto& irregular = level.irregular;
  for (std::size_t r = 0; r < irregular.size(); ++r) {
    const auto n = irregular[r];
    sums.u_K_w += plate_.mass_kg[n] * (u_.x[n] * level.a_x[r] + u_.y[n] * level.a_y[r]);
    sums.v_K_w += plate_.mass_kg[n] * (v_.x[n] * level.a_x[r] + v_.y[n] * level.a_y[r]);
  }
  for (std::size_t r = 0; r < level.top_rows.size(); ++r) {
    const auto n = level.top_rows.node[r];
    sums.u_K_w += u_.x[n] * level.top_force_N[r].x + u_.y[n] * level.top_force_N[r].y;
    sums.v_K_w += v_.x[n] * level.top_force_N[r].x + v_.y[n] * level.top_force_N[r].y;
  }
  auto& last = level.products;
  const double dt = level.step_s, beta = damping_s_;
  // With u' = u + dt v', v' the velocity after the last push: three unknowns, v' K u, v' K v', u' K u', in
  // u' K w' = u' K u' + beta u' K v', v' K w' = v' K u + (dt + beta) v' K v', and u' K u' itself. A landing
  // has shifted u' besides.
  const double v_K_w = sums.v_K_w - last.shift_K_v;
  const double u_K_w = sums.u_K_w - last.shift_K_u - beta * last.shift_K_v;
  const double after_K_u = (u_K_w - last.u_K_u - dt * v_K_w) / (dt + beta);
  if (last.begun) works_.damping_work += damping_work(level, after_K_w, after_K_u);
  last.begun = true;
  last.v_K_v = (v_K_w - after_K_u) / (dt + beta);
  last.u_K_u = sums.u_K_w - beta * (after_K_u + dt * last.v_K_v + last.shift_K_v);
  last.shift_K_u = last.shift_K_v = 0;
  last.after_K_w = sums.after_K_w;
}

double Stepper::damping_work(const Level& level, double after_K_w, double after_K_u) const {
  // dt f v' with the damping force f = -beta K v and the mean velocity; beta v' K v = v' K w - v' K u.
  return -0.5 * level.step_s * (damping_s_ * level.products.v_K_v + after_K_w - after_K_u);
}

void Stepper::add_coupling_work(Level& level) {
  auto& s = level.shared;
  works_.coupling_work += coupling_work(level);
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    s.v_mean_before_m_per_s.x[k] = v_.x[s.node[k]];
    s.v_mean_before_m_per_s.y[k] = v_.y[s.node[k]];
  }
}

Energies Stepper::energies() {
  Energies e = works_;
  e.time_s = time_s();
  e.kinetic = kinetic_energy_J_per_m();
  for (auto& level : levels_) {
    exchange_velocities(level);
    stiffness_product(level, u_, scratch_);
    const double u_K_u = inner_product(level, scratch_, u_, u_);
    const double v_K_u = inner_product(level, scratch_, u_, v_);
    e.strain += 0.5 * (u_K_u - level.step_s * v_K_u);  // 1/2 u K u' between the level's last two places
    e.coupling_work += coupling_work(level);
    if (level.products.begun) {
      // u' K u' = u K u + dt v' K (u + u'), v' the velocity after the last push.
      const auto& last = level.products;
      const double after_K_u =
          (u_K_u - last.shift_K_u - last.u_K_u) / level.step_s - (v_K_u - last.shift_K_v);
      e.damping_work += damping_work(level, last.after_K_w + late_product(level), after_K_u);
    }
    restore_velocities(level);
  }
  return e;
}

void Stepper::advance_substep(int k, Recorder& recorder, fronts::History* sample) {
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
  take_contact(time_s() + k * substep_s(), recorder, sample);
}

void Stepper::advance(Recorder& recorder, fronts::History* sample) {
  for (int k = 0; k < substeps_; ++k) advance_substep(k, recorder, k == 0 ? sample : nullptr);
  ++step_;
}

void Stepper::reverse(Recorder& recorder) {
  // All cells push at the beginning of a step: the motion back begins with the velocities after these pushes,
  // at the places before them. It keeps the steady forces on shared nodes, without which it would be another.
  const auto u = u_;
  advance_substep(0, recorder, nullptr);
  u_ = u;
  const auto negate = [](std::vector<double>& values) {
    for (double& value : values) value = -value;
  };
  for (auto* v : {&v_.x, &v_.y, &interface_.v_x_m_per_s, &interface_.v_y_m_per_s,
                  &interface_.slip_rate_m_per_s, &interface_.acceleration_m_per_s2})
    negate(*v);
  for (auto& level : levels_) {
    set_motion_before(level);
    level.shared.a_m_per_s2 = solid::Field(level.shared.node.size());
  }
  works_ = {};
  works_.time_s = time_s();
  if (damping_s_ > 0) begin_damping_work();
}

void Stepper::take_contact(double time, Recorder& recorder, fronts::History* sample) {
  const double dt = substep_s();
  std::ranges::copy(interface_.v_x_m_per_s, v_x_before_.begin());
  std::ranges::copy(interface_.v_y_m_per_s, v_y_before_.begin());
  for (std::size_t i = 0; i < lower_.size(); ++i) {
    const auto n = lower_[i];
    interface_.v_x_m_per_s[i] = v_.x[n];
    interface_.v_y_m_per_s[i] = v_.y[n];
    interface_.u_y_m[i] = u_.y[n];
  }
  const double impulse_s = dt * trigger_factor(trigger_, time);
  for (const auto i : trigger_nodes_)
    interface_.v_x_m_per_s[i] += impulse_s * trigger_force_N_[i] / lower_mass_kg_[i];
  for (std::size_t i = 0; i < prestress_t_Pa_.size(); ++i) {
    const double per_pressure = dt * tributary_m_[i] / lower_mass_kg_[i];
    interface_.v_x_m_per_s[i] += per_pressure * prestress_t_Pa_[i];
    interface_.v_y_m_per_s[i] -= per_pressure * prestress_p_Pa_[i];
  }
  for (const auto& [i, n, d_x, d_y] : contact_dashpots_) {
    // The contact's tractions act on the effective mass m (1 + d).
    interface_.v_x_m_per_s[i] = (interface_.v_x_m_per_s[i] - d_x * v_x_before_[i]) / (1 + d_x);
    interface_.v_y_m_per_s[i] = (interface_.v_y_m_per_s[i] - d_y * v_y_before_[i]) / (1 + d_y);
  }
  std::ranges::copy(interface_.v_y_m_per_s, v_y_trial_.begin());
  const bool changed = interface::update_contact(contact_, dt, interface_);
  recorder.observe(time, interface_, changed);
  if (sample != nullptr) append_sample(*sample);
  double contact_work = 0;
  for (std::size_t i = 0; i < lower_.size(); ++i) {
    const auto n = lower_[i];
    // The impulse from the velocities: a landing by projection has no pressure.
    contact_work += 0.5 * contact_mass_kg_[i] * (interface_.v_y_m_per_s[i] - v_y_trial_[i]) *
                    (interface_.v_y_m_per_s[i] + v_y_before_[i]);
    v_.x[n] = interface_.v_x_m_per_s[i];
    v_.y[n] = interface_.v_y_m_per_s[i];
    u_.x[n] += dt * v_.x[n];
    if (const double shift_m = interface_.u_y_m[i] - u_.y[n]; shift_m != 0) {
      landing_shift_m_[n] = shift_m;
      landing_nodes_.push_back(i);
    }
    u_.y[n] = interface_.u_y_m[i] + dt * v_.y[n];
  }
  if (!landing_nodes_.empty()) contact_work += landing_work(dt);
  double friction_work = 0;
  for (std::size_t i = 0; i < lower_.size(); ++i)
    friction_work -=
        0.5 * dt * tributary_m_[i] * interface_.t_Pa[i] * (interface_.v_x_m_per_s[i] + v_x_before_[i]);
  for (const auto& [i, n, d_x, d_y] : contact_dashpots_) {
    const double mean_x = 0.5 * (interface_.v_x_m_per_s[i] + v_x_before_[i]);
    const double mean_y = 0.5 * (interface_.v_y_m_per_s[i] + v_y_before_[i]);
    works_.boundary_work -= 2 * lower_mass_kg_[i] * (d_x * mean_x * mean_x + d_y * mean_y * mean_y);
  }
  for (std::size_t i = 0; i < prestress_t_Pa_.size(); ++i)
    works_.prestress_work += 0.5 * dt * tributary_m_[i] *
                             (prestress_t_Pa_[i] * (interface_.v_x_m_per_s[i] + v_x_before_[i]) -
                              prestress_p_Pa_[i] * (interface_.v_y_m_per_s[i] + v_y_before_[i]));
  works_.friction_work += friction_work;
  works_.contact_work += contact_work;
  for (const auto i : trigger_nodes_)
    works_.trigger_work +=
        0.5 * impulse_s * trigger_force_N_[i] * (interface_.v_x_m_per_s[i] + v_x_before_[i]);
}

double Stepper::landing_work(double dt_s) {
  // A shift s between the places u, at which this sub-step's forces were taken, and u + s, from which it
  // moves to u'': of the strain energies 1/2 u K u' before and 1/2 u'' K (u + s) after, the kicks' works
  // leave open 1/2 s K (u + u''). All neighbours of the interface have moved by dt v.
  double s_K_u = 0, s_K_v = 0, s_K_s = 0;
  for (const auto i : landing_nodes_) {
    double u = 0, v = 0, s = 0;
    for (auto k = lower_rows_.first[i]; k < lower_rows_.first[i + 1]; ++k) {
      const auto n = lower_rows_.neighbour[k];
      const auto& b = lower_rows_.block[k];
      u += b[2] * u_.x[n] + b[3] * u_.y[n];
      v += b[2] * v_.x[n] + b[3] * v_.y[n];
      s += b[3] * landing_shift_m_[n];
    }
    const double shift_m = landing_shift_m_[lower_[i]];
    s_K_u += shift_m * u;
    s_K_v += shift_m * v;
    s_K_s += shift_m * s;
  }
  for (const auto i : landing_nodes_) landing_shift_m_[lower_[i]] = 0;
  landing_nodes_.clear();
  auto& products = levels_.back().products;
  products.shift_K_v = s_K_v;
  products.shift_K_u = 2 * s_K_u - s_K_s;
  return 0.5 * (2 * s_K_u - dt_s * s_K_v - s_K_s);
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

solid::Field Stepper::mean_velocity_m_per_s() const {
  solid::Field v = v_;
  for (const auto& level : levels_) {
    const auto& s = level.shared;
    for (std::size_t k = 0; k < s.node.size(); ++k) {
      v.x[s.node[k]] = (u_.x[s.node[k]] - s.u_before_m.x[k]) / level.step_s;
      v.y[s.node[k]] = (u_.y[s.node[k]] - s.u_before_m.y[k]) / level.step_s;
    }
  }
  return v;
}

double Stepper::kinetic_energy_J_per_m() const {
  return solid::kinetic_energy_J_per_m(plate_, v_);
}

double Stepper::energy_J_per_m() const {
  return solid::strain_energy_J_per_m(plate_, u_) + kinetic_energy_J_per_m();
}

}  // namespace slipfront::solve
