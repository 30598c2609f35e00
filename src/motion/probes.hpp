// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/state.hpp"
#include "boundary/machine.hpp"
#include "mesh/mesh.hpp"
#include "mesh/node_columns.hpp"
#include "motion/every.hpp"
#include "motion/level.hpp"
#include "motion/step_plan.hpp"
#include "record/probes.hpp"
#include "solid/element.hpp"
#include "solid/material.hpp"

namespace slipfront::motion {

/// Data of the whole body that a subdomain, some columns of its mesh, needs.
struct BodySubdomain {
  mesh::Subset columns;            ///< of the whole body's, those that its mesh holds
  int n_columns = 0;               ///< of the whole body
  solid::Span own;                 ///< columns that this part, and no other, accounts for
  BodySteps steps;                 ///< of the whole body
  MaxOverSubdomains largest = {};  ///< of all subdomains
};

/// What a stepper makes a body of.
struct BodySource {
  const mesh::Mesh& mesh;
  const solid::Material& material;
  const BodySubdomain* part = nullptr;  ///< of a larger body; null for a whole one
  /// Where the mesh is that of the interface alone, and has reliefs: see mesh::make_corners.
  const mesh::Mesh* corners = nullptr;
  boundary::Machine machine = {};  ///< that loads it
};

/// A place within a cell of a body, at which its motion, strain and stress are recorded.
struct Probe {
  std::size_t body = 0;                ///< 0 above, 1 below
  std::array<std::int64_t, 4> node{};  ///< of a cell, by their numbers in the whole body
  solid::CellShape shape;              ///< in the body's own axes: those of a body below are upside down
  solid::Material material;
};

/// Finds the cells in which places lie: with y >= 0 in the first of the bodies, with y < 0 in the second,
/// which is described upside down. On a side between cells the cell with the lowest number has it.
/// @throws UserError naming the probe that lies in no body
std::vector<Probe> locate_probes(std::span<const record::ProbePlace> places,
                                 std::span<const BodySource> bodies);

/// Numbers of the displacements of all probes' nodes, x and y: eight to a probe.
inline std::size_t displacement_values(std::span<const Probe> probes) {
  return 8 * probes.size();
}

/// x and y of a field at the probes' nodes, in the order of displacement_values.
/// @param field_of  gives the field of a body by its number
template <class FieldOf>
std::vector<double> values_at(std::span<const Probe> probes, FieldOf&& field_of) {
  std::vector<double> values;
  for (const auto& probe : probes) {
    const solid::Field& field = field_of(probe.body);
    for (const auto n : probe.node) values.insert(values.end(), {field.x[n], field.y[n]});
  }
  return values;
}

/// Makes rows of a record of the displacements of the probes' nodes at successive steps. A row needs those of
/// its step and of the ones before and after: its velocity is the central difference, which belongs to the
/// row's time and, as the displacement, to the same time at all nodes, however often they move in a step.
class ProbeRecorder {
 public:
  /// @param before_m, now_m  displacements a step before the first one and at it, see displacement_values
  /// @param further  stress that the displacements leave out
  ProbeRecorder(std::vector<Probe> probes, double step_s, double interval_s, std::vector<double> before_m,
                std::vector<double> now_m, const std::optional<solid::UniformStress>& further = {});

  /// Makes room for the steps from `first` + 1 to `first` + n.
  void expect(std::int64_t first, std::int64_t n);
  /// Where the displacements at a step belong; null where it is not needed. For one of these steps, from any
  /// thread.
  double* room_for(std::int64_t step);
  /// Appends the rows that are complete when the steps up to `last` are done, of those expected.
  void take_rows(std::int64_t last, record::ProbeRecord& rows);

  /// All that changes between two calls of expect.
  template <class Archive>
  void serialize(Archive& archive) {
    archive_vector(archive, before_m_);
    archive_vector(archive, now_m_);
  }

 private:
  bool is_sampled(std::int64_t step) const { return every_.is_due({step, step_s_}); }
  void append_row(double time_s, std::span<const double> after_m, record::ProbeRecord& rows) const;

  std::vector<Probe> probes_;
  double step_s_;
  Every every_;
  std::optional<solid::UniformStress> further_;
  std::vector<double> before_m_, now_m_;  ///< of the last two steps that were needed
  std::int64_t first_ = 0;
  std::vector<std::ptrdiff_t> place_;  ///< of the steps expected, in kept_m_; negative: not needed
  std::vector<double> kept_m_;
};

}  // namespace slipfront::motion
