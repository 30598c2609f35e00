// SPDX-License-Identifier: BSD-3-Clause
#include "motion/level.hpp"

#include <algorithm>
#include <cmath>

#include "boundary/dashpot.hpp"

namespace slipfront::motion {

namespace {

std::ptrdiff_t row_start(const BodyMotion& body, int row) {
  return body.op.rows[row].first;
}

solid::ConstRow row_of(solid::RollingRows& w, int row) {
  return {w.x(row), w.y(row)};
}

/// Fills rows of w = u + beta_R v just before the first row that reads them moves.
class Filler {
 public:
  Filler(const BodyMotion& body, solid::RollingRows& w, int first) : body_(body), w_(w), next_(first) {}

  void fill(solid::Span rows) {
    for (next_ = std::max(next_, rows.begin); next_ < rows.end; ++next_) {
      const auto o = row_start(body_, next_);
      solid::combine_row(body_.op.rows[next_].count, body_.damping_s, &body_.u_m.x[o], &body_.u_m.y[o],
                         &body_.v_m_per_s.x[o], &body_.v_m_per_s.y[o], w_.x(next_), w_.y(next_));
      solid::repeat_row(body_.op.rows[next_], w_, next_);
    }
  }

 private:
  const BodyMotion& body_;
  solid::RollingRows& w_;
  int next_;
};

/// Sum of m (v . a) over a band's irregular nodes.
double irregular_product(const StepLevel& level, const Band& band, const BodyMotion& body) {
  double sum = 0;
  for (const auto& run : band.runs) {
    if (!run.is_owned) continue;
    const auto at = run.at, count = run.count;
    const auto first = run.first;
    const double* mass = &body.op.mass_kg[first];
    const double* v_x = &body.v_m_per_s.x[first];
    const double* v_y = &body.v_m_per_s.y[first];
    const double* a_x = &level.a_x[at];
    const double* a_y = &level.a_y[at];
#pragma omp simd reduction(+ : sum)
    for (std::size_t k = 0; k < count; ++k) sum += mass[k] * (v_x[k] * a_x[k] + v_y[k] * a_y[k]);
  }
  return sum;
}

/// Adds the products over a band's irregular nodes, and kicks and moves those that take the impulse.
void push_irregular(const StepLevel& level, const Band& band, BodyMotion& body, ImpulseProducts& products) {
  for (const auto& run : band.runs) {
    const auto at = run.at, count = run.count;
    const auto first = run.first;
    const double* mass = &body.op.mass_kg[first];
    const double* a_x = &level.a_x[at];
    const double* a_y = &level.a_y[at];
    double* __restrict u_x = &body.u_m.x[first];
    double* __restrict u_y = &body.u_m.y[first];
    double* __restrict v_x = &body.v_m_per_s.x[first];
    double* __restrict v_y = &body.v_m_per_s.y[first];
    // Runs end where these change.
    const double kick_s = level.takes_impulse[at] ? level.step_s : 0;
    const double moving_s = level.takes_impulse[at] && level.moves[at] ? level.step_s : 0;
    double u_a = 0, v_a = 0;
#pragma omp simd reduction(+ : u_a, v_a)
    for (std::size_t k = 0; k < count; ++k) {
      u_a += mass[k] * (u_x[k] * a_x[k] + u_y[k] * a_y[k]);
      v_a += mass[k] * (v_x[k] * a_x[k] + v_y[k] * a_y[k]);
      v_x[k] -= kick_s * a_x[k];
      v_y[k] -= kick_s * a_y[k];
      u_x[k] += moving_s * v_x[k];
      u_y[k] += moving_s * v_y[k];
    }
    if (!run.is_owned) continue;
    products.u_K_w += u_a;
    products.v_K_w += v_a;
  }
}

/// The force on the loaded edge. @param w  of a node
template <class W>
void compute_top(StepLevel& level, const BodyMotion& body, W&& w, record::Energies& works) {
  const solid::Span all{0, static_cast<int>(level.top_rows.size())};
  solid::for_each_row_product(level.top_rows, all, w, [&](std::size_t r, double x, double y) {
    level.top_force_N.x[r] = x;
    level.top_force_N.y[r] = y;
    const auto n = level.top_rows.node[r];
    if (body.is_owned(n)) works.far_edge_work += level.step_s * x * body.v_m_per_s.x[n];
  });
}

void add_kicks(solid::KickSums& to, const solid::KickSums& kicks, double mass) {
  to.w_d += mass * kicks.w_d;
  to.v_d += mass * kicks.v_d;
  to.d_d += mass * kicks.d_d;
}

void sweep(StepLevel& level, const Band& band, BodyMotion& body, Filler& filler, solid::RollingRows& w,
           ImpulseProducts& products) {
  const int stride = body.op.grid.stride();
  const double dt = level.step_s;
  const bool with_products = body.damping_s > 0;
  const auto push_interior =
      with_products ? solid::push_interior_row<true, double> : solid::push_interior_row<false, double>;
  const auto right = solid::scaled(body.op.edge, -dt);
  // Sums over kicks of nodes with one mass, which is 1/kick_scale of that amid the smallest squares.
  solid::KickSums kicks = products.kicks, not_counted;
  products.kicks = {};
  double kick_scale = 1;
  const auto sums_of = [&](int row, solid::Span span) -> solid::KickSums& {
    return body.is_owned(row, span) ? kicks : not_counted;
  };
  int edge = band.edges.begin;
  auto at = std::max(static_cast<std::size_t>(band.irregular.begin), level.stiffness.general.size());
  for (int k = band.stencil.begin; k < band.stencil.end; ++k) {
    const auto& row = level.stiffness.stencil[k];
    const auto& [j, squares, scale, spans, n_own, own] = row;
    const auto o = row_start(body, j);
    double* u_x = &body.u_m.x[o];
    double* u_y = &body.u_m.y[o];
    double* v_x = &body.v_m_per_s.x[o];
    double* v_y = &body.v_m_per_s.y[o];
    filler.fill(solid::rows_read(row));
    if (n_own > 0) {
      std::size_t in_row = 0;
      for (const auto span : spans)
        in_row = solid::multiply_own(row, in_row, span, row_of(w, j + 2), row_of(w, j), row_of(w, j + 1),
                                     &level.a_x[at + in_row], &level.a_y[at + in_row]);
      at += n_own;
      continue;
    }
    if (scale != kick_scale && !solid::is_horizontal_edge(row)) {
      add_kicks(products.kicks, kicks, 1 / kick_scale);
      kicks = {};
      kick_scale = scale;
    }
    if (squares == solid::Squares::right || squares == solid::Squares::left) {
      const auto side =
          solid::scaled(squares == solid::Squares::right ? right : solid::mirrored(right), scale);
      const int inner = squares == solid::Squares::right ? 1 : -1;
      for (const auto span : spans)
        solid::kick_side_node(side, span.begin, inner, dt, row_of(w, j + 2), row_of(w, j), row_of(w, j + 1),
                              v_x, v_y, u_x, u_y, sums_of(j, span));
      continue;
    }
    if (squares == solid::Squares::all) {
      const auto interior = solid::scaled(body.op.interior, -dt * scale);
      for (const auto span : spans)
        push_interior(interior, span, dt, row_of(w, j + 2), row_of(w, j), row_of(w, j + 1), v_x, v_y, u_x,
                      u_y, sums_of(j, span));
      continue;
    }
    const auto above = solid::scaled(body.op.edge, -dt * scale);
    const auto stencil = squares == solid::Squares::above ? above : solid::mirrored(above);
    const auto inner = row_of(w, squares == solid::Squares::above ? j + 1 : j - 1);
    const auto of_edge = static_cast<std::ptrdiff_t>(edge++) * stride;
    double* kick_x = level.edge_kick_m_per_s.x.data() + of_edge;
    double* kick_y = level.edge_kick_m_per_s.y.data() + of_edge;
    for (const auto span : spans) {
      const auto [u_d, v_d] =
          solid::kick_edge_row(stencil, span, row_of(w, j), inner, {u_x, u_y}, {v_x, v_y}, kick_x, kick_y);
      if (!body.is_owned(j, span)) continue;
      // The nodes of an edge with a stencil have one mass.
      const double mass = body.op.mass_kg[o + span.begin];
      products.u_K_w -= mass / dt * u_d;
      products.v_K_w -= mass / dt * v_d;
    }
    // Nodes shared with the next level get the kick as an impulse; the others wait for the contact update or
    // for the level before.
    if (squares == solid::Squares::above && j > 0) continue;
    for (const auto span : spans) solid::kick_row(span, kick_x, kick_y, v_x, v_y);
  }
  add_kicks(products.kicks, kicks, 1 / kick_scale);
}

/// Products over the loaded edge.
void add_top_products(const StepLevel& level, const BodyMotion& body, ImpulseProducts& products) {
  const auto& u = body.u_m;
  const auto& v = body.v_m_per_s;
  for (std::size_t r = 0; r < level.top_rows.size(); ++r) {
    const auto n = level.top_rows.node[r];
    if (!body.is_owned(n)) continue;
    products.u_K_w += u.x[n] * level.top_force_N.x[r] + u.y[n] * level.top_force_N.y[r];
    products.v_K_w += v.x[n] * level.top_force_N.x[r] + v.y[n] * level.top_force_N.y[r];
  }
}

/// Kicks and moves nodes with dashpots, and moves the loaded edge.
void push_boundary(const StepLevel& level, const Band& band, BodyMotion& body, record::Energies& works) {
  auto& u = body.u_m;
  auto& v = body.v_m_per_s;
  const double dt = level.step_s;
  record::Energies not_counted;
  for (int k = band.dashpots.begin; k < band.dashpots.end; ++k) {
    const auto& dashpot = level.dashpots[k];
    const auto n = dashpot.node;
    const solid::Pair trial{v.x[n] - dt * level.a_x[dashpot.at], v.y[n] - dt * level.a_y[dashpot.at]};
    const auto after = boundary::damp(dashpot, body.springs, dt, body.op.mass_kg[n], {u.x[n], u.y[n]},
                                      {v.x[n], v.y[n]}, trial, body.is_owned(n) ? works : not_counted);
    v.x[n] = after.x;
    v.y[n] = after.y;
    u.x[n] += dt * after.x;
    u.y[n] += dt * after.y;
  }
  if (band.has_top)
    for (const auto n : level.top) u.x[n] += dt * v.x[n];
}

/// Sums of m (K w/m) . w and m (K w/m) . v over a level's nodes, w given for each node.
template <class W>
StiffnessProducts products_with(const StepLevel& level, const BodyMotion& body, const W& w_of) {
  const auto& v = body.v_m_per_s;
  const auto& mass = body.op.mass_kg;
  StiffnessProducts sums;
  const auto w_of_row = [&](int j, double* w_x, double* w_y) {
    const auto first = body.op.rows[j].first;
    for (int i = 0; i < body.op.rows[j].count; ++i) {
      const solid::Pair at = w_of(first + i);
      w_x[i] = at.x;
      w_y[i] = at.y;
    }
  };
  const auto add_row = [&](const solid::StencilRow& row, solid::ConstRow a, solid::ConstRow w) {
    const auto o = row_start(body, row.row);
    for (const auto span : row.spans) {
      if (!body.is_owned(row.row, span)) continue;
      sums.u_K_u += solid::row_product(span, &mass[o], a, w);
      sums.v_K_u += solid::row_product(span, &mass[o], a, {&v.x[o], &v.y[o]});
    }
  };
  solid::for_each_stencil_product(body.op, level.stiffness, w_of_row, add_row);
  const auto add = [&](mesh::Node n, double m, double x, double y) {
    if (!body.is_owned(n)) return;
    const solid::Pair at = w_of(n);
    sums.u_K_u += m * (at.x * x + at.y * y);
    sums.v_K_u += m * (v.x[n] * x + v.y[n] * y);
  };
  if (const auto& general = level.stiffness.general; general.size() > 0) {
    solid::Field w_field(mass.size()), a(general.size());
    for (std::size_t n = 0; n < mass.size(); ++n) {
      const solid::Pair at = w_of(static_cast<mesh::Node>(n));
      w_field.x[n] = at.x;
      w_field.y[n] = at.y;
    }
    auto space = general.workspace();
    general.multiply(w_field, 0, w_field, space, a.x.data(), a.y.data());
    for (std::size_t r = 0; r < general.size(); ++r)
      add(general.node()[r], mass[general.node()[r]], a.x[r], a.y[r]);
  }
  const auto& top = level.top_rows;
  solid::for_each_row_product(top, {0, static_cast<int>(top.size())}, w_of,
                              [&](std::size_t r, double x, double y) { add(top.node[r], 1, x, y); });
  return sums;
}

}  // namespace

void set_motion_before(StepLevel& level, const BodyMotion& body) {
  auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    s.u_before_m.x[k] = body.u_m.x[n] - level.step_s * body.v_m_per_s.x[n];
    s.u_before_m.y[k] = body.u_m.y[n] - level.step_s * body.v_m_per_s.y[n];
    s.v_last_m_per_s.x[k] = body.v_m_per_s.x[n];
    s.v_last_m_per_s.y[k] = body.v_m_per_s.y[n];
  }
}

