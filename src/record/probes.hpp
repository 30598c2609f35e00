// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "record/column.hpp"

namespace slipfront::record {

/// Where something is recorded.
struct ProbePlace {
  std::string name;
  double x_m = 0, y_m = 0;  ///< y < 0 lies in the body below
};

/// What probes record of the bodies' motion, from above and below in the same axes. Matrices are row-major
/// [times x probes].
struct ProbeRecord {
  std::vector<double> time_s;  ///< [times], ascending
  std::vector<double> u_x_m, u_y_m, v_x_m_per_s, v_y_m_per_s;
  std::vector<double> strain_xx, strain_yy, strain_zz, strain_xy;
  std::vector<double> stress_xx_Pa, stress_yy_Pa, stress_zz_Pa, stress_xy_Pa;
};

using ProbeColumn = Column<ProbeRecord, std::vector<double>>;

inline constexpr ProbeColumn probe_time = {"time_s", "s", "time since the start of the event",
                                           &ProbeRecord::time_s};
/// The matrices, in the order of the files.
inline constexpr std::array<ProbeColumn, 12> probe_fields = {{
    {"u_x_m", "m", "displacement along x, [times, probes]", &ProbeRecord::u_x_m},
    {"u_y_m", "m", "displacement along y, upwards, [times, probes]", &ProbeRecord::u_y_m},
    {"v_x_m_per_s", "m/s", "velocity along x, [times, probes]", &ProbeRecord::v_x_m_per_s},
    {"v_y_m_per_s", "m/s", "velocity along y, upwards, [times, probes]", &ProbeRecord::v_y_m_per_s},
    {"strain_xx", "1", "strain along x, positive in extension, [times, probes]", &ProbeRecord::strain_xx},
    {"strain_yy", "1", "strain along y, [times, probes]", &ProbeRecord::strain_yy},
    {"strain_zz", "1", "strain across the plane, 0 in plane strain, [times, probes]",
     &ProbeRecord::strain_zz},
    {"strain_xy", "1", "shear strain of the tensor, half the engineering one, [times, probes]",
     &ProbeRecord::strain_xy},
    {"stress_xx_Pa", "Pa", "elastic stress along x, positive in tension, [times, probes]",
     &ProbeRecord::stress_xx_Pa},
    {"stress_yy_Pa", "Pa", "elastic stress along y, [times, probes]", &ProbeRecord::stress_yy_Pa},
    {"stress_zz_Pa", "Pa", "elastic stress across the plane, 0 in plane stress, [times, probes]",
     &ProbeRecord::stress_zz_Pa},
    {"stress_xy_Pa", "Pa", "elastic shear stress, [times, probes]", &ProbeRecord::stress_xy_Pa},
}};

/// Numbers of a row: the time, and each field at all probes.
inline std::size_t probe_row_values(std::size_t n_probes) {
  return 1 + probe_fields.size() * n_probes;
}

}  // namespace slipfront::record
