// SPDX-License-Identifier: BSD-3-Clause
// Prints the table of docs/processes.md on meshes without a grid: parts cut by columns of nodes, and by
// PT-Scotch.
//
//   graph_parts [columns] [rows]
#include <fmt/core.h>
#include <petscmat.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh/part.hpp"
#include "mesh/plate.hpp"
#include "motion/division.hpp"
#include "support/general_mesh.hpp"

using namespace slipfront;

namespace {

void check(PetscErrorCode code) {
  if (code != 0) throw std::runtime_error(fmt::format("PETSc's error {}", static_cast<int>(code)));
}

/// Nodes that share a cell with each node, itself left out, ascending.
std::vector<std::vector<mesh::Node>> neighbours_of(const mesh::Mesh& mesh) {
  std::vector<std::set<mesh::Node>> sets(mesh.x_m.size());
  for (const auto& cell : mesh.cells)
    for (const auto a : cell)
      for (const auto b : cell)
        if (a != b) sets[static_cast<std::size_t>(a)].insert(b);
  std::vector<std::vector<mesh::Node>> neighbours;
  for (const auto& set : sets) neighbours.emplace_back(set.begin(), set.end());
  return neighbours;
}
using Neighbours = std::vector<std::vector<mesh::Node>>;

std::vector<int> parts_by_columns(const mesh::Mesh& mesh, const motion::BodySteps& steps, int n_parts) {
  const motion::BodySource source{mesh, {}};
  const motion::TimeStepping plain{.interface_rows = 1, .interface_substeps = 1};
  const auto division = motion::divide_bodies({&source, 1}, {&steps, 1}, plain, n_parts);
  std::vector<int> part_of(mesh.x_m.size());
  for (int part = 0; part < n_parts; ++part) {
    const auto own = division.own(part);
    std::fill(part_of.begin() + mesh.column_first[static_cast<std::size_t>(own.begin)],
              part_of.begin() + mesh.column_first[static_cast<std::size_t>(own.end)], part);
  }
  return part_of;
}

std::vector<int> parts_by_graph(const Neighbours& neighbours, int n_parts) {
  const auto n = static_cast<PetscInt>(neighbours.size());
  std::size_t n_entries = 0;
  for (const auto& list : neighbours) n_entries += list.size();
  PetscInt *first = nullptr, *other = nullptr;  // the matrix frees them
  check(PetscMalloc1(neighbours.size() + 1, &first));
  check(PetscMalloc1(n_entries, &other));
  first[0] = 0;
  PetscInt next = 0;
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    for (const auto m : neighbours[k]) other[next++] = m;
    first[k + 1] = next;
  }
  Mat graph = nullptr;
  check(MatCreateMPIAdj(PETSC_COMM_SELF, n, n, first, other, nullptr, &graph));
  MatPartitioning partitioning = nullptr;
  check(MatPartitioningCreate(PETSC_COMM_SELF, &partitioning));
  check(MatPartitioningSetAdjacency(partitioning, graph));
  check(MatPartitioningSetType(partitioning, MATPARTITIONINGPTSCOTCH));
  check(MatPartitioningSetNParts(partitioning, n_parts));
  check(MatPartitioningSetFromOptions(partitioning));
  IS numbers = nullptr;
  check(MatPartitioningApply(partitioning, &numbers));
  const PetscInt* values = nullptr;
  check(ISGetIndices(numbers, &values));
  std::vector<int> part_of(values, values + n);
  check(ISRestoreIndices(numbers, &values));
  check(ISDestroy(&numbers));
  check(MatPartitioningDestroy(&partitioning));
  check(MatDestroy(&graph));
  return part_of;
}

