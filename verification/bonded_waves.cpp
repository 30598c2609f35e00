// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "interface/friction/coulomb.hpp"
#include "statics/prestress.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"
#include "verification/scattering.hpp"

namespace slipfront::verification::bonded_waves {

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double width_m = 0.1;  ///< one wavelength along the bond
constexpr double k_x = 2 * std::numbers::pi / width_m;
constexpr double amplitude_m = 1e-8;
constexpr double pressure_Pa = 1e6, bonding_friction = 100;  ///< nothing slips or opens

/// The two bodies and the packets that fall onto their bond.
struct Pair {
  const char* name;
  std::array<solid::Material, 2> bodies;
  std::array<std::array<double, 3>, 2> angles_deg;  ///< [kind]
  /// Whether both bodies take the same step without sub-cycling; else the slower one's layer is sub-cycled
  /// anyway.
  bool in_step;
};

const std::vector<Pair>& pairs() {
  const solid::Material pmma{.stiffness_damping_s = 0};
  const solid::Material stiffer{.youngs_modulus_Pa = 5.0e9,
                                .poissons_ratio = 0.33,
                                .density_kg_per_m3 = 1500,
                                .stiffness_damping_s = 0};
  const solid::Material aluminium{
      .youngs_modulus_Pa = 70e9, .poissons_ratio = 0.33, .density_kg_per_m3 = 2700, .stiffness_damping_s = 0};
  static const std::vector<Pair> all = {
      {"PMMA on stiffer", {pmma, stiffer}, {{{15, 30, 40}, {10, 18, 43}}}, true},
      {"PMMA on aluminium", {pmma, aluminium}, {{{8, 23, 45}, {5, 25, 50}}}, false}};
  return all;
}

const char* name(Kind kind) {
  return kind == Kind::longitudinal ? "P" : "S";
}

/// Waves exp(i (k_x x + k_y y - omega t)) on a mesh of squares, in steps: its own relation of frequency and
/// wavenumber, and its own polarisations.
class MeshWaves {
 public:
  MeshWaves(const solid::Material& material, double h_m, double step_s)
      : material_(material), h_m_(h_m), step_s_(step_s) {}

  double omega(Kind kind, double k_y) const {
    const auto [xx, xy, yy] = stiffness(k_y);
    const double split = std::hypot(0.5 * (xx - yy), xy);
    const double square = 0.5 * (xx + yy) + (kind == Kind::longitudinal ? split : -split);
    return 2 / step_s_ * std::asin(0.5 * step_s_ * std::sqrt(square));
  }
  /// Positive, by Newton's method from the continuum's.
  double k_y(Kind kind, double omega_rad_per_s) const {
    double k = leaving_k_y(material_, kind, k_x, omega_rad_per_s).real();
    for (int n = 0; n < 10; ++n) k -= (omega(kind, k) - omega_rad_per_s) / group_velocity(kind, k);
    return k;
  }
  /// Along y.
  double group_velocity(Kind kind, double k_y) const {
    const double d = 1e-4 * std::abs(k_y);
    return (omega(kind, k_y + d) - omega(kind, k_y - d)) / (2 * d);
  }
  /// Unit vector.
  std::array<double, 2> polarisation(Kind kind, double k_y) const {
    const auto [xx, xy, yy] = stiffness(k_y);
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    if (kind == Kind::longitudinal) return {std::cos(angle), std::sin(angle)};
    return {-std::sin(angle), std::cos(angle)};
  }
  /// Energy over frequency, which the scheme keeps exactly, per time and length of a line along x, over the
  /// square of the amplitude.
  double flux(Kind kind, double k_y) const {
    return material_.density_kg_per_m3 * std::sin(omega(kind, k_y) * step_s_) / step_s_ *
           group_velocity(kind, k_y);
  }
  /// Velocity half a step before the displacement, over it.
  Complex velocity_factor(Kind kind, double k_y) const {
    return (1.0 - std::polar(1.0, omega(kind, k_y) * step_s_)) / step_s_;
  }

