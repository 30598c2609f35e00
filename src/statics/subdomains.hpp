// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/plate.hpp"
#include "processes/message_buffer.hpp"
#include "statics/distributed_field.hpp"
#include "statics/elastic_body.hpp"
#include "statics/load_case.hpp"

namespace slipfront::statics {

/// One rank's subdomain of the bodies: the cells at its own nodes.
///
/// The unknowns are pairs along x and y, one for each node with cells, numbered through all processes; each
/// has consecutive ones. A pair is a node's displacement; at the interface of two bodies, for the nodes of
/// the softer one, it is the plate's displacement relative to the base, so that contact fixes or frees it.
struct Subdomain {
  struct Node {
    double x_m = 0, y_m = 0;
    std::int32_t pair = 0;
    std::int32_t opposite = -1;  ///< where the pair is a relative displacement, that of the other body's node
  };
  struct Body {
    solid::Material material;
    bool is_base = false;  ///< described upside down
    std::vector<Node> nodes;
    std::vector<mesh::Cell> cells;  ///< of these nodes
  };
  /// An own pair of unknowns with its place along an edge.
  struct Place {
    std::int32_t pair = 0, place = 0;
  };

  std::int32_t first = 0, count = 0, n_pairs = 0;  ///< own pairs, and those of all processes
  std::vector<Body> bodies;
  std::vector<Place> interface_nodes;  ///< places in mesh.interface_nodes, ascending
  std::vector<double> gap_m;           ///< [interface nodes]
  std::vector<Place> top;              ///< pairs of the loaded edge, with places in mesh.far_edge_nodes
  std::vector<std::int32_t> held;      ///< pairs at which a base is held

  bool has(std::int32_t pair) const { return pair >= first && pair < first + count; }
  void put(MessageBuffer& to) const;
  static Subdomain take(MessageBuffer& from);
};

/// Factors of a node's pair and of its opposite's in its displacement, along x and y.
struct Terms {
  std::array<double, 2> own{1, 1}, opposite{0, 0};
};
Terms terms_of(bool is_relative, bool is_base);
/// Displacements of two bodies, from what their unknowns are at nodes that face each other.
void make_absolute(solid::Field& plate, std::span<const mesh::Node> plate_lower, solid::Field& base,
                   std::span<const mesh::Node> base_lower, bool base_is_relative);

/// What a rank needs to make its subdomain of bodies of equal elements itself.
struct SubdomainPlan {
  struct Body {
    mesh::Plate plate;
    solid::Material material;
  };
  std::vector<Body> bodies;
  bool base_is_relative = false;
  std::vector<int> first_column;    ///< [subdomains + 1]
  std::vector<std::int32_t> first;  ///< [subdomains + 1] pairs
  std::int32_t number = 0;          ///< of the subdomain

  void put(MessageBuffer& to) const;
  static SubdomainPlan take(MessageBuffer& from);
  Subdomain make() const;
};

/// A plate, and a base below it, cut across the interface into subdomains of columns with about as many nodes
/// each.
class PartitionedBodies {
 public:
  /// @param plates  where the meshes are those of the interfaces alone: of the bodies
  PartitionedBodies(const ElasticBody& plate, const std::optional<ElasticBody>& base, int n_subdomains,
                    std::span<const mesh::Plate> plates = {});

  int n_subdomains() const { return partition_->n_subdomains(); }
  const std::shared_ptr<const Partition>& partition() const { return partition_; }
  std::int32_t n_pairs() const { return first_.back(); }
  /// Whether the bodies are held, so that subdomains can be cut from them; else each is made by a plan.
  bool are_held() const { return plates_.empty(); }
  Subdomain subdomain(int number) const;
  SubdomainPlan plan(int number) const;

  /// Displacements of the bodies for all unknowns; 0 at numbers without a cell.
  /// @pre the bodies are held
  Displacement displacement(const std::vector<double>& unknowns) const;

 private:
  std::vector<ElasticBody> bodies_;
  std::vector<mesh::Plate> plates_;
  std::vector<std::vector<std::int32_t>> pair_;  ///< [bodies][nodes] -1 where there is no cell
  std::shared_ptr<const Partition> partition_;
  std::vector<std::int32_t> first_;  ///< [subdomains + 1]
};

}  // namespace slipfront::statics
