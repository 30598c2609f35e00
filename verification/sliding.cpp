// SPDX-License-Identifier: BSD-3-Clause
#include "verification/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "interface/friction/velocity_weakening.hpp"
#include "stability/modes.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"

namespace slipfront::verification {

namespace {

constexpr Complex i_unit{0, 1};

Complex determinant(const std::array<std::array<Complex, 3>, 3>& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

struct Displacement {
  Complex x, y;
};

/// Displacements of a wave exp(i k x + s t) in an undamped body y > 0: two potentials that fall from the
/// interface and, in a layer whose upper edge is held, two that fall from there.
class WaveShape {
 public:
  /// In a half-space whose edge moves by this much.
  WaveShape(const solid::Material& material, double wavenumber_per_m, Complex s_per_s,
            const Displacement& edge)
      : k_per_m_(wavenumber_per_m), height_m_(0), edge_(edge) {
    set_potentials(material, s_per_s);
    const Complex determinant = u_x_[0] * u_y_[2] - u_x_[2] * u_y_[0];
    set_amplitudes(material, {(edge.x * u_y_[2] - edge.y * u_x_[2]) / determinant, 0,
                              (edge.y * u_x_[0] - edge.x * u_y_[0]) / determinant, 0});
  }

  /// In a layer that stays on the plane (u_y = 0 at y = 0), scaled to u_x = 1 at y = 0.
  WaveShape(const solid::Material& material, double wavenumber_per_m, Complex s_per_s, double height_m)
      : k_per_m_(wavenumber_per_m), height_m_(height_m), edge_{1, 0} {
    set_potentials(material, s_per_s);
    // At rest at the top, on the plane below: three conditions, solved by their minors.
    std::array<std::array<Complex, 4>, 3> rows;
    std::array<Complex, 4> at_edge;
    for (std::size_t c = 0; c < 4; ++c) {
      const Complex fall = std::exp((c % 2 == 0 ? 1.0 : -1.0) * rate_per_m_[c] * height_m);
      const Complex above = c % 2 == 0 ? fall : 1.0, below = c % 2 == 0 ? 1.0 : fall;
      rows[0][c] = u_x_[c] * above;
      rows[1][c] = u_y_[c] * above;
      rows[2][c] = u_y_[c] * below;
      at_edge[c] = u_x_[c] * below;
    }
    std::array<Complex, 4> amplitude;
    Complex u_x = 0;
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::array<Complex, 3>, 3> minor;
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0, to = 0; c < 4; ++c)
          if (c != left_out) minor[r][to++] = rows[r][c];
      amplitude[left_out] = (left_out % 2 == 0 ? 1.0 : -1.0) * determinant(minor);
      u_x += amplitude[left_out] * at_edge[left_out];
    }
    for (auto& part : amplitude) part /= u_x;
    set_amplitudes(material, amplitude);
  }

  Complex u_x(double y_m) const { return y_m == 0 ? edge_.x : sum(u_x_, y_m); }
  Complex u_y(double y_m) const { return y_m == 0 ? edge_.y : sum(u_y_, y_m); }
  Complex pressure_Pa_per_m() const { return pressure_; }  ///< on the interface

 private:
  void set_potentials(const solid::Material& material, Complex s_per_s) {
    const double c_L = solid::longitudinal_speed_m_per_s(material),
                 c_S = solid::shear_speed_m_per_s(material);
    const Complex P2 = std::pow(s_per_s / (k_per_m_ * c_S), 2);
    const Complex a_d = std::sqrt(1.0 + P2 * (c_S * c_S / (c_L * c_L))), a_s = std::sqrt(1.0 + P2);
    // Dilatation falling from below and from above, then shear; each over its potential's k.
    const std::array<Complex, 4> a = {-a_d, a_d, -a_s, a_s};
    u_x_ = {i_unit, i_unit, a[2], a[3]};
    u_y_ = {a[0], a[1], -i_unit, -i_unit};
    for (std::size_t c = 0; c < 4; ++c) rate_per_m_[c] = a[c] * k_per_m_;
  }

  void set_amplitudes(const solid::Material& material, const std::array<Complex, 4>& amplitude) {
    for (std::size_t c = 0; c < 4; ++c) {
      u_x_[c] *= amplitude[c];
      u_y_[c] *= amplitude[c];
    }
    // p = -sigma_yy = -(rho c_L^2 du_y/dy + lambda du_x/dx), lambda = rho (c_L^2 - 2 c_S^2).
    const double M = solid::longitudinal_modulus_Pa(material), G = solid::shear_modulus_Pa(material);
    Complex strain_yy = 0;
    for (std::size_t c = 0; c < 4; ++c)
      strain_yy += rate_per_m_[c] * u_y_[c] * (c % 2 == 0 ? 1.0 : std::exp(-rate_per_m_[c] * height_m_));
    pressure_ = -(M * strain_yy + (M - 2 * G) * i_unit * k_per_m_ * edge_.x);
  }