 private:
  struct Stiffness {
    double xx, xy, yy;  ///< over the mass of a node, 1/s^2
  };
  Stiffness stiffness(double k_y) const {
    const double c_x = std::cos(k_x * h_m_), c_y = std::cos(k_y * h_m_);
    const double s_x = 2 - 2 * c_x, s_y = 2 - 2 * c_y, m_x = (2 + c_x) / 3, m_y = (2 + c_y) / 3;
    const double mass = material_.density_kg_per_m3 * h_m_ * h_m_;
    const double P = solid::longitudinal_modulus_Pa(material_) / mass;
    const double G = solid::shear_modulus_Pa(material_) / mass;
    return {P * s_x * m_y + G * m_x * s_y, (P - G) * std::sin(k_x * h_m_) * std::sin(k_y * h_m_),
            P * m_x * s_y + G * s_x * m_y};
  }

  solid::Material material_;
  double h_m_, step_s_;
};

/// A packet that falls onto the bond, Gaussian over k_y.
struct Packet {
  const Pair& pair;
  Kind kind;
  double angle_deg;  ///< of its middle, from the normal

  double speed() const { return speed_m_per_s(pair.bodies[0], kind); }
  double k_y() const { return k_x / std::tan(angle_deg * degree); }
  /// Of its envelope along y. The shorter a packet, the wider its spectrum, which is to be small where waves
  /// go no more than half as fast along y, so that the bond is not done with them, and where scattered waves
  /// graze the bond.
  double sigma_m() const {
    const double half = 0.5 * std::cos(angle_deg * degree);
    double sigma = 5 / (k_y() - k_x * half / std::sqrt(1 - half * half));
    for (const auto& body : pair.bodies)
      for (const Kind other : kinds) {
        const double ratio = speed_m_per_s(body, other) / speed();
        if (ratio > 1) sigma = std::max(sigma, 3 / std::abs(k_y() - k_x * std::sqrt(ratio * ratio - 1)));
      }
    return sigma;
  }
  double distance_m() const { return 4.5 * sigma_m(); }  ///< of its middle from the bond
  double speed_along_y() const { return speed() * std::cos(angle_deg * degree); }
  double end_s() const { return 2 * distance_m() / speed_along_y(); }

  /// At which the amplitudes are measured: of the middle and of one standard deviation to either side.
  std::array<double, 3> omegas() const {
    std::array<double, 3> all{};
    for (int n = 0; n < 3; ++n) all[n] = speed() * std::hypot(k_x, k_y() + (1 - n) / sigma_m());
    return all;
  }
  int columns(double elements_per_wave) const {
    const double shortest_m =
        speed_m_per_s(pair.bodies[0], Kind::shear) / speed() * width_m * std::sin(angle_deg * degree);
    return static_cast<int>(std::ceil(elements_per_wave * width_m / shortest_m));
  }
};

/// So high that what leaves the bond has not come to the upper edge before the end, but for the packet's
/// tails, which the edge lets out.
mesh::Mesh mesh_of(const Packet& packet, int body, double h_m) {
  double fastest = (body == 0 ? 1 : 0.5) * packet.speed_along_y();  // half: where all waves cling to the bond
  const double omega = packet.omegas()[1];
  for (const Kind kind : kinds) {
    const auto& material = packet.pair.bodies[body];
    const double c = speed_m_per_s(material, kind);
    fastest = std::max(fastest, c * c * leaving_k_y(material, kind, k_x, omega).real() / omega);
  }
  return layer(width_m, h_m * std::ceil(1.1 * fastest * packet.end_s() / h_m), h_m, mesh::Top::absorbing);
}

/// Amplitude at k_x of each row of nodes.
struct Rows {
  std::vector<Complex> x, y;

  explicit Rows(int n) : x(n), y(n) {}
  Rows(const mesh::Mesh& mesh, const solid::Field& field) : Rows(mesh.grid.rows + 1) {
    for (int j = 0; j < count(); ++j)
      for (int i = 0; i < mesh.grid.columns; ++i) {
        const auto n = mesh.grid.node(i, j);
        const Complex phase = std::polar(2.0 / mesh.grid.columns, -k_x * mesh.x_m[n]);
        x[j] += field.x[n] * phase;
        y[j] += field.y[n] * phase;
      }
  }

