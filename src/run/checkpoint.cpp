// SPDX-License-Identifier: BSD-3-Clause
#include "run/checkpoint.hpp"

#include <dlfcn.h>

#include <charconv>
#include <cmath>
#include <map>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/state.hpp"
#include "base/version.hpp"
#include "run/begin.hpp"
#include "run/choices.hpp"

namespace slipfront::run {
namespace {

namespace fs = std::filesystem;

/// Begins every checkpoint. The number goes up when what follows changes.
const std::string magic = "slipfront checkpoint 6";

constexpr std::size_t n_kept = 2;
constexpr std::string_view prefix = "checkpoint-", suffix = ".bin";

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

InitialState read_initial_state(results::InputArchive& archive, const input::Case& config,
                                const Processes* processes) {
  InitialState initial;
  auto meshes = check(config, processes);
  initial.mesh = std::move(meshes.plate);
  initial.base = std::move(meshes.base);
  archive(initial);
  const auto x_m = interface_x_m(initial.mesh);
  const auto n_nodes = [](const mesh::Mesh& mesh) { return static_cast<std::size_t>(mesh.n_nodes()); };
  const auto is_possible = [&](const auto& states) {
    const auto n_below = initial.base ? n_nodes(*initial.base) : 0;
    return statics::is_possible(states.common, x_m, n_nodes(initial.mesh), n_below) &&
           statics::is_possible(states.spontaneous, x_m, n_nodes(initial.mesh), n_below);
  };
  const bool by_ramp = config.loading.method == statics::LoadingMethod::ramp;
  const auto count = [&](auto&& count_of) {
    return count_of(initial.mesh) + (initial.base ? count_of(*initial.base) : 0);
  };
  require_possible(initial.n_nodes == count(n_nodes_of) && initial.n_cells == count(n_cells_of) &&
                       initial.tributary_m == mesh::tributary_lengths_m(initial.mesh) &&
                       initial.mu_s == meshes.mu_s,
                   "a plate");
  require_possible(is_possible(initial) && initial.prescribed == is_prestressed(config) &&
                       initial.ramp.has_value() == by_ramp &&
                       initial.solver <= statics::StaticSolver::petsc &&
                       (initial.prescribed || std::isfinite(initial.critical_shear_m)),
                   "an initial state");
  require_possible(!by_ramp || (is_possible(*initial.ramp) && initial.ramp->record.x_m == x_m &&
                                record::is_consistent(initial.ramp->record)),
                   "a ramp");
  return initial;
}

void write_motion(results::OutputArchive& archive, motion::TimeStepper& stepper) {
  const auto* parted = dynamic_cast<const motion::DistributedStepper*>(&stepper);
  archive(parted != nullptr ? parted->partition().n_subdomains() : 0);
  if (parted != nullptr)
    parted->keep([&](const motion::StateByNode& chunk) { archive(chunk); });
  else if (auto* plain = dynamic_cast<motion::PlainStepper*>(&stepper))
    archive(*plain);
  else
    archive(dynamic_cast<motion::Stepper&>(stepper));
}

namespace {

/// The whole bodies of a stepper. Of a plate that repeats the last column has no cells, and nothing of it is
/// kept by several processes.
motion::SubdomainPlace whole_of(const motion::Stepper& stepper) {
  const auto& plate = stepper.bodies().front();
  const auto& columns = plate.columns();
  const int n = columns.n_columns();
  bool has_cells = false;
  for (int r = 0; r < columns.n_rows(); ++r) {
    const auto last = columns.nodes(r, {n - 1, n});
    has_cells = has_cells || (last.count > 0 && !plate.levels().is_orphan[last.first]);
  }
  return {.own = {0, has_cells ? n : n - 1}, .interface_nodes = {}};
}

}  // namespace

void read_motion(results::InputArchive& archive, motion::TimeStepper& stepper, const motion::Loads& loads,
                 const std::function<std::unique_ptr<motion::Stepper>()>& make_whole) {
  int n_chunks = 0;
  archive(n_chunks);
  archive.require(static_cast<std::uint64_t>(n_chunks));
  auto* parted = dynamic_cast<motion::DistributedStepper*>(&stepper);
  const auto read_whole = [&](auto& by_one) {
    archive(by_one);
    require_possible(by_one.has_loads(loads), "loads");
  };
  if (auto* plain = dynamic_cast<motion::PlainStepper*>(&stepper)) return read_whole(*plain);
  if (parted == nullptr && n_chunks == 0) return read_whole(dynamic_cast<motion::Stepper&>(stepper));
  const auto next = [&] {
    motion::StateByNode chunk;
    archive(chunk);
    chunk.require_consistent();
    return chunk;
  };
  if (parted != nullptr && n_chunks > 0) return parted->restore(n_chunks, next);
  if (parted != nullptr) {
    auto by_one = make_whole();
    read_whole(*by_one);
    auto kept = motion::keep(*by_one, whole_of(*by_one));
    by_one.reset();
    return parted->restore(1, [&] { return std::move(kept); });
  }
  auto& by_one = dynamic_cast<motion::Stepper&>(stepper);
  motion::StateByNode kept;
  for (int k = 0; k < n_chunks; ++k) kept.add(next(), n_chunks);
  kept.sort();
  motion::restore(kept, by_one, whole_of(by_one));
  require_possible(by_one.has_loads(loads), "loads");
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

std::unique_ptr<Checkpoints::Checkpoint> Checkpoints::last(
    const std::function<void(const std::string&)>& note) const {
  const auto files = numbered(dir_);
  for (auto k = files.rbegin(); k != files.rend(); ++k) {
    try {
      auto kept = std::make_unique<Checkpoint>(k->second);
      std::string begin;
      kept->rest(begin);
      if (begin != magic) throw UserError("{}: is damaged or of another version", k->second.string());
      kept->rest(kept->head);
      require_possible(kept->head.sessions > 0 && kept->head.wall_s >= 0 && std::isfinite(kept->head.wall_s),
                       "a session");
      return kept;
    } catch (const UserError& error) {
      const bool is_last = std::next(k) == files.rend();
      note(fmt::format("{}; {}", error.what(), is_last ? "the run begins anew" : "the one before is taken"));
    }
  }
  return {};
}

}  // namespace slipfront::run
