// SPDX-License-Identifier: BSD-3-Clause
// Checkpoints of tiny plates, damaged, with a checksum that fits the damage: what tells them from whole ones
// is only what they hold. They are refused, or the run goes on with them some steps without a fault.
//
// The first byte chooses the plate. Behind it come changes of the whole checkpoint: place (2 bytes, from the
// end of the file if its highest bit is set), kind and length (1 byte: 2 and 6 bits), and, where bytes are
// written, these. So what is made up does not depend on the layout of the state.
#include "run/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include "files/checksum.hpp"
#include "fuzz.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "results/stream.hpp"
#include "run/run.hpp"
#include "setup/event.hpp"
#include "setup/event_loads.hpp"

using namespace slipfront;
using problem::make_problem;

namespace {

constexpr std::size_t sum_digits = 64;
constexpr const char* file_name = "checkpoint-000001.bin";

/// 4 x 2 cells.
input::Case tiny_case() {
  input::Case config;
  config.plate.width_m = 0.04;
  config.plate.height_m = 0.02;
  config.plate.element_size_m = 0.01;
  config.base.kind = input::BaseKind::rigid;
  config.friction = interface::VelocityWeakening {};
  config.event = interface::EventKind::spontaneous;
  config.time.interface_rows = 1;
  config.time.interface_substeps = 2;
  config.time.end_s = 1;
  config.time.quiet_s = 1;
  return config;
}

input::Case prestressed_case() {
  auto config = tiny_case();
  config.loading.method = statics::LoadingMethod::prestress;
  config.prestress = {.t_Pa = 0.65e6, .p_Pa = 1e6, .file = {}};
  config.event = interface::EventKind::nucleation;
  config.nucleation.x_m = 0.02;
  config.nucleation.half_length_m = 0.01;
  return config;
}

std::array<input::Case, 3> cases() {
  std::array cases = {prestressed_case(), tiny_case(), tiny_case()};
  cases[1].time.precision = motion::Precision::single_precision;
  cases[1].contact = interface::ContactAlgorithm::predictor_corrector;
  cases[2].loading.method = statics::LoadingMethod::ramp;
  cases[2].loading.edge_margin_m = 0;
  return cases;
}

/// At the first step; the statics before it go on.
bool stop(std::int64_t, std::int64_t total) {
  return total == 0;
}

/// Of rows that nobody reads.
results::RowSink& sinks(const results::Output& /*output*/) {
  static results::KeptRows rows;
  return rows;
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A whole checkpoint of a run's first steps, without its checksum.
std::string checkpoint_of(const input::Case& config) {
  const fuzz::Scratch scratch;
  run::Checkpoints checkpoints(scratch.dir());
  run::CheckpointHead head;
  if (config.loading.method == statics::LoadingMethod::ramp) {
    motion::Stepper* stepper = nullptr;
    motion::RampRun* ramp = nullptr;
    const auto keep = [&](std::int64_t step, std::int64_t total) {
      if (stepper == nullptr) return stop(step, total);
      checkpoints.keep(head, [&](results::OutputArchive& archive) {
        run::write_motion(archive, *stepper);
        archive(*ramp);
      });
      return false;
    };
    const auto begins = [&](motion::Stepper& its_stepper, motion::RampRun& run) {
      stepper = &its_stepper;
      ramp = &run;
    };
    try {
      setup::make_initial_state(make_problem(config), keep, {}, begins);
    } catch (const Interrupted&) {
    }
  } else {
    auto initial = setup::make_initial_state(make_problem(config), stop);
    const auto stepper = setup::start_event(make_problem(config), initial);
    head.in_event = true;
    std::optional<motion::EventRun> event;
    const auto keep = [&](std::int64_t, std::int64_t) {
      checkpoints.keep(head, [&](results::OutputArchive& archive) {
        archive(initial);
        run::write_motion(archive, *stepper);
        archive(results::ResultStream::Extents{}, *event);
      });
      return false;
    };
    event.emplace(setup::begin_event(make_problem(config), initial, *stepper, keep, sinks));
    event->run();
  }
  auto content = content_of(scratch.dir() / file_name);
  fuzz::require(content.size() > sum_digits, "the run is over before its first checkpoint");
  content.resize(content.size() - sum_digits);
  return content;
}

/// Goes on as run::resume does, for some steps.
void go_on(const input::Case& config, run::Checkpoints::Checkpoint& kept) {
  if (kept.head.in_event) {
    auto initial = run::read_initial_state(kept.body, make_problem(config));
    const auto loads = setup::event_loads(make_problem(config), initial);
    const auto stepper = setup::make_stepper(make_problem(config), initial);
    run::read_motion(&kept.body, *stepper, loads);
    auto event = setup::begin_event(make_problem(config), initial, *stepper, stop, sinks);
    results::ResultStream::Extents extents;
    kept.body(extents, event);
    event.require_restored();
    kept.body.close();
    event.run();
  } else {
    setup::make_initial_state(make_problem(config), stop, {},
                              [&](motion::Stepper& stepper, motion::RampRun& ramp) {
                                run::read_motion(&kept.body, stepper, {});
                                kept.body(ramp);
                                kept.body.close();
                              });
  }
}

/// The changes that a fuzzer's bytes ask for.
std::string damaged(std::string content, std::string_view changes) {
  enum Kind { overwrite, insert, erase, cut };
  while (changes.size() >= 3 && !content.empty()) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(changes[k]); };
    const std::size_t place = byte(0) + 256U * (byte(1) & 0x7fU);
    const std::size_t from_begin = place % content.size();
    const std::size_t at = (byte(1) & 0x80U) != 0 ? content.size() - 1 - from_begin : from_begin;
    const auto kind = static_cast<Kind>(byte(2) >> 6U);
    const std::size_t length = std::min<std::size_t>(byte(2) & 0x3fU, content.size() - at);
    changes.remove_prefix(3);
    const auto bytes = changes.substr(0, length);
    if (kind == overwrite) content.replace(at, bytes.size(), bytes);
    if (kind == insert) content.insert(at, bytes);
    if (kind == erase) content.erase(at, length);
    if (kind == cut) content.resize(at);
    if (kind == overwrite || kind == insert) changes.remove_prefix(bytes.size());
  }
  return content;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch;
  static const auto configs = cases();
  static const std::array contents = {checkpoint_of(configs[0]), checkpoint_of(configs[1]),
                                      checkpoint_of(configs[2])};
  if (size == 0) return 0;
  const std::size_t k = data[0] % configs.size();
  auto content = damaged(contents[k], fuzz::text_of(data + 1, size - 1));
  content += files::sha256(content);
  scratch.write(file_name, content);
  bool refused = false;
  const auto kept = run::Checkpoints(scratch.dir()).last([&](const std::string&) { refused = true; });
  fuzz::require(refused != bool(kept), "a checkpoint is passed over without a word");
  if (!kept) return 0;
  const bool taken = fuzz::takes([&] {
    try {
      go_on(configs[k], *kept);
    } catch (const BlowUp&) {  // what was kept moves as no plate does
    } catch (const Interrupted&) {
    }
  });
  fuzz::require(taken || size > 1, "a whole checkpoint is refused");
  return 0;
}