void begin_impulse(StepLevel& level, BodyMotion& body, record::Energies& works) {
  auto& s = level.shared;
  exchange_velocities(level, body);
  works.coupling_work += coupling_work(level, body);
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    s.v_mean_before_m_per_s.x[k] = body.v_m_per_s.x[n];
    s.v_mean_before_m_per_s.y[k] = body.v_m_per_s.y[n];
    s.u_before_m.x[k] = body.u_m.x[n];
    s.u_before_m.y[k] = body.u_m.y[n];
  }
}

void apply_band_impulse(StepLevel& level, const Band& band, BodyMotion& body, solid::RollingRows& w,
                        ImpulseProducts& products, record::Energies& works) {
  const auto& op = body.op;
  const bool is_first = &band == &level.bands.front(), is_last = &band == &level.bands.back();
  if (body.damping_s > 0) products.next_velocity_K_w += next_velocity_product(level, band, body);
  if (is_first) {
    const auto w_now = [&](mesh::Node n) {
      return solid::Pair{body.u_m.x[n] + body.damping_s * body.v_m_per_s.x[n],
                         body.u_m.y[n] + body.damping_s * body.v_m_per_s.y[n]};
    };
    if (band.has_top) compute_top(level, body, w_now, works);
    level.stiffness.general.multiply(body.u_m, body.damping_s, body.v_m_per_s, level.general_space,
                                     level.a_x.data(), level.a_y.data());
  }
  // The rows below a later band have moved already, and of its own row w is filled.
  Filler filler(body, w, is_first ? band.first_row : band.first_row + 1);
  sweep(level, band, body, filler, w, products);
  if (!is_last) filler.fill({band.last_row, band.last_row + 2});
  if (!is_first && band.has_top) {
    const int top = op.n_rows() - 1;
    const solid::ConstRow rows[] = {row_of(w, top - 1), row_of(w, top)};
    const auto w_before = [&](mesh::Node n) {
      const auto is_top = static_cast<int>(n >= op.rows[top].first);
      const auto i = n - op.rows[top - 1 + is_top].first;
      return solid::Pair{rows[is_top].x[i], rows[is_top].y[i]};
    };
    compute_top(level, body, w_before, works);
  }
  if (band.has_top) add_top_products(level, body, products);
  push_irregular(level, band, body, products);  // before its nodes with dashpots move
  push_boundary(level, band, body, works);
}

