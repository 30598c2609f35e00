// SPDX-License-Identifier: BSD-3-Clause
// Equilibria by PETSc against those of the factorisation, by one process or, started by mpirun, by several.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "statics/load_case.hpp"
#include "statics/petsc_solver.hpp"
#include "statics/statics.hpp"
#include "support/matrices.hpp"

namespace slipfront::statics {
namespace {

using mesh::Corner;
using test::flat;
using test::max_abs;

/// Of several; null where this one is alone.
std::unique_ptr<Processes> processes;

const solid::Material pmma{};
const solid::Material gel{.youngs_modulus_Pa = 0.3e9, .poissons_ratio = 0.45, .density_kg_per_m3 = 800};
const solid::Material steel{.youngs_modulus_Pa = 200e9, .poissons_ratio = 0.3};
constexpr double accuracy = 1e-10;

struct Bodies {
  std::string name;
  mesh::Mesh plate;
  std::optional<mesh::Mesh> base;
  solid::Material base_material;

  std::optional<ElasticBody> base_body() const {
    if (!base) return std::nullopt;
    return ElasticBody{*base, base_material};
  }
};

mesh::Mesh graded_plate() {
  return mesh::make_plate({.width_m = 0.032,
                           .height_m = 0.024,
                           .element_size_m = 1e-3,
                           .coarsenings = 2,
                           .fine_height_m = 4e-3,
                           .relief_length_m = 4e-3,
                           .relief_height_m = 0.2e-3,
                           .relief_depth_m = 3e-3});
}

std::vector<Bodies> all_bodies() {
  const auto base = test::make_plate(0.02, 0.014, 1e-3, Corner::none);
  const auto relief = test::tiny_plate(Corner::relief), fillet = test::tiny_plate(Corner::fillet);
  return {{"relief", relief, {}, {}},
          {"fillet", fillet, {}, {}},
          {"graded_relief", graded_plate(), {}, {}},
          {"on_softer", relief, base, gel},
          {"on_stiffer", relief, base, steel}};
}

/// All contact states, in patches; anchors away from 0.
Support mixed_support(std::size_t n) {
  Support support{std::vector<Contact>(n, Contact::stick), std::vector<double>(n, 0.0),
                  std::vector<double>(n, 1e-6), std::vector<double>(n, 0.7)};
  for (std::size_t k = 0; k < n; ++k) {
    if (k < 3 || k + 2 > n) support.contact[k] = Contact::open;
    if (k % 7 >= 4 && support.contact[k] == Contact::stick) {
      support.contact[k] = Contact::slip;
      support.slip_sign[k] = k % 2 == 0 ? 1 : -1;
    }
    support.anchor_x_m[k] *= static_cast<double>(k);
  }
  return support;
}

TopDisplacement tilt_of(const mesh::Mesh& mesh) {
  TopDisplacement top;
  for (const auto n : mesh.far_edge_nodes) {
    top.u_x_m.push_back(2e-6);
    top.u_y_m.push_back(-1e-4 * (1.3 - 10 * mesh.x_m[n]));
  }
  return top;
}

/// Twice the strain energy of a displacement, or of its difference from another one.
double energy(const Bodies& bodies, const Displacement& u, const Displacement& from = {}) {
  const auto of = [](const mesh::Mesh& mesh, const solid::Material& material, const solid::Field& field,
                     const solid::Field& other) {
    Eigen::VectorXd v = flat(field);
    if (other.size() > 0) v -= flat(other);
    return v.dot(test::assembled_stiffness(mesh, material) * v);
  };
  return of(bodies.plate, pmma, u.above, from.above) +
         (bodies.base ? of(*bodies.base, bodies.base_material, u.below, from.below) : 0);
}

class Equilibria : public ::testing::TestWithParam<Bodies> {};
INSTANTIATE_TEST_SUITE_P(Bodies, Equilibria, ::testing::ValuesIn(all_bodies()),
                         [](const auto& bodies) { return bodies.param.name; });

/// For an error e in the energy norm |e|, that of a force is (K e)_k <= sqrt(K_kk) |e|, by Cauchy and
/// Schwarz, and that of a displacement at the interface e_k <= sqrt(C_kk) |e|, C the compliance; C_kk is at
/// most some 1/E in these plates of few cells.
void expect_same(const Bodies& bodies, LoadCase& by_petsc, LoadCase& direct, const Support& support,
                 bool is_sheared) {
  by_petsc.solve(support, accuracy);
  direct.solve(support, accuracy);
  const double E = std::max(pmma.youngs_modulus_Pa, bodies.base ? bodies.base_material.youngs_modulus_Pa : 0);
  const double softest =
      std::min(pmma.youngs_modulus_Pa, bodies.base ? bodies.base_material.youngs_modulus_Pa : 1e300);
  const double error_0 = accuracy * std::sqrt(energy(bodies, direct.displacement(0)));
  EXPECT_LE(max_abs(by_petsc.f0 - direct.f0), 2 * std::sqrt(E) * error_0);
  EXPECT_LE(max_abs(by_petsc.u0 - direct.u0), 4 / std::sqrt(softest) * error_0);
  // The bounds tell the solutions apart.
  EXPECT_GT(max_abs(direct.f0), 1e4 * std::sqrt(E) * error_0);
  if (!is_sheared) {
    EXPECT_EQ(max_abs(by_petsc.u1), 0);
    EXPECT_EQ(max_abs(by_petsc.f1), 0);
    return;
  }
  // Where all nodes slip the shear moves the plate as a whole: what is solved begins with that of a plate
  // that sticks, whose energy is less than E.
  const double error_1 =
      accuracy * std::sqrt(std::max(energy(bodies, direct.displacement_per_shear()), pmma.youngs_modulus_Pa));
  EXPECT_LE(max_abs(by_petsc.f1 - direct.f1), 2 * std::sqrt(E) * error_1);
  EXPECT_LE(max_abs(by_petsc.u1 - direct.u1), 4 / std::sqrt(softest) * error_1);
  const double shear = 3e-5;
  const auto u = by_petsc.displacement(shear), expected = direct.displacement(shear);
  const double tolerance = 4 / std::sqrt(softest) * (error_0 + shear * error_1);
  EXPECT_LE(test::max_difference(u.above, expected.above), tolerance);
  EXPECT_LE(test::max_difference(u.below, expected.below), tolerance);
  const auto per_shear = by_petsc.displacement_per_shear(), as_direct = direct.displacement_per_shear();
  EXPECT_LE(test::max_difference(per_shear.above, as_direct.above), 4 / std::sqrt(softest) * error_1);
}

TEST_P(Equilibria, AreThoseOfTheFactorisation) {
  const auto& bodies = GetParam();
  PetscSolver petsc({bodies.plate, pmma}, bodies.base_body(), {processes.get()});
  const auto direct = make_plate_solver(bodies.plate, pmma, StaticSolver::direct, bodies.base_body());
  const auto n = bodies.plate.interface_nodes.size();
  const auto top = tilt_of(bodies.plate);
  const auto mixed = mixed_support(n);
  auto stick = mixed;
  std::ranges::fill(stick.contact, Contact::stick);
  auto slips = mixed;
  for (auto& contact : slips.contact)
    if (contact == Contact::stick) contact = Contact::slip;
  {
    const auto sheared = petsc.load_case(TopConstraint::both, top, EdgeMotion::along_x, nullptr, 0);
    const auto expected = direct->load_case(TopConstraint::both, top, EdgeMotion::along_x, nullptr, 0);
    // Nodes that were fixed are freed, and the other way round.
    for (const auto& support : {stick, mixed, slips, mixed, stick})
      expect_same(bodies, *sheared, *expected, support, true);
  }
  for (const auto motion : {EdgeMotion::none, EdgeMotion::down}) {
    const auto tilted = petsc.load_case(TopConstraint::vertical, top, motion, nullptr, 0);
    const auto expected = direct->load_case(TopConstraint::vertical, top, motion, nullptr, 0);
    for (const auto& support : {mixed, stick})
      expect_same(bodies, *tilted, *expected, support, motion != EdgeMotion::none);
  }
}

TEST_P(Equilibria, LooserOnesAreLessAccurate) {
  const auto& bodies = GetParam();
  PetscSolver petsc({bodies.plate, pmma}, bodies.base_body(), {processes.get()});
  const auto direct = make_plate_solver(bodies.plate, pmma, StaticSolver::direct, bodies.base_body());
  const auto top = tilt_of(bodies.plate);
  const auto support = mixed_support(bodies.plate.interface_nodes.size());
  const auto exact_case = direct->load_case(TopConstraint::both, top, EdgeMotion::none, nullptr, 0);
  exact_case->solve(support, 0);
  const auto exact = exact_case->displacement(0);
  const double norm = std::sqrt(energy(bodies, exact));
  double last = 0;
  for (const double wanted : {1e-8, 1e-5, 1e-2}) {
    const auto load_case = petsc.load_case(TopConstraint::both, top, EdgeMotion::none, nullptr, 0);
    load_case->solve(support, wanted);
    const double reached = std::sqrt(energy(bodies, load_case->displacement(0), exact)) / norm;
    EXPECT_LE(reached, wanted);
    EXPECT_GT(reached, last);
    last = reached;
  }
}

TEST(Contact, SettlesAsByTheFactorisation) {
  for (const auto corner : {Corner::relief, Corner::fillet})
    for (const auto top : {TopEdge::held, TopEdge::free}) {
      const auto mesh = test::make_plate(0.2, 0.1, 2e-3, corner);
      Loading loading;
      loading.top_during_tilt = top;
      const auto statics_by = [&](StaticSolver solver, double coefficient) {
        const std::vector<double> mu_s(mesh.interface_nodes.size(), coefficient);
        loading.solver = solver;
        return Statics({mesh, pmma}, std::nullopt, loading, mu_s, "friction.mu_s", [] { return true; },
                       {processes.get()});
      };
      const auto slippery = statics_by(StaticSolver::petsc, 0.3).tilted().contact;
      EXPECT_EQ(slippery, statics_by(StaticSolver::direct, 0.3).tilted().contact);
      for (const auto contact : {Contact::stick, Contact::slip, Contact::open})
        EXPECT_THAT(slippery, ::testing::Contains(contact));
      const auto direct = statics_by(StaticSolver::direct, 0.8), petsc = statics_by(StaticSolver::petsc, 0.8);
      EXPECT_EQ(petsc.tilted().contact, direct.tilted().contact);
      const auto expected = direct.shear_to(1), found = petsc.shear_to(1);
      EXPECT_EQ(found.contact, expected.contact);
      EXPECT_EQ(found.peak_x_m, expected.peak_x_m);
      EXPECT_NEAR(found.shear_m, expected.shear_m, 1e-7 * expected.shear_m);
    }
}

/// What statics find, the displacements of this process's piece included.
struct Found {
  Equilibrium tilted, sheared;
  std::vector<double> tilted_m, sheared_m, per_shear;
};

Found found_by(const ElasticBody& plate, const std::optional<ElasticBody>& base,
               const std::vector<mesh::Plate>& plates) {
  DistributedFields kept;
  Loading loading;
  loading.solver = StaticSolver::petsc;
  const std::vector<double> mu_s(plate.mesh.interface_nodes.size(), 0.8);
  const Statics statics(plate, base, loading, mu_s, "friction.mu_s", [] { return true; },
                        {processes.get(), &kept, plates});
  Found found{statics.tilted(), statics.shear_to(1), {}, {}, {}};
  found.tilted_m = kept.own(found.tilted.distributed_u_m->number);
  found.sheared_m = kept.own(found.sheared.distributed_u_m->number);
  found.per_shear = kept.own(found.sheared.distributed_u_per_shear->number);
  return found;
}

TEST(Contact, OfBodiesThatNoProcessHoldsIsTheSameToTheLastBit) {
  const mesh::Plate plate{.width_m = 0.2, .height_m = 0.1, .element_size_m = 2e-3};
  const mesh::Plate below{.width_m = 0.2, .height_m = 0.06, .element_size_m = 2e-3, .corner = Corner::none};
  const auto mesh = mesh::make_plate(plate), base = mesh::make_plate(below);
  const auto interface = mesh::make_interface(plate), of_base = mesh::make_interface(below);
  for (const bool has_base : {false, true}) {
    std::optional<ElasticBody> held_base, known_base;
    std::vector<mesh::Plate> plates = {plate};
    if (has_base) {
      held_base.emplace(ElasticBody{base, gel});
      known_base.emplace(ElasticBody{of_base, gel});
      plates.push_back(below);
    }
    const auto expected = found_by({mesh, pmma}, held_base, {});
    const auto found = found_by({interface, pmma}, known_base, plates);
    EXPECT_THAT(expected.tilted_m, testing::Contains(testing::Ne(0)));
    EXPECT_EQ(found.tilted_m, expected.tilted_m);
    EXPECT_EQ(found.sheared_m, expected.sheared_m);
    EXPECT_EQ(found.per_shear, expected.per_shear);
    EXPECT_EQ(found.sheared.shear_m, expected.sheared.shear_m);
    EXPECT_EQ(found.sheared.contact, expected.sheared.contact);
    EXPECT_EQ(found.sheared.tractions.t_s_Pa, expected.sheared.tractions.t_s_Pa);
    EXPECT_EQ(found.sheared.tractions.p_s_Pa, expected.sheared.tractions.p_s_Pa);
    EXPECT_EQ(found.tilted.tractions.p_s_Pa, expected.tilted.tractions.p_s_Pa);
  }
}

}  // namespace
}  // namespace slipfront::statics

int main(int argc, char** argv) {
  slipfront::statics::processes = slipfront::join_processes(argc, argv);
  auto* processes = slipfront::statics::processes.get();
  if (processes != nullptr && processes->rank() > 0) {
    slipfront::statics::DistributedFields kept;
    slipfront::statics::serve_statics(*processes, kept);
    slipfront::statics::processes.reset();
    return 0;
  }
  ::testing::InitGoogleTest(&argc, argv);
  const int code = RUN_ALL_TESTS();
  if (processes != nullptr) slipfront::statics::release_statics(*processes);
  slipfront::statics::processes.reset();
  return code;
}
