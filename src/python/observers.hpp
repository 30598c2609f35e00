// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <utility>
#include <vector>

#include "motion/observer.hpp"
#include "python/watcher.hpp"

namespace slipfront::python {

/// Intervals, s, and the functions that are shown the interface at them.
using Functions = std::vector<std::pair<double, nanobind::object>>;

/// Makes observers that call such functions, without Python's lock held; what they raise ends the run as an
/// interruption, and Watcher::rethrow raises it. Functions and watcher stay where they are.
std::function<motion::Observers()> observers_of(const Functions& functions, Watcher& watcher);

}  // namespace slipfront::python
