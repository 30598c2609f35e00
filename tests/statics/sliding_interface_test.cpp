// SPDX-License-Identifier: BSD-3-Clause
#include "statics/sliding_interface.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "equilibria.hpp"
#include "statics/statics.hpp"

namespace slipfront::statics {
namespace {

/// Nodes here and there slip and are open, besides those that the tilt has left open.
std::vector<Contact> some_of_each(std::vector<Contact> contact) {
  for (auto& state : contact)
    if (state != Contact::open) state = Contact::stick;
  contact[17] = contact[18] = Contact::slip;
  contact[21] = Contact::open;
  return contact;
}

/// That the two ways of one statics agree. @param gaps_of_bodies_m  of the undeformed bodies
void expect_same(const Statics& statics, const mesh::Mesh& mesh, const mesh::Mesh* base) {
  const auto contact = some_of_each(statics.tilted().contact);
  const std::size_t n = contact.size();
  std::vector<double> u_x_m;
  for (std::size_t k = 0; k < n; ++k) u_x_m.push_back(1e-6 * static_cast<double>((7 * k) % 13));
  const double shear_m = 3e-5;
  const auto e = statics.slid_to(contact, u_x_m, {}, shear_m);
  std::vector<double> t_Pa(n), p_Pa(n), gap_m(n), found_x_m = u_x_m;
  statics.sliding(contact)->equilibrate(shear_m, found_x_m, t_Pa, p_Pa, gap_m);
  const auto undeformed_m = gaps_m(mesh, base);
  for (std::size_t k = 0; k < n; ++k) {
    const auto above = mesh.interface_nodes[k];
    double x_m = e.u_m.x[above], y_m = e.u_m.y[above];
    if (base != nullptr) {
      x_m -= e.below_u_m.x[base->interface_nodes[k]];
      y_m += e.below_u_m.y[base->interface_nodes[k]];
    }
    EXPECT_NEAR(found_x_m[k], x_m, 1e-15) << k;
    EXPECT_NEAR(gap_m[k], contact[k] == Contact::open ? undeformed_m[k] + y_m : 0, 1e-15) << k;
    EXPECT_NEAR(t_Pa[k], e.tractions.t_s_Pa[k], 1e-2) << k;
    EXPECT_NEAR(p_Pa[k], e.tractions.p_s_Pa[k], 1e-2) << k;
    if (contact[k] == Contact::stick) {
      EXPECT_NEAR(x_m, u_x_m[k], 1e-15) << k;
      EXPECT_GT(std::abs(t_Pa[k]), 1e3) << k;
    }
  }
}

TEST(SlidingInterface, HasTheTractionsOfTheWholeBodies) {
  const auto mesh = test::make_plate(0.2, 0.1, 4e-3, mesh::Corner::relief);
  expect_same(Statics(mesh, {}, {}, 1.3), mesh, nullptr);
}

TEST(SlidingInterface, HasThemOfTwoBodies) {
  const auto mesh = test::make_plate(0.2, 0.1, 4e-3, mesh::Corner::relief);
  const auto base = test::make_plate(0.2, 0.04, 4e-3, mesh::Corner::none);
  const solid::Material stiffer{.youngs_modulus_Pa = 7e9};
  const Statics statics({mesh, {}}, ElasticBody{base, stiffer}, {},
                        std::vector<double>(mesh.interface_nodes.size(), 1.3));
  expect_same(statics, mesh, &base);
}

TEST(SlidingInterface, MovesOnWithTheShear) {
  const auto mesh = test::make_plate(0.2, 0.1, 1e-2, mesh::Corner::none);
  const Statics statics(mesh, {}, {}, 1.3);
  const std::vector<Contact> contact(mesh.interface_nodes.size(), Contact::stick);
  std::vector<double> u_x_m(contact.size()), per_shear;
  for (std::size_t k = 0; k < contact.size(); ++k) per_shear.push_back(0.1 * static_cast<double>(k % 5));
  const double shear_m = 3e-5, more_m = 1e-6;
  const auto from = statics.slid_to(contact, u_x_m, per_shear, shear_m);
  for (std::size_t k = 0; k < contact.size(); ++k) u_x_m[k] += more_m * per_shear[k];
  const auto to = statics.slid_to(contact, u_x_m, {}, shear_m + more_m);
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    EXPECT_NEAR(to.u_m.x[n], from.u_m.x[n] + more_m * from.u_per_shear.x[n], 1e-16);
    EXPECT_NEAR(to.u_m.y[n], from.u_m.y[n] + more_m * from.u_per_shear.y[n], 1e-16);
  }
}

}  // namespace
}  // namespace slipfront::statics
