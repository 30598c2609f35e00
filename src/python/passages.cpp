// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <utility>
#include <vector>

#include "fracture/passage.hpp"
#include "fronts/front.hpp"
#include "input/schema.hpp"
#include "interface/breakdown.hpp"
#include "motion/observers/tip_slips.hpp"
#include "problem/problem.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/histories.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;

/// Points of fronts, column by column; those of a front follow one another. [points]
struct Points {
  const Values &front_id, &direction, &node, &x_m, &onset_s, &v_tip_m_per_s, &t_s_Pa;
};

std::vector<fronts::Front> to_fronts(const Points& p) {
  std::vector<fronts::Front> all;
  for (std::size_t k = 0; k < p.node.size(); ++k) {
    const auto id = static_cast<int>(p.front_id(k)), direction = static_cast<int>(p.direction(k));
    if (all.empty() || all.back().id != id) {
      all.emplace_back();
      all.back().id = id;
      all.back().direction = direction;
    }
    auto& point = all.back().points.emplace_back();
    point.node = static_cast<std::int32_t>(p.node(k));
    point.x_m = p.x_m(k);
    point.onset_s = p.onset_s(k);
    point.v_tip_m_per_s = p.v_tip_m_per_s(k);
    point.t_s_Pa = p.t_s_Pa(k);
  }
  return all;
}

nb::dict fracture_of_history(const input::CaseFile& bodies, const Values& time_s, const Values& x_m,
                             const Rows& slip_m, const Rows& slip_rate_m_per_s, const Rows& t_Pa,
                             const Rows& p_Pa, const Values& front_id, const Values& direction,
                             const Values& node, const Values& point_x_m, const Values& onset_s,
                             const Values& v_tip_m_per_s, const Values& t_s_Pa, double threshold_m_per_s,
                             double cohesion_Pa) {
  auto history = to_history(time_s, x_m, slip_rate_m_per_s, t_Pa, p_Pa);
  require(slip_m.shape(0) == time_s.size() && slip_m.shape(1) == x_m.size(),
          "slip_m must be an array [times, nodes]");
  history.slip_m = to_vector(slip_m);
  const auto breakdown = interface::breakdown_from_history(history, threshold_m_per_s, cohesion_Pa);
  const auto tip_slip = motion::tip_slip_from_history(history, threshold_m_per_s);
  const fracture::Recorded recorded{history.x_m, breakdown, tip_slip};
  const auto of = materials_of(problem::bodies_of(bodies.config()));
  std::vector<std::vector<double>> of_nodes(record::breakdown_fields.size()),
      of_points(fracture::passage_fields.size());
  const Points points{front_id, direction, node, point_x_m, onset_s, v_tip_m_per_s, t_s_Pa};
  for (const auto& front : to_fronts(points)) {
    const auto passages = fracture::passages(front, recorded, of);
    for (std::size_t k = 0; k < passages.size(); ++k) {
      const auto at = static_cast<std::size_t>(front.points[k].node);
      for (std::size_t c = 0; c < of_nodes.size(); ++c)
        of_nodes[c].push_back((breakdown.*record::breakdown_fields[c].member).at(at));
      for (std::size_t c = 0; c < of_points.size(); ++c)
        of_points[c].push_back(passages[k].*fracture::passage_fields[c].member);
    }
  }
  nb::dict columns;
  for (std::size_t c = 0; c < of_nodes.size(); ++c)
    columns[record::breakdown_fields[c].name] = to_array(std::move(of_nodes[c]));
  for (std::size_t c = 0; c < of_points.size(); ++c)
    columns[fracture::passage_fields[c].name] = to_array(std::move(of_points[c]));
  return columns;
}

}  // namespace

void bind_passages(nb::module_& module) {
  module.def("fracture_of_history", &fracture_of_history, "bodies"_a, "time_s"_a, "x_m"_a, "slip_m"_a,
             "slip_rate_m_per_s"_a, "t_Pa"_a, "p_Pa"_a, "front_id"_a, "direction"_a, "node"_a, "point_x_m"_a,
             "onset_s"_a, "v_tip_m_per_s"_a, "t_s_Pa"_a, "threshold_m_per_s"_a, "cohesion_Pa"_a,
             "Columns of fracture.csv at points of fronts in a history, matrices [times, nodes].");
}

}  // namespace slipfront::python