SingleRows make_single_rows(const StepLevel& coarsest, const solid::Operator& op) {
  SingleRows single;
  const auto& bands = coarsest.bands;
  const auto has_others = [](const Band& band) {
    return band.is_irregular || band.edges.begin < band.edges.end;
  };
  int max_rows = 0;
  for (int begin = 1; begin < std::ssize(bands); ++begin) {
    int end = begin;
    while (end < std::ssize(bands) && !has_others(bands[end])) ++end;
    // By rows, since parts of a body have other bands.
    const int n_rows = end > begin ? bands[end - 1].last_row - bands[begin].first_row + 1 : 0;
    if (n_rows > max_rows) {
      single.bands = {begin, end};
      max_rows = n_rows;
    }
    begin = end;
  }
  if (single.bands.begin == single.bands.end) return single;
  single.first_row = bands[single.bands.begin].first_row;
  single.last_row = bands[single.bands.end - 1].last_row;
  const auto& last = op.rows[single.last_row];
  const auto n = static_cast<std::size_t>(last.first + last.count - op.rows[single.first_row].first);
  for (auto* values : {&single.u_x_m, &single.u_y_m, &single.v_x_m_per_s, &single.v_y_m_per_s})
    values->resize(n);
  return single;
}

void to_single(const BodyMotion& body, SingleRows& single) {
  const auto o = row_start(body, single.first_row);
  const auto n = static_cast<int>(single.u_x_m.size());
  solid::convert_row(n, body.u_m.x.data() + o, single.u_x_m.data());
  solid::convert_row(n, body.u_m.y.data() + o, single.u_y_m.data());
  solid::convert_row(n, body.v_m_per_s.x.data() + o, single.v_x_m_per_s.data());
  solid::convert_row(n, body.v_m_per_s.y.data() + o, single.v_y_m_per_s.data());
}

