// SPDX-License-Identifier: BSD-3-Clause
#include "run/checkpoint.hpp"

#include <dlfcn.h>

#include <charconv>
#include <map>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/version.hpp"

namespace slipfront::run {
namespace {

namespace fs = std::filesystem;

/// Begins every checkpoint. The number goes up when what follows changes.
const std::string magic = "slipfront checkpoint 5";

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
  const std::size_t n = initial.mesh.interface_nodes.size();
  const auto fits = [&](const auto& states) {
    return statics::has_nodes(states.common, n) && statics::has_nodes(states.spontaneous, n);
  };
  const bool varies = config.friction_along_x.varies();
  if (initial.tributary_m.size() != n || initial.mu_s.size() != (varies ? n : 0) || !fits(initial) ||
      (initial.ramp && (!fits(*initial.ramp) || !record::is_consistent(initial.ramp->record))))
    throw UserError("the saved initial state belongs to another plate");
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

void read_motion(results::InputArchive& archive, motion::TimeStepper& stepper,
                 const std::function<std::unique_ptr<motion::Stepper>()>& make_whole) {
  int n_chunks = 0;
  archive(n_chunks);
  if (auto* plain = dynamic_cast<motion::PlainStepper*>(&stepper)) {
    archive(*plain);
    return;
  }
  auto* parted = dynamic_cast<motion::DistributedStepper*>(&stepper);
  if (parted == nullptr && n_chunks == 0) {
    archive(dynamic_cast<motion::Stepper&>(stepper));
    return;
  }
  const auto next = [&] {
    motion::StateByNode chunk;
    archive(chunk);
    chunk.require_consistent();
    return chunk;
  };
  if (parted != nullptr && n_chunks > 0) return parted->restore(n_chunks, next);
  if (parted != nullptr) {
    auto by_one = make_whole();
    archive(*by_one);
    auto kept = motion::keep(*by_one, whole_of(*by_one));
    by_one.reset();
    return parted->restore(1, [&] { return std::move(kept); });
  }
  auto& by_one = dynamic_cast<motion::Stepper&>(stepper);
  motion::StateByNode kept;
  for (int k = 0; k < n_chunks; ++k) kept.add(next(), n_chunks);
  kept.sort();
  motion::restore(kept, by_one, whole_of(by_one));
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
      return kept;
    } catch (const UserError& error) {
      const bool is_last = std::next(k) == files.rend();
      note(fmt::format("{}; {}", error.what(), is_last ? "the run begins anew" : "the one before is taken"));
    }
  }
  return {};
}

}  // namespace slipfront::run
