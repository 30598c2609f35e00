// SPDX-License-Identifier: BSD-3-Clause
// Wave speeds of a material, and the front of a case until a slip of 20 um: downstream CASE.toml
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "input/schema.hpp"
#include "run/run.hpp"
#include "slip_limit.hpp"
#include "solid/material.hpp"

namespace {

int run(const char* file) {
  using namespace slipfront;
  const input::Case config = input::read_case(file);
  std::printf("c_L %.6g m/s, c_S %.6g m/s, c_R %.6g m/s\n",
              solid::longitudinal_speed_m_per_s(config.material), solid::shear_speed_m_per_s(config.material),
              solid::rayleigh_speed_m_per_s(config.material));
  const auto go_on = [](std::int64_t, std::int64_t) { return true; };
  const InitialState initial = setup::make_initial_state(config, go_on);
  motion::Observers observers;
  observers.push_back(std::make_unique<SlipLimit>(20e-6, 1e-6));
  const run::Result result = run::run_from(config, initial, go_on, {}, std::move(observers));
  std::printf("%s\n", run::end_of_event(result).c_str());
  for (const auto& front : result.fronts)
    std::printf("front %d: x = %.4f to %.4f m\n", front.id, front.points.front().x_m,
                front.points.back().x_m);
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw slipfront::UserError("usage: downstream CASE.toml");
  return run(argv[1]);
} catch (const slipfront::UserError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "downstream: %s\n", error.what());
  return 1;
}