/// What a part needs of others.
struct Halo {
  std::set<int> owners;  ///< of its nodes
  double nodes = 0;
};
/// The nodes that so many pushes reach, from others into a part.
Halo halo_of(const Neighbours& neighbours, const std::vector<int>& part_of, int part, int pushes) {
  std::vector<bool> is_held(part_of.size());
  std::vector<mesh::Node> edge;
  for (std::size_t n = 0; n < part_of.size(); ++n)
    if (part_of[n] == part) {
      is_held[n] = true;
      edge.push_back(static_cast<mesh::Node>(n));
    }
  Halo halo;
  for (int push = 0; push < pushes; ++push) {
    std::vector<mesh::Node> reached;
    for (const auto n : edge)
      for (const auto m : neighbours[static_cast<std::size_t>(n)]) {
        const auto at = static_cast<std::size_t>(m);
        if (is_held[at]) continue;
        is_held[at] = true;
        reached.push_back(m);
        halo.owners.insert(part_of[at]);
      }
    halo.nodes += static_cast<double>(reached.size());
    edge = std::move(reached);
  }
  return halo;
}

void print_row(const std::string& by, const mesh::Mesh& mesh, const Neighbours& neighbours,
               const std::vector<int>& part_of, int n_parts) {
  std::vector<double> own(static_cast<std::size_t>(n_parts), 0);
  for (const int part : part_of) ++own[static_cast<std::size_t>(part)];
  std::vector<int> stretches(own.size(), 0);
  int before = -1;
  for (const auto n : mesh.lower) {
    const int part = part_of[static_cast<std::size_t>(n)];
    if (part != before) ++stretches[static_cast<std::size_t>(part)];
    before = part;
  }
  std::size_t most_neighbours = 0;
  double most_of_one = 0, most_of_many = 0;
  for (int part = 0; part < n_parts; ++part) {
    const auto one = halo_of(neighbours, part_of, part, 1), many = halo_of(neighbours, part_of, part, 16);
    most_neighbours = std::max(most_neighbours, one.owners.size());
    most_of_one = std::max(most_of_one, one.nodes / own[static_cast<std::size_t>(part)]);
    most_of_many = std::max(most_of_many, many.nodes / own[static_cast<std::size_t>(part)]);
  }
  const double mean = static_cast<double>(part_of.size()) / n_parts;
  const auto with_interface = own.size() - static_cast<std::size_t>(std::ranges::count(stretches, 0));
  fmt::print("| {} | {} | {} | {:.1f} % | {:.0f} % | {:.3f} | {} | {} |\n", n_parts, by, most_neighbours,
             100 * most_of_one, 100 * most_of_many, std::ranges::max(own) / mean, with_interface,
             std::ranges::max(stretches));
}

void print_table(int columns, int rows) {
  mesh::Plate plate;
  plate.corner = mesh::Corner::none;
  plate.element_size_m = 1e-3;
  plate.width_m = columns * plate.element_size_m;
  plate.height_m = rows * plate.element_size_m;
  auto mesh = test::without_grid(mesh::make_plate(plate), 0.2 * plate.element_size_m);
  mesh::number_by_columns(mesh);
  const auto neighbours = neighbours_of(mesh);
  // Of the stepping only the number of steps between two exchanges follows from it.
  const motion::BodySteps steps{1e-7, {1}};
  fmt::print(
      "| parts | by | neighbours | halo of 1 push | of 16 | largest | at the interface | stretches |\n");
  fmt::print("|---|---|---|---|---|---|---|---|\n");
  for (const int n_parts : {2, 4, 8, 16, 64}) {
    print_row("columns", mesh, neighbours, parts_by_columns(mesh, steps, n_parts), n_parts);
    print_row("PT-Scotch", mesh, neighbours, parts_by_graph(neighbours, n_parts), n_parts);
  }
}

}  // namespace

int main(int count, char** arguments) {
  try {
    check(PetscInitialize(&count, &arguments, nullptr, nullptr));
    const auto number = [&](int k, int otherwise) { return k < count ? std::atoi(arguments[k]) : otherwise; };
    print_table(number(1, 600), number(2, 300));
    check(PetscFinalize());
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "graph_parts: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