  Complex sum(const std::array<Complex, 4>& amplitude, double y_m) const {
    Complex total = 0;
    for (std::size_t c = 0; c < 4; ++c)
      if (amplitude[c] != Complex{0})
        total += amplitude[c] * std::exp(rate_per_m_[c] * (c % 2 == 0 ? y_m : y_m - height_m_));
    return total;
  }

  double k_per_m_, height_m_;
  Displacement edge_;
  std::array<Complex, 4> rate_per_m_, u_x_, u_y_;  ///< of exp(rate (y - origin))
  Complex pressure_;
};

}  // namespace

interface::ContactModel weakening(double mu, double speed_m_per_s, double slope_s_per_m) {
  const double drop = slope_s_per_m * speed_m_per_s * std::numbers::e;  // the law's speed is this one
  const double mu_k = mu - drop / std::numbers::e;
  return {interface::VelocityWeakening{mu_k + drop, mu_k, drop * speed_m_per_s * speed_m_per_s}};
}

Complex check_mode(const std::string& what, const CarriedRate& carried, Complex expected, int order,
                   int next_order, Outcome& outcome) {
  const auto [rate, uncertainty] = limit({carried(16), carried(32), carried(64)}, order, next_order);
  constexpr const char* reason =
      "change of the complex rate when the finest mesh joins the extrapolation: 16, 32 and 64 elements per "
      "wave";
  outcome.check("growth rate over k c_S, " + what, rate.real(), expected.real(), uncertainty, reason);
  outcome.check("phase speed over c_S, " + what, -rate.imag(), -expected.imag(), uncertainty, reason);
  return rate;
}

Curve check_order(const std::string& label, const std::string& what, const std::function<double(int)>& error,
                  int order, Outcome& outcome) {
  Curve errors{label};
  for (const int elements : {16, 32, 64, 128}) errors.add(2 * std::numbers::pi / elements, error(elements));
  outcome.check("order of the error in h, " + what, std::log2(errors.y[2] / errors.y[3]), order, 0.3,
                "terms of higher order on meshes this coarse");
  return errors;
}

