// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "input/case.hpp"
#include "processes/parcel.hpp"

namespace slipfront::run {

/// The case itself and not its file, which the other machines may see late or not at all; without a table of
/// prescribed tractions.
void put_case(const input::Case& config, Parcel& to);
input::Case take_case(Parcel& from);

}  // namespace slipfront::run
