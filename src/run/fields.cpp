// SPDX-License-Identifier: BSD-3-Clause
#include "run/fields.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "files/files.hpp"
#include "results/outputs.hpp"
#include "results/snapshots.hpp"
#include "run/run.hpp"
#include "setup/meshes.hpp"
#include "setup/snapshot_mesh.hpp"

namespace slipfront::run {

namespace {

/// What all ranks have to know.
struct Order {
  std::string file;  ///< empty where there are no snapshots
  std::uint64_t bytes = 0;
  std::string sign, sign_text;  ///< a file, and beside it others with the numbers of ranks
  template <class Archive>
  void serialize(Archive& archive) {
    archive(file, bytes, sign, sign_text);
  }
};

/// A text that no other run's folder holds.
std::string unique_text() {
  std::random_device random;
  std::string text;
  for (int k = 0; k < 4; ++k) text += fmt::format("{:08x}", random());
  return text;
}

std::filesystem::path sign_of(const Order& order, int rank) {
  return order.sign + "." + std::to_string(rank);
}

bool holds_sign(const std::filesystem::path& file, const Order& order) {
  std::ifstream stream(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == order.sign_text;
}

/// Whether this rank sees the files of rank 0, and leaves a sign for it.
bool answers_sign(const Order& order, int rank) {
  std::error_code error;
  if (!holds_sign(order.sign, order) || std::filesystem::file_size(order.file, error) != order.bytes || error)
    return false;
  try {
    files::write_text(sign_of(order, rank), order.sign_text);
  } catch (const WriteError&) {
    return false;
  }
  return true;
}

void write(const Order& order, const Problem& problem, const std::function<setup::SnapshotMesh()>& make_mesh,
           results::Writer writer) {
  std::optional<setup::SnapshotMesh> mesh;
  writer.together([&] { mesh = make_mesh(); });
  writer.count = std::min(writer.count, static_cast<int>(mesh->slabs.n_slabs));
  results::finish_snapshots(order.file, mesh->slabs, snapshot_contents(problem, *mesh), writer);
}

/// Whether all ranks see the files of rank 0, and it sees theirs.
bool all_see(const Order& order, Processes& processes) {
  bool all_see = true;
  const bool sees = processes.is_root() || answers_sign(order, processes.rank());
  processes.gather(packed(sees), [&](int rank, MessageBuffer& answer) {
    all_see = unpacked<bool>(answer) && (rank == 0 || holds_sign(sign_of(order, rank), order)) && all_see;
  });
  return unpacked<bool>(processes.broadcast(packed(all_see)));
}

Order order_of(const std::filesystem::path& dir, const std::filesystem::path& state) {
  const auto file = std::filesystem::absolute(dir / results::snapshot_output.file);
  if (!files::is_there(file)) return {};
  return {file, std::filesystem::file_size(file), std::filesystem::absolute(state / "seen-by-all"),
          unique_text()};
}

}  // namespace

void write_fields(const std::filesystem::path& dir, const std::filesystem::path& state,
                  const Problem& problem, Processes& processes,
                  const std::function<void(const std::string&)>& note) {
  const bool is_in_rows = has_equal_elements(problem), are_several = processes.size() > 1;
  auto message = processes.from_root([&](MessageBuffer& to) {
    const auto order = order_of(dir, state);
    if (are_several && !order.file.empty()) files::write_text(order.sign, order.sign_text);
    to.append(packed(order));
  });
  const auto order = unpacked<Order>(message);
  if (order.file.empty()) return;
  if (is_in_rows && are_several && all_see(order, processes)) {
    try {
      return write(order, problem, [&] { return setup::snapshot_mesh_in_rows(problem, processes.size()); },
                   {processes.rank(), processes.size(), [&](const auto& work) { processes.together(work); }});
    } catch (const ProcessError& error) {
      throw WriteError("{}", error.what());
    }
  }
  processes.from_root([&](MessageBuffer&) {
    if (is_in_rows && are_several)
      note(fmt::format("{} is written by rank 0 alone: others do not see {}, or cannot write there",
                       results::snapshot_output.file, dir.string()));
    const auto make_mesh = [&] {
      return is_in_rows ? setup::snapshot_mesh_in_rows(problem)
                        : setup::whole_snapshot_mesh(setup::check(problem, processes));
    };
    write(order, problem, make_mesh, {});
  });
}

}  // namespace slipfront::run