namespace {

/// A row of w in the other precision.
template <class From, class To>
void convert_w(int count, int row, From& from, To& to) {
  solid::convert_row(count, from.x(row), to.x(row));
  solid::convert_row(count, from.y(row), to.y(row));
}

/// The first n of these nodes' motion.
void to_double(const SingleRows& single, int n, BodyMotion& body) {
  const auto o = row_start(body, single.first_row);
  solid::convert_row(n, single.u_x_m.data(), body.u_m.x.data() + o);
  solid::convert_row(n, single.u_y_m.data(), body.u_m.y.data() + o);
  solid::convert_row(n, single.v_x_m_per_s.data(), body.v_m_per_s.x.data() + o);
  solid::convert_row(n, single.v_y_m_per_s.data(), body.v_m_per_s.y.data() + o);
}

}  // namespace

void to_double(const SingleRows& single, BodyMotion& body) {
  to_double(single, static_cast<int>(single.u_x_m.size()), body);
}

void apply_band_impulse(const StepLevel& level, const Band& band, BodyMotion& body, SingleRows& single,
                        solid::RollingRows& w, solid::RollingRowsOf<float>& w_single,
                        ImpulseProducts& products) {
  const auto& rows = body.op.rows;
  const int count = rows[band.first_row].count;
  const double dt = level.step_s;
  const bool is_first = band.first_row == single.first_row, is_last = band.last_row == single.last_row;
  const auto row = [&](int j) { return solid::ConstRowOf<float>{w_single.x(j), w_single.y(j)}; };
  const auto start_of = [&](int j) {
    return static_cast<std::ptrdiff_t>(rows[j].first - rows[single.first_row].first);
  };
  const auto fill = [&](int j) {
    const auto o = start_of(j);
    solid::combine_row(count, body.damping_s, &single.u_x_m[o], &single.u_y_m[o], &single.v_x_m_per_s[o],
                       &single.v_y_m_per_s[o], w_single.x(j), w_single.y(j));
  };
  if (is_first) {
    // The row below is the first band's, and comes in double precision.
    convert_w(count, band.first_row - 1, w, w_single);
    fill(band.first_row);
  }
  // All these rows lie in one block of squares.
  const double scale = level.stiffness.stencil[band.stencil.begin].scale;
  const auto interior = solid::scaled(body.op.interior, -dt * scale);
  const auto right = solid::scaled(body.op.edge, -dt * scale);
  const auto push_interior =
      body.damping_s > 0 ? solid::push_interior_row<true, float> : solid::push_interior_row<false, float>;
  solid::KickSums kicks, not_counted;
  int filled = band.first_row;
  for (int k = band.stencil.begin; k < band.stencil.end; ++k) {
    const auto& row_of_stencil = level.stiffness.stencil[k];
    const int j = row_of_stencil.row;
    const auto squares = row_of_stencil.squares;
    const auto o = start_of(j);
    float* u_x = &single.u_x_m[o];
    float* u_y = &single.u_y_m[o];
    float* v_x = &single.v_x_m_per_s[o];
    float* v_y = &single.v_y_m_per_s[o];
    if (filled == j) {
      ++filled;
      if (j < single.last_row) {
        fill(j + 1);
      } else {
        Filler(body, w, j + 1).fill({j + 1, j + 2});
        convert_w(count, j + 1, w, w_single);
      }
    }
    for (const auto span : row_of_stencil.spans) {
      auto& sums = body.is_owned(j, span) ? kicks : not_counted;
      if (squares == solid::Squares::all) {
        push_interior(interior, span, dt, row(j + 2), row(j), row(j + 1), v_x, v_y, u_x, u_y, sums);
      } else {
        const bool to_right = squares == solid::Squares::right;
        const auto side = to_right ? right : solid::mirrored(right);
        solid::kick_side_node(side, span.begin, to_right ? 1 : -1, dt, row(j + 2), row(j), row(j + 1), v_x,
                              v_y, u_x, u_y, sums);
      }
    }
  }
  add_kicks(products.kicks, kicks, 1 / scale);
  if (is_last) {
    // The bands above go on in double precision, with this row's w as it was.
    convert_w(count, band.last_row, w_single, w);
  }
  // The next step's first band needs the first row's new place.
  if (is_first) to_double(single, count, body);
}

