// SPDX-License-Identifier: BSD-3-Clause
#include "python/observers.hpp"

#include <nanobind/stl/string.h>

#include <memory>
#include <string>

#include "base/error.hpp"
#include "motion/observers/interval_observer.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace slipfront::python {
namespace {

/// The interface at the beginning of a step.
struct InterfaceState {
  std::int64_t step = 0;
  record::History row;
};

class FunctionObserver final : public motion::IntervalObserver {
 public:
  FunctionObserver(double interval_s, const nb::object& function, Watcher& watcher)
      : IntervalObserver(interval_s), function_(function), watcher_(watcher) {}

  std::string look(record::History& row, const motion::Now& now, motion::Pause& /*pause*/) override {
    std::string reason;
    watcher_.in_python([&] {
      const nb::object answer = function_(InterfaceState{now.step, std::move(row)});
      if (answer.is_none()) return;
      if (!nb::try_cast(answer, reason) || reason.empty())
        throw UserError("an observer returned {}; it returns None, or why the event is to end, a text",
                        nb::repr(answer).c_str());
    });
    return reason;
  }

 private:
  const nb::object& function_;
  Watcher& watcher_;
};

}  // namespace

std::function<motion::Observers()> observers_of(const Functions& functions, Watcher& watcher) {
  return [&functions, &watcher] {
    motion::Observers list;
    for (const auto& [interval_s, function] : functions)
      list.push_back(std::make_unique<FunctionObserver>(interval_s, function, watcher));
    return list;
  };
}

void bind_observers(nb::module_& module) {
  using S = InterfaceState;
  nb::class_<S> state(
      module, "InterfaceState",
      "The interface at the beginning of a step. Arrays [nodes] are views that cannot be written to; "
      "they may be kept.");
  state.def_ro("step", &S::step, "steps done")
      .def_prop_ro(
          "time_s", [](const S& of) { return of.row.time_s.front(); }, "since the start of the event");
  const auto add = [&](const record::HistoryColumn& column) {
    const std::string about(column.description);
    state.def_prop_ro(
        column.name, [member = column.member](const S& of) { return view_of(of.row.*member, of); },
        about.substr(0, about.find(", [")).c_str());
  };
  add(record::history_place);
  for (const auto& field : record::history_fields) add(field);
  state.def_prop_ro(
      "law_states", [](const S& of) { return views_of(of.row.law_states, of); },
      "of the state variables of the friction law, in its order");
}

}  // namespace slipfront::python