  int count() const { return static_cast<int>(x.size()); }
  solid::Field field(const mesh::Mesh& mesh) const {
    solid::Field all(mesh.n_nodes());
    for (int j = 0; j < count(); ++j)
      for (int i = 0; i < mesh.grid.columns; ++i) {
        const auto n = mesh.grid.node(i, j);
        const Complex phase = std::polar(1.0, k_x * mesh.x_m[n]);
        all.x[n] = (x[j] * phase).real();
        all.y[n] = (y[j] * phase).real();
      }
    return all;
  }
  void add(Complex amplitude, const std::array<double, 2>& polarisation, double k_y, double h_m) {
    for (int j = 0; j < count(); ++j) {
      const Complex here = amplitude * std::polar(1.0, k_y * h_m * j);
      x[j] += here * polarisation[0];
      y[j] += here * polarisation[1];
    }
  }
  Complex transform(const std::array<double, 2>& polarisation, double k_y, double h_m) const {
    Complex sum = 0;
    for (int j = 0; j < count(); ++j)
      sum += std::polar(h_m, -k_y * h_m * j) * (polarisation[0] * x[j] + polarisation[1] * y[j]);
    return sum;
  }
};

struct Motion {
  solid::Field u_m, v_m_per_s;
};

Motion motion_of(const Packet& packet, const mesh::Mesh& mesh, const MeshWaves& waves) {
  const int n_rows = mesh.grid.rows + 1;
  const double h_m = mesh.grid.spacing_m, sigma = packet.sigma_m();
  const double dk = std::numbers::pi / (h_m * n_rows);  // repeats after twice the height
  Rows u(n_rows), v(n_rows);
  for (double k = dk; k < packet.k_y() + 6 / sigma; k += dk) {
    const double from_middle = (k - packet.k_y()) * sigma;
    const Complex a = std::polar(amplitude_m * sigma * dk * std::exp(-0.5 * from_middle * from_middle),
                                 k * packet.distance_m());
    const auto polarisation = waves.polarisation(packet.kind, -k);
    u.add(a, polarisation, -k, h_m);
    v.add(a * waves.velocity_factor(packet.kind, -k), polarisation, -k, h_m);
  }
  return {u.field(mesh), v.field(mesh)};
}

/// Two bodies that stick to each other under a uniform pressure, the one above with a motion.
statics::Equilibrium bonded(const std::array<mesh::Mesh, 2>& meshes, Motion motion) {
  record::StaticState tractions;
  for (const auto n : meshes[0].interface_nodes) tractions.x_m.push_back(meshes[0].x_m[n]);
  tractions.t_s_Pa.assign(meshes[0].interface_nodes.size(), 0.0);
  tractions.p_s_Pa.assign(meshes[0].interface_nodes.size(), pressure_Pa);
  auto state = statics::prestressed(meshes[0], std::move(tractions), &meshes[1]);
  state.u_m = std::move(motion.u_m);
  state.u_per_shear = std::move(motion.v_m_per_s);
  return state;
}

/// Amplitudes at one frequency.
struct Point {
  double omega_rad_per_s = 0;
  Scattered measured{}, exact{};
  Scattered by_joins{};  ///< change of the exact ones by the joins of sub-cycled layers
  double flux = 0;       ///< of all scattered waves over that of the incident one
};
using Points = std::array<Point, 3>;

bool leaves(const Pair& pair, int body, Kind kind, double omega) {
  return leaving_k_y(pair.bodies[body], kind, k_x, omega).real() > 0;
}

double step_s(const motion::Body& body) {
  return body.levels().level.front().step_s;
}

std::array<Compliance, 2> joins(const motion::Stepper& stepper, const Pair& pair, double h_m) {
  const motion::TimeStepping time;
  std::array<Compliance, 2> lines;
  for (int b = 0; b < 2; ++b) {
    const auto& body = stepper.bodies()[b];
    const auto thinning_m = [&](Kind kind) {
      return h_m * subcycling::thinning_of_join(speed_m_per_s(pair.bodies[b], kind) * step_s(body) / h_m,
                                                body.period());
    };
    lines[b] = {(time.interface_rows + 0.5) * h_m,
                -thinning_m(Kind::shear) / solid::shear_modulus_Pa(pair.bodies[b]),
                -thinning_m(Kind::longitudinal) / solid::longitudinal_modulus_Pa(pair.bodies[b])};
  }
  return lines;
}

Points scatter(const Packet& packet, double elements_per_wave, bool subcycled) {
  const auto& bodies = packet.pair.bodies;
  const double h_m = width_m / packet.columns(elements_per_wave);
  const std::array meshes = {mesh_of(packet, 0, h_m), mesh_of(packet, 1, h_m)};
  motion::Stepper stepper(motion::BodySource{meshes[0], bodies[0]}, motion::BodySource{meshes[1], bodies[1]},
                          {interface::Coulomb{bonding_friction}},
                          subcycled ? motion::TimeStepping{} : plain_stepping());
  const std::array waves = {MeshWaves(bodies[0], h_m, step_s(stepper.bodies()[0])),
                            MeshWaves(bodies[1], h_m, step_s(stepper.bodies()[1]))};
  const auto state = bonded(meshes, motion_of(packet, meshes[0], waves[0]));
  stepper.start(state, 1, {state.tractions.t_s_Pa, state.tractions.p_s_Pa});
  while (stepper.time_s() < packet.end_s()) advance(stepper);

  // Amplitudes over time and frequency: spectra over k_y, over the group velocity.
  const auto of_frequency = [&](const Rows& rows, int body, Kind kind, double k_y) {
    return rows.transform(waves[body].polarisation(kind, k_y), k_y, h_m) /
           waves[body].group_velocity(kind, std::abs(k_y));
  };
  const Rows before(meshes[0], state.u_m);
  const std::array after = {Rows(meshes[0], stepper.bodies()[0].u_m()),
                            Rows(meshes[1], stepper.bodies()[1].u_m())};
  const auto lines = joins(stepper, packet.pair, h_m);
  Points points;
  for (int n = 0; n < 3; ++n) {
    auto& point = points[n];
    const double omega = point.omega_rad_per_s = packet.omegas()[n];
    point.exact = scattered(bodies, packet.kind, k_x, omega);
    point.by_joins = change_by(lines, bodies, packet.kind, k_x, omega);
    const double k_in = waves[0].k_y(packet.kind, omega);
    const Complex in = of_frequency(before, 0, packet.kind, -k_in);
    for (int body = 0; body < 2; ++body)
      for (const Kind kind : kinds) {
        if (!leaves(packet.pair, body, kind, omega)) continue;
        const double k_out = waves[body].k_y(kind, omega);
        const Complex out = of_frequency(after[body], body, kind, k_out) / in;
        of(point.measured, body, kind) = out * std::polar(1.0, omega * stepper.time_s());
        point.flux += std::norm(out) * waves[body].flux(kind, k_out) / waves[0].flux(packet.kind, k_in);
      }
  }
  return points;
}

/// Distance of all amplitudes from the exact ones, with or without the change of these by the joins: root of
/// the mean square over the frequencies.
double error(const Packet& packet, const Points& points, bool of_joined) {
  double square = 0;
  for (const auto& p : points)
    for (int body = 0; body < 2; ++body)
      for (const Kind kind : kinds)
        if (leaves(packet.pair, body, kind, p.omega_rad_per_s))
          square += std::norm(of(p.measured, body, kind) - of(p.exact, body, kind) -
                              (of_joined ? of(p.by_joins, body, kind) : 0.0));
  return std::sqrt(square / static_cast<double>(points.size()));
}

constexpr std::array<std::array<const char*, 2>, 2> wave_names = {
    {{"reflected P", "reflected S"}, {"transmitted P", "transmitted S"}}};

/// Amplitudes over the angle of incidence: theory, then the program's, [4] curves each.
class AmplitudeChart {
 public:
  AmplitudeChart(const Pair& pair, Kind kind) : pair_(pair), kind_(kind) {
    for (int w = 0; w < 4; ++w) {
      theory_[w] = {w == 0 ? "theory" : "", Curve::Kind::theory};
      program_[w] = {wave_names[w / 2][w % 2]};
    }
    for (double angle = 0.25; angle <= 60; angle += 0.25) {
      const double omega = k_x * speed_m_per_s(pair.bodies[0], kind) / std::sin(angle * degree);
      add(theory_, scattered(pair.bodies, kind, k_x, omega), omega);
    }
  }
  void add(const Points& points) {
    for (const auto& p : points) add(program_, p.measured, p.omega_rad_per_s);
  }
  Chart chart() const {
    Chart all{.x_label = fmt::format("angle of the {} wave, {} (degrees)", name(kind_), pair_.name),
              .y_label = "amplitude / incident"};
    for (const auto* curves : {&theory_, &program_})
      for (const auto& curve : *curves)
        if (!curve.x.empty()) all.curves.push_back(curve);
    return all;
  }

