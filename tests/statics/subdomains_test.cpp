// SPDX-License-Identifier: BSD-3-Clause
#include "statics/subdomains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "support/matrices.hpp"

namespace slipfront::statics {
namespace {

using mesh::Corner;
using test::max_abs;

const solid::Material pmma{};
const solid::Material gel{.youngs_modulus_Pa = 0.3e9, .poissons_ratio = 0.45};

solid::Field some_field(const mesh::Mesh& mesh, double seed) {
  solid::Field u(static_cast<std::size_t>(mesh.n_nodes()));
  const auto is_orphan = mesh::orphans(mesh);
  for (std::size_t n = 0; n < u.size(); ++n) {
    if (is_orphan[n]) continue;
    u.x[n] = std::sin(seed + static_cast<double>(n));
    u.y[n] = std::cos(seed + 0.7 * static_cast<double>(n));
  }
  return u;
}

/// All unknowns for displacements of the bodies, by the nodes of each piece.
std::vector<double> unknowns_of(const PartitionedBodies& divided,
                                const std::vector<const mesh::Mesh*>& meshes,
                                const std::vector<const solid::Field*>& u) {
  std::vector<mesh::NodeColumns> columns;
  for (const auto* mesh : meshes) columns.emplace_back(*mesh);
  const auto& partition = *divided.partition();
  auto above = *u.front(), below = *u.back();
  if (meshes.size() > 1)
    for (std::size_t k = 0; k < meshes[0]->interface_nodes.size(); ++k) {
      const auto a = meshes[0]->interface_nodes[k], b = meshes[1]->interface_nodes[k];
      auto& relative = partition.base_is_relative ? below : above;
      const auto n = partition.base_is_relative ? b : a;
      relative.x[n] = u[0]->x[a] - u[1]->x[b];
      relative.y[n] = u[0]->y[a] + u[1]->y[b];
    }
  std::vector<double> unknowns;
  for (int k = 0; k < partition.n_subdomains(); ++k) {
    const auto nodes = partition.nodes_of_subdomain(columns, k);
    for (std::size_t b = 0; b < meshes.size(); ++b)
      for (const auto n : nodes[b]) {
        const auto& field = b == 0 ? above : below;
        unknowns.insert(unknowns.end(), {field.x[n], field.y[n]});
      }
  }
  return unknowns;
}

/// K' u of the unknowns, from the pieces' own rows alone.
Eigen::VectorXd product_of_pieces(const PartitionedBodies& divided, const std::vector<double>& u) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(u.size()));
  for (int k = 0; k < divided.n_subdomains(); ++k) {
    MessageBuffer buffer;
    divided.subdomain(k).put(buffer);
    const auto subdomain = Subdomain::take(buffer);
    EXPECT_TRUE(buffer.is_empty());
    for (const auto& body : subdomain.bodies)
      for (const auto& cell : body.cells) {
        solid::CellCoordinates c{};
        std::array<double, 8> of_cell{};
        for (std::size_t a = 0; a < 8; ++a) {
          const auto& node = body.nodes[cell[a / 2]];
          const auto terms = terms_of(node.opposite >= 0, body.is_base);
          c[a] = a % 2 == 0 ? node.x_m : node.y_m;
          of_cell[a] = terms.own[a % 2] * u[2 * node.pair + a % 2];
          if (node.opposite >= 0) of_cell[a] += terms.opposite[a % 2] * u[2 * node.opposite + a % 2];
        }
        const auto K = solid::cell_stiffness(c, body.material);
        for (std::size_t a = 0; a < 8; ++a) {
          double force = 0;
          for (std::size_t b = 0; b < 8; ++b) force += K[8 * a + b] * of_cell[b];
          const auto& node = body.nodes[cell[a / 2]];
          const auto terms = terms_of(node.opposite >= 0, body.is_base);
          if (subdomain.has(node.pair)) f(2 * node.pair + a % 2) += terms.own[a % 2] * force;
          if (subdomain.has(node.opposite)) f(2 * node.opposite + a % 2) += terms.opposite[a % 2] * force;
        }
      }
  }
  return f;
}

Eigen::VectorXd product(const mesh::Mesh& mesh, const solid::Material& material, const solid::Field& u) {
  return test::assembled_stiffness(mesh, material) * test::flat(u);
}

TEST(Subdomains, OwnRowsMakeTheProductOfThePlate) {
  for (const auto corner : {Corner::relief, Corner::fillet}) {
    const auto mesh = test::tiny_plate(corner);
    const auto u = some_field(mesh, 0.3);
    const Eigen::VectorXd expected = product(mesh, pmma, u);
    for (const int n : {1, 3}) {
      const PartitionedBodies divided({mesh, pmma}, std::nullopt, n);
      const auto unknowns = unknowns_of(divided, {&mesh}, {&u});
      const Eigen::VectorXd f = product_of_pieces(divided, unknowns);
      const auto at_nodes = divided.displacement(std::vector<double>(f.data(), f.data() + f.size())).above;
      EXPECT_LE(max_abs(test::flat(at_nodes) - expected), 1e-12 * max_abs(expected)) << n;
    }
  }
}