void end_impulse(StepLevel& level, BodyMotion& body) {
  const int stride = body.op.grid.stride();
  auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto r = s.irregular_row[k];
    const auto column = s.node[k] % stride;
    const double x = r < 0 ? level.edge_kick_m_per_s.x[column] : -level.step_s * level.a_x[r];
    const double y = r < 0 ? level.edge_kick_m_per_s.y[column] : -level.step_s * level.a_y[r];
    s.a_m_per_s2.x[k] = -x / level.step_s;
    s.a_m_per_s2.y[k] = -y / level.step_s;
    s.impulse_m_per_s.x[k] = x - level.step_s * s.equilibrium_load_m_per_s2.x[k];
    s.impulse_m_per_s.y[k] = y - level.step_s * s.equilibrium_load_m_per_s2.y[k];
  }
  restore_velocities(level, body);
}

void move_shared(StepLevel& coarser, BodyMotion& body, double dt, record::Energies& works) {
  auto& s = coarser.shared;
  auto& u = body.u_m;
  auto& v = body.v_m_per_s;
  record::Energies not_counted;
  for (const auto& dashpot : s.dashpots) {
    const auto k = dashpot.at;
    const auto n = dashpot.node;
    const double kick_x = dt * s.equilibrium_load_m_per_s2.x[k] + s.impulse_m_per_s.x[k];
    const double kick_y = dt * s.equilibrium_load_m_per_s2.y[k] + s.impulse_m_per_s.y[k];
    const solid::Pair before{s.v_last_m_per_s.x[k], s.v_last_m_per_s.y[k]};
    const auto after =
        boundary::damp(dashpot, body.springs, dt, body.op.mass_kg[n], {u.x[n], u.y[n]}, before,
                       {v.x[n] + kick_x, v.y[n] + kick_y}, body.is_owned(n) ? works : not_counted);
    v.x[n] = after.x - kick_x;
    v.y[n] = after.y - kick_y;
  }
  for (const auto& run : s.runs) {
    const auto at = run.at, count = run.count;
    const auto first = run.first;
    double* __restrict u_x = &u.x[first];
    double* __restrict u_y = &u.y[first];
    double* __restrict v_x = &v.x[first];
    double* __restrict v_y = &v.y[first];
    double* __restrict v_last_x = &s.v_last_m_per_s.x[at];
    double* __restrict v_last_y = &s.v_last_m_per_s.y[at];
    double* __restrict push_x = &s.impulse_m_per_s.x[at];
    double* __restrict push_y = &s.impulse_m_per_s.y[at];
    const double* steady_x = &s.equilibrium_load_m_per_s2.x[at];
    const double* steady_y = &s.equilibrium_load_m_per_s2.y[at];
    const double* mass = &body.op.mass_kg[first];
    double work = 0;
#pragma omp simd reduction(+ : work)
    for (std::size_t k = 0; k < count; ++k) {
      const double kick_x = dt * steady_x[k] + push_x[k];
      const double kick_y = dt * steady_y[k] + push_y[k];
      v_x[k] += kick_x;
      v_y[k] += kick_y;
      work += mass[k] * (kick_x * (v_x[k] + v_last_x[k]) + kick_y * (v_y[k] + v_last_y[k]));
      v_last_x[k] = v_x[k];
      v_last_y[k] = v_y[k];
      u_x[k] += dt * v_x[k];
      u_y[k] += dt * v_y[k];
      push_x[k] = push_y[k] = 0;
    }
    if (run.is_owned) works.coupling_work += 0.5 * work;
  }
}

