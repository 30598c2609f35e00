// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fronts/from_history.hpp"
#include "python/arrays.hpp"
#include "record/record.hpp"

namespace slipfront::python {

/// Tractions before an event. [nodes] @throws std::invalid_argument where lengths differ or x does not ascend
record::StaticState to_state(const Values& x_m, const Values& t_s_Pa, const Values& p_s_Pa);

/// A history without its slip. Matrices [times, nodes]. @throws std::invalid_argument where they are not
record::History to_history(const Values& time_s, const Values& x_m, const Rows& slip_rate_m_per_s,
                           const Rows& t_Pa, const Rows& p_Pa);

/// Its beginnings of slip, with the tractions around that measures over l* need.
record::SlipRecord to_record(const record::History& history, double threshold_m_per_s, double l_star_m,
                             fronts::TipAt tip = fronts::TipAt::slip_rate);

}  // namespace slipfront::python