/// All of a piece, to the last bit.
void expect_same(const Subdomain& a, const Subdomain& b) {
  const auto same_node = [](const Subdomain::Node& p, const Subdomain::Node& q) {
    return p.x_m == q.x_m && p.y_m == q.y_m && p.pair == q.pair && p.opposite == q.opposite;
  };
  const auto same_place = [](const Subdomain::Place& p, const Subdomain::Place& q) {
    return p.pair == q.pair && p.place == q.place;
  };
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.n_pairs, b.n_pairs);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_EQ(a.bodies[k].is_base, b.bodies[k].is_base);
    EXPECT_EQ(a.bodies[k].material.youngs_modulus_Pa, b.bodies[k].material.youngs_modulus_Pa);
    EXPECT_TRUE(std::ranges::equal(a.bodies[k].nodes, b.bodies[k].nodes, same_node));
    EXPECT_EQ(a.bodies[k].cells, b.bodies[k].cells);
  }
  EXPECT_TRUE(std::ranges::equal(a.interface_nodes, b.interface_nodes, same_place));
  EXPECT_EQ(a.gap_m, b.gap_m);
  EXPECT_TRUE(std::ranges::equal(a.top, b.top, same_place));
  EXPECT_EQ(a.held, b.held);
}

TEST(Subdomains, MadeByEachProcessAreThoseCutFromTheBodies) {
  const mesh::Plate above{.width_m = 0.021, .height_m = 0.02, .element_size_m = 1e-3, .relief_depth_m = 9e-3};
  const mesh::Plate below{
      .width_m = 0.021, .height_m = 0.015, .element_size_m = 1e-3, .corner = Corner::none};
  for (const bool has_base : {false, true})
    for (const auto& of_base : {pmma, gel})
      for (const int n : {2, 7}) {
        const std::vector plates = {above, below};
        const auto mesh = mesh::make_plate(above), base = mesh::make_plate(below);
        const auto interface = mesh::make_interface(above), of_below = mesh::make_interface(below);
        std::optional<ElasticBody> base_body, interface_of_base;
        if (has_base) {
          base_body.emplace(ElasticBody{base, of_base});
          interface_of_base.emplace(ElasticBody{of_below, of_base});
        }
        const auto material = &of_base == &gel ? pmma : gel;
        const PartitionedBodies held({mesh, material}, base_body, n);
        const PartitionedBodies planned({interface, material}, interface_of_base, n,
                                        std::span(plates).first(has_base ? 2 : 1));
        EXPECT_EQ(planned.n_pairs(), held.n_pairs());
        EXPECT_EQ(planned.partition()->first_column, held.partition()->first_column);
        for (int k = 0; k < n; ++k) {
          MessageBuffer buffer;
          planned.plan(k).put(buffer);
          expect_same(SubdomainPlan::take(buffer).make(), held.subdomain(k));
          EXPECT_TRUE(buffer.is_empty());
        }
      }
}

TEST(Subdomains, HaveAsManyNodesEach) {
  const auto mesh = test::tiny_plate(Corner::relief);
  const PartitionedBodies divided({mesh, pmma}, std::nullopt, 4);
  std::size_t n_interface_nodes = 0, n_top = 0;
  std::int32_t next = 0;
  for (int k = 0; k < 4; ++k) {
    const auto subdomain = divided.subdomain(k);
    EXPECT_EQ(subdomain.first, next);
    next += subdomain.count;
    EXPECT_NEAR(subdomain.count, mesh.n_nodes() / 4.0, 12);  // a column has 11
    EXPECT_LT(subdomain.bodies.front().cells.size(), 0.4 * static_cast<double>(mesh.cells.size()));
    n_interface_nodes += subdomain.interface_nodes.size();
    n_top += subdomain.top.size();
  }
  EXPECT_EQ(next, mesh.n_nodes());
  EXPECT_EQ(n_interface_nodes, mesh.interface_nodes.size());
  EXPECT_EQ(n_top, mesh.far_edge_nodes.size());
}

/// The contact's force on the plate is conjugate to the relative displacement, whichever body is the softer.
TEST(Subdomains, OfTwoBodiesHaveTheRelativeDisplacement) {
  const auto mesh = test::tiny_plate(Corner::relief),
             base = test::make_plate(0.02, 0.014, 1e-3, Corner::none);
  const auto above = some_field(mesh, 0.3), below = some_field(base, 0.9);
  for (const auto& [material, of_base] : {std::pair(pmma, gel), std::pair(gel, pmma)}) {
    const Eigen::VectorXd f_above = product(mesh, material, above), f_below = product(base, of_base, below);
    for (const int n : {1, 3}) {
      const PartitionedBodies divided({mesh, material}, ElasticBody{base, of_base}, n);
      const auto unknowns = unknowns_of(divided, {&mesh, &base}, {&above, &below});
      const auto back = divided.displacement(unknowns);
      EXPECT_LE(max_abs(test::flat(back.above) - test::flat(above)), 1e-15 * 4);
      EXPECT_LE(max_abs(test::flat(back.below) - test::flat(below)), 1e-15 * 4);
      const Eigen::VectorXd f = product_of_pieces(divided, unknowns);
      const bool is_plate_softer = material.youngs_modulus_Pa < of_base.youngs_modulus_Pa;
      for (int k = 0; k < n; ++k)
        for (const auto& [pair, place] : divided.subdomain(k).interface_nodes) {
          const auto a = mesh.interface_nodes[place], b = base.interface_nodes[place];
          EXPECT_EQ(unknowns[2 * pair], above.x[a] - below.x[b]);
          EXPECT_EQ(unknowns[2 * pair + 1], above.y[a] + below.y[b]);
          const double tolerance = 1e-12 * max_abs(f);
          EXPECT_NEAR(f(2 * pair), is_plate_softer ? f_above(2 * a) : -f_below(2 * b), tolerance);
          EXPECT_NEAR(f(2 * pair + 1), is_plate_softer ? f_above(2 * a + 1) : f_below(2 * b + 1), tolerance);
        }
    }
  }
}

}  // namespace
}  // namespace slipfront::statics