void exchange_velocities(const StepLevel& level, BodyMotion& body) {
  const auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    body.v_m_per_s.x[n] = (body.u_m.x[n] - s.u_before_m.x[k]) / level.step_s;
    body.v_m_per_s.y[n] = (body.u_m.y[n] - s.u_before_m.y[k]) / level.step_s;
  }
}

void restore_velocities(const StepLevel& level, BodyMotion& body) {
  const auto& s = level.shared;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    body.v_m_per_s.x[s.node[k]] = s.v_last_m_per_s.x[k];
    body.v_m_per_s.y[s.node[k]] = s.v_last_m_per_s.y[k];
  }
}

double coupling_work(const StepLevel& level, const BodyMotion& body) {
  const auto& s = level.shared;
  const auto& v = body.v_m_per_s;
  double work = 0;
  for (std::size_t k = 0; k < s.node.size(); ++k) {
    const auto n = s.node[k];
    if (!body.is_owned(n)) continue;
    const double impulse = 0.5 * level.step_s * body.op.mass_kg[n];
    work += impulse * (s.a_m_per_s2.x[k] * (s.v_mean_before_m_per_s.x[k] + v.x[n]) +
                       s.a_m_per_s2.y[k] * (s.v_mean_before_m_per_s.y[k] + v.y[n]));
  }
  return work;
}