namespace {

/// A body with its mesh and its share of the wave; the one below is described upside down.
struct Part {
  const solid::Material& material;
  double speed_m_per_s;
  mesh::Mesh mesh;
  WaveShape shape;
};

/// Displacements of the edges of half-spaces for a slip of 1.
std::vector<Displacement> edges(const SlidingWave& w) {
  if (!w.bodies.below) return {{1, 0}};
  const auto c = stability::compliance(w.bodies, w.wavenumber_per_m, w.s_per_s);
  const double unit = solid::shear_modulus_Pa(w.bodies.above) * w.wavenumber_per_m;
  // Nothing opens: 0 = xy t + yy p.
  const Complex t = unit * c.yy / c.determinant, p = -unit * c.xy / c.determinant;
  const auto a = stability::compliance(w.bodies.above, w.wavenumber_per_m, w.s_per_s);
  const Displacement above{(a.xx * t + a.xy * p) / (a.denominator * unit),
                           (a.xy * t + a.yy * p) / (a.denominator * unit)};
  return {above, {above.x - 1.0, -above.y}};
}

std::vector<Part> parts(const SlidingWave& w) {
  const double k = w.wavenumber_per_m, length = 2 * std::numbers::pi / k, h = length / w.elements_per_wave;
  const auto part = [&](const solid::Material& material, double speed_m_per_s, const Displacement& edge) {
    const double c_L = solid::longitudinal_speed_m_per_s(material);
    const int rows =
        static_cast<int>(w.height_m > 0 ? std::round(w.height_m / h) : std::ceil(c_L * w.end_s / h) + 4);
    return Part{material, speed_m_per_s, layer(length, rows * h, h),
                w.height_m > 0 ? WaveShape(material, k, w.s_per_s, rows * h)
                               : WaveShape(material, k, w.s_per_s, edge)};
  };
  const auto edge = edges(w);
  std::vector<Part> all;
  all.push_back(part(w.bodies.above, w.speed_m_per_s, edge.front()));
  if (w.bodies.below) all.push_back(part(*w.bodies.below, 0, edge.back()));
  return all;
}

motion::Stepper make_stepper(const std::vector<Part>& parts, const interface::ContactModel& contact,
                             const motion::TimeStepping& time) {
  if (parts.size() == 1) return {parts[0].mesh, parts[0].material, contact, time};
  return {motion::BodySource{parts[0].mesh, parts[0].material},
          motion::BodySource{parts[1].mesh, parts[1].material}, contact, time};
}

/// The same c_L dt/h on every mesh, and a whole number of steps: errors then follow powers of h.
struct WholeSteps {
  int n = 0;
  double factor = 0;  ///< of the stable step
};
WholeSteps steps_of(const SlidingWave& w, const std::vector<Part>& bodies) {
  double c_L = 0;
  for (const auto& body : bodies) c_L = std::max(c_L, solid::longitudinal_speed_m_per_s(body.material));
  const double length = 2 * std::numbers::pi / w.wavenumber_per_m;
  const auto trial = make_stepper(bodies, w.contact, plain_stepping());
  const double substeps = trial.step_s() / trial.lowest_step_s();
  const int n = w.elements_per_wave * static_cast<int>(std::ceil(c_L * w.end_s / (0.9 * length * substeps)));
  return {n, w.end_s / (n * substeps * trial.stable_step_s())};
}

/// Starts the stepper from the wave on uniform sliding.
void start_sliding(motion::Stepper& stepper, const SlidingWave& w, const std::vector<Part>& bodies) {
  constexpr double amplitude_m = 1e-8;
  const double k = w.wavenumber_per_m;
  const double mu = stability::uniform_sliding(w.contact.law, w.speed_m_per_s, w.pressure_Pa).mu;
  const auto phase = [&](double x_m, double time) {
    return amplitude_m * std::exp(i_unit * k * x_m + w.s_per_s * time);
  };
  const auto u_x = [&](const Part& part) {
    return [&](mesh::Node n, double time) {
      return part.speed_m_per_s * time +
             (phase(part.mesh.x_m[n], time) * part.shape.u_x(part.mesh.y_m[n])).real();
    };
  };
  const auto u_y = [&](const Part& part) {
    return [&](mesh::Node n, double time) {
      return (phase(part.mesh.x_m[n], time) * part.shape.u_y(part.mesh.y_m[n])).real();
    };
  };
  const Part& above = bodies.front();
  Start from{.u_x_m = u_x(above),
             .u_y_m = u_y(above),
             .contact = statics::Contact::slip,
             .t_Pa = mu * w.pressure_Pa,
             .p_Pa = w.pressure_Pa};
  if (w.bodies.below) from.below = {&bodies[1].mesh, u_x(bodies[1]), u_y(bodies[1])};
  const std::size_t n_interface_nodes = above.mesh.interface_nodes.size();
  from.loads = {std::vector<double>(n_interface_nodes, mu * w.pressure_Pa),
                std::vector<double>(n_interface_nodes, w.pressure_Pa)};
  auto state = start(stepper, above.mesh, from);
  // A delayed response has a part of the wave in its memory.
  if (w.contact.regularisation.relaxed != interface::Relaxed::none) {
    const double rate = interface::relaxation_rate_per_s(w.contact.regularisation, w.speed_m_per_s);
    const Complex delayed = above.shape.pressure_Pa_per_m() * rate / (rate + w.s_per_s);
    for (std::size_t i = 0; i < n_interface_nodes; ++i)
      state.tractions.p_s_Pa[i] += (phase(above.mesh.x_m[above.mesh.interface_nodes[i]], 0) * delayed).real();
    stepper.start(state, 1, from.loads);
  }
  // So has the state, which is the one under which t holds at V.
  if (const auto sliding = stability::uniform_sliding(w.contact.law, w.speed_m_per_s, w.pressure_Pa);
      sliding.state_rate_per_s > 0) {
    const Complex of_state = sliding.state_slope_s_per_m * w.s_per_s * sliding.state_rate_per_s /
                             (sliding.state_rate_per_s + w.s_per_s);
    for (std::size_t i = 0; i < n_interface_nodes; ++i)
      state.tractions.t_s_Pa[i] +=
          w.pressure_Pa * (phase(above.mesh.x_m[above.mesh.interface_nodes[i]], 0) * of_state).real();
    stepper.start(state, 1, from.loads);
  }
}

}  // namespace

Complex carried_rate_per_s(const SlidingWave& w) {
  const auto bodies = parts(w);
  const auto steps = steps_of(w, bodies);
  auto stepper = make_stepper(bodies, w.contact, plain_stepping(steps.factor));
  start_sliding(stepper, w, bodies);
  const auto transform = [&] {
    Complex sum = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const double moved_m = bodies[b].speed_m_per_s * stepper.time_s();
      const auto& mesh = bodies[b].mesh;
      for (const auto n : mesh.interface_nodes)
        sum += (b == 0 ? 1.0 : -1.0) * (stepper.bodies()[b].u_m().x[n] - moved_m) *
               std::exp(-i_unit * w.wavenumber_per_m * mesh.x_m[n]);
    }
    return sum;
  };
  std::vector<double> time_s = {0};
  std::vector<Complex> log_slip = {0};
  Complex last = transform();
  while (stepper.step() < steps.n) {
    advance(stepper);
    const Complex now = transform();
    time_s.push_back(stepper.time_s());
    log_slip.push_back(log_slip.back() + std::log(now / last));
    last = now;
  }
  const double t_mean =
      std::accumulate(time_s.begin(), time_s.end(), 0.0) / static_cast<double>(time_s.size());
  Complex numerator = 0;
  double denominator = 0;
  for (std::size_t j = 0; j < time_s.size(); ++j) {
    numerator += (time_s[j] - t_mean) * log_slip[j];
    denominator += (time_s[j] - t_mean) * (time_s[j] - t_mean);
  }
  return numerator / denominator;
}

}  // namespace slipfront::verification
