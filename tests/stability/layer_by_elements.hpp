// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "solid/material.hpp"
#include "stability/modes.hpp"

namespace slipfront::stability {

/// Eigenvalues s, 1/s, of the layer for exp(i k x) with n linear finite elements in y and lumped mass:
/// nothing is shared with the relation under test. Fastest growth first.
std::vector<std::complex<double>> layer_eigenvalues_by_elements(const solid::Material& material,
                                                                const Sliding& sliding,
                                                                double wavenumber_per_m, double height_m,
                                                                int n);

/// Smallest eigenvalue of the static stiffness of a slip zone of half-length 1 under mu* = 1, in elements of
/// constant slip.
double smallest_stiffness(int n_elements);

}  // namespace slipfront::stability