double next_velocity_product(const StepLevel& level, const Band& band, const BodyMotion& body) {
  const auto& v = body.v_m_per_s;
  double sum = irregular_product(level, band, body);
  int edge = band.edges.begin;
  for (int k = band.stencil.begin; k < band.stencil.end; ++k) {
    const auto& row = level.stiffness.stencil[k];
    if (!solid::is_horizontal_edge(row)) continue;
    const auto o = row_start(body, row.row);
    const auto of_edge = static_cast<std::ptrdiff_t>(edge++) * body.op.grid.stride();
    const auto& kicks = level.edge_kick_m_per_s;
    const solid::ConstRow kick{kicks.x.data() + of_edge, kicks.y.data() + of_edge};
    for (const auto span : row.spans)
      if (body.is_owned(row.row, span))
        sum -= solid::row_product(span, &body.op.mass_kg[o], kick, {&v.x[o], &v.y[o]}) / level.step_s;
  }
  if (band.has_top)
    for (std::size_t r = 0; r < level.top_rows.size(); ++r) {
      const auto n = level.top_rows.node[r];
      if (!body.is_owned(n)) continue;
      sum += v.x[n] * level.top_force_N.x[r] + v.y[n] * level.top_force_N.y[r];
    }
  return sum;
}

StiffnessProducts stiffness_products(const StepLevel& level, const BodyMotion& body) {
  return products_with(level, body, [&](mesh::Node n) { return solid::Pair{body.u_m.x[n], body.u_m.y[n]}; });
}

double stiffness_product_before(const StepLevel& level, const BodyMotion& body, double back_s) {
  return products_with(level, body,
                       [&](mesh::Node n) {
                         return solid::Pair{body.u_m.x[n] - back_s * body.v_m_per_s.x[n],
                                            body.u_m.y[n] - back_s * body.v_m_per_s.y[n]};
                       })
      .u_K_u;
}

}  // namespace slipfront::motion