 private:
  void add(std::array<Curve, 4>& curves, const Scattered& amplitudes, double omega) {
    for (int body = 0; body < 2; ++body)
      for (const Kind kind : kinds) {
        if (!leaves(pair_, body, kind, omega)) continue;
        auto& curve = curves[2 * body + static_cast<int>(kind)];
        curve.add(std::asin(k_x * speed_m_per_s(pair_.bodies[0], kind_) / omega) / degree,
                  std::abs(of(amplitudes, body, kind)));
      }
  }
  const Pair& pair_;
  Kind kind_;
  std::array<Curve, 4> theory_, program_;
};

/// A packet on several meshes.
struct Convergence {
  std::vector<double> kh, error, error_of_joined;

  /// Between one mesh and the one before.
  double order(const std::vector<double>& errors, std::size_t n) const {
    return observed_order({kh[n - 1], kh[n]}, {errors[n - 1], errors[n]});
  }
};

}  // namespace

Outcome verify(Effort effort) {
  const bool full = effort == Effort::full;
  Outcome outcome;
  Chart errors{
      .x_label = "k h of the shortest wave", .y_label = "error / incident", .log_x = true, .log_y = true};
  for (const auto& pair : pairs())
    for (const Kind kind : kinds) {
      AmplitudeChart amplitudes(pair, kind);
      double flux = 0;
      const auto& angles = pair.angles_deg[static_cast<int>(kind)];
      for (const double angle : angles) {
        const bool middle = angle == angles[1];
        if (!full && !middle) continue;
        const Packet packet{pair, kind, angle};
        const auto what = fmt::format("{} at {:g} degrees, {}", name(kind), angle, pair.name);
        for (const bool subcycled : {false, true}) {
          if (!subcycled && !pair.in_step) continue;
          const bool finer = full && middle && pair.in_step;
          Convergence c;
          for (const int elements : finer ? std::vector{8, 16, 24} : std::vector{8, 16}) {
            const auto points = scatter(packet, elements, subcycled);
            c.kh.push_back(2 * std::numbers::pi / elements);
            c.error.push_back(error(packet, points, false));
            c.error_of_joined.push_back(error(packet, points, true));
            for (const auto& p : points)
              if (std::abs(p.flux - 1) > std::abs(flux)) flux = p.flux - 1;
            if (subcycled && elements == 16) amplitudes.add(points);
          }
          if (!subcycled)
            outcome.check(fmt::format("order of the error, one step, {}", what), c.order(c.error, 1), 2, 0.2,
                          "the error's next term");
          else
            outcome.check(fmt::format("error left beside the joins, 16 elements, {}", what),
                          c.error_of_joined[1], 0, 0.5 * c.error_of_joined[0],
                          "half of that of 8 elements; second order leaves a quarter");
          if (subcycled && finer)
            outcome.check(fmt::format("order of the error left beside the joins, {}", what),
                          c.order(c.error_of_joined, 2), 2, 0.5,
                          "half an order: higher terms of the joins on meshes this coarse");
          if (!middle || !pair.in_step) continue;
          const auto add = [&](const char* of_what, const std::vector<double>& y) {
            errors.curves.push_back(
                {fmt::format("{}, {}", name(kind), of_what), Curve::Kind::program, c.kh, y});
          };
          add(subcycled ? "4 rows x 18" : "one step", c.error);
          if (subcycled) add("beside the joins", c.error_of_joined);
          if (!subcycled && kind == Kind::shear) errors.curves.push_back(order_line(2, c.kh, c.error.back()));
        }
      }
      outcome.check(fmt::format("flux of energy of the four waves over the incident one, less 1, "
                                "{}, {}: largest",
                                name(kind), pair.name),
                    flux, 0, 1e-3, "the packet's tails: waves that come to the bond late, or graze it");
      outcome.charts.push_back(amplitudes.chart());
    }
  outcome.charts.push_back(std::move(errors));
  return outcome;
}

}  // namespace slipfront::verification::bonded_waves
