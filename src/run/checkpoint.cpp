// SPDX-License-Identifier: BSD-3-Clause
#include "run/checkpoint.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/state.hpp"
#include "base/version.hpp"

namespace slipfront::run {
namespace {

namespace fs = std::filesystem;

/// Begins every checkpoint. The number goes up when what follows changes.
const std::string magic = "slipfront checkpoint 13";

constexpr std::size_t n_kept = 2;
constexpr std::string_view prefix = "checkpoint-", suffix = ".bin";
constexpr const char* begun_file = "begun.bin";

/// Checkpoints by their numbers.
std::map<std::int64_t, fs::path> numbered(const fs::path& dir) {
  std::map<std::int64_t, fs::path> files;
  std::error_code error;
  for (fs::directory_iterator k(dir, error), end; !error && k != end; k.increment(error)) {
    const std::string name = k->path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(suffix)) continue;
    std::int64_t number = 0;
    const char* last = name.data() + name.size() - suffix.size();
    if (std::from_chars(name.data() + prefix.size(), last, number).ptr == last) files[number] = k->path();
  }
  return files;
}

/// @throws UserError where it is damaged
std::unique_ptr<Checkpoints::Checkpoint> open_checkpoint(const fs::path& file) {
  auto kept = std::make_unique<Checkpoints::Checkpoint>(file);
  std::string begin;
  kept->body(begin);
  if (begin != magic) throw UserError("{}: is damaged or of another version", file.string());
  kept->body(kept->head);
  require_possible(kept->head.sessions > 0, "a session");
  return kept;
}

}  // namespace

/// The file that this code was loaded from: the program, or the shared library for this processor.
static std::string own_file() {
  Dl_info info{};
  const bool is_found = ::dladdr(reinterpret_cast<const void*>(&program_identity), &info) != 0;
  const std::string file = is_found ? info.dli_fname : "";
  return file.find(".so") != std::string::npos ? file : "/proc/self/exe";
}

const std::string& program_identity() {
  static const std::string identity =
      fmt::format("{}, build {}", version_line(), files::sha256_of_file(own_file()).substr(0, 16));
  return identity;
}

InitialState read_initial_state(results::InputArchive& archive, const Problem& problem,
                                const Processes& processes) {
  InitialState initial;
  auto meshes = setup::check(problem, processes);
  initial.mesh = std::move(meshes.plate);
  initial.base = std::move(meshes.base);
  archive(initial);
  const auto x_m = mesh::interface_x_m(initial.mesh);
  const auto n_nodes = [](const mesh::Mesh& mesh) { return static_cast<std::size_t>(mesh.n_nodes()); };
  const auto is_possible = [&](const auto& states) {
    const auto n_below = initial.base ? n_nodes(*initial.base) : 0;
    return statics::is_possible(states.subcritical, x_m, n_nodes(initial.mesh), n_below) &&
           statics::is_possible(states.supercritical, x_m, n_nodes(initial.mesh), n_below);
  };
  const bool by_ramp = problem.loading.method == statics::LoadingMethod::ramp;
  const auto count = [&](auto&& count_of) {
    return count_of(initial.mesh) + (initial.base ? count_of(*initial.base) : 0);
  };
  require_possible(initial.healed.size() == (problem.heals() ? x_m.size() : 0) &&
                       std::ranges::all_of(initial.healed, [](double gain) { return gain >= 0; }),
                   "strengths");
  require_possible(initial.n_nodes == count(setup::n_nodes_of) &&
                       initial.n_cells == count(setup::n_cells_of) &&
                       initial.tributary_m == mesh::tributary_lengths_m(initial.mesh),
                   "a plate");
  require_possible(is_possible(initial) && initial.ramp.has_value() == by_ramp &&
                       initial.cost.solver <= statics::StaticSolver::iterative &&
                       (problem.is_prestressed() || std::isfinite(initial.critical_shear_m)),
                   "an initial state");
  require_possible(
      initial.law_states.empty() || initial.law_states.size() == problem.friction.law.states().size(),
      "states of friction");
  for (const auto& values : initial.law_states)
    require_possible(values.size() == x_m.size() &&
                         std::ranges::all_of(values, [](double value) { return std::isfinite(value); }),
                     "states of friction");
  require_possible(!by_ramp || (is_possible(*initial.ramp) && initial.ramp->record.x_m == x_m &&
                                record::is_consistent(initial.ramp->record)),
                   "a ramp");
  return initial;
}

void write_motion(results::OutputArchive& archive, motion::TimeStepper& stepper) {
  stepper.keep([&](const motion::StateByNode& chunk) { archive(chunk); });
}

void read_motion(results::InputArchive* archive, motion::TimeStepper& stepper, const motion::Loads& loads) {
  stepper.restore(loads, [&] {
    motion::StateByNode chunk;
    (*archive)(chunk);
    chunk.require_possible();
    return chunk;
  });
}

void Checkpoints::keep(const CheckpointHead& head,
                       const std::function<void(results::OutputArchive&)>& write) {
  auto files = numbered(dir_);
  const auto number = files.empty() ? 1 : files.rbegin()->first + 1;
  results::OutputArchive archive(dir_ / fmt::format("{}{:06}{}", prefix, number, suffix));
  archive(magic, head);
  write(archive);
  archive.close();
  while (files.size() >= n_kept) {
    files::remove_file(files.begin()->second);
    files.erase(files.begin());
  }
}

void Checkpoints::begin(const CheckpointHead& head) {
  results::OutputArchive archive(dir_ / begun_file);
  archive(magic, head);
  archive.close();
}

std::optional<CheckpointHead> Checkpoints::begun() const {
  if (!files::is_there(dir_ / begun_file)) return {};
  const auto kept = open_checkpoint(dir_ / begun_file);
  kept->body.close();
  return kept->head;
}

std::unique_ptr<Checkpoints::Checkpoint> Checkpoints::last(
    const std::function<void(const std::string&)>& note) const {
  const auto files = numbered(dir_);
  for (auto k = files.rbegin(); k != files.rend(); ++k) {
    try {
      return open_checkpoint(k->second);
    } catch (const UserError& error) {
      const bool is_last = std::next(k) == files.rend();
      note(fmt::format("{}; {}", error.what(), is_last ? "the run begins anew" : "the one before is taken"));
    }
  }
  return {};
}

}  // namespace slipfront::run
