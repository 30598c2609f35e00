// SPDX-License-Identifier: BSD-3-Clause
#include "run/fields.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <span>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "files/files.hpp"
#include "results/stream.hpp"
#include "run/run.hpp"
#include "run/snapshot_mesh.hpp"

namespace slipfront::run {

namespace {

/// What all ranks have to know.
struct Order {
  std::filesystem::path file, raw;
  std::uint64_t raw_bytes = 0, n_snapshots = 0;
  std::filesystem::path sign;  ///< a file, and beside it others with the numbers of ranks
  std::string sign_text;
  mesh::Grid plate;
  std::optional<mesh::Grid> base;

  void put(MessageBuffer& to) const {
    for (const auto& path : {file, raw, sign}) to.put(path.string());
    to.put(raw_bytes).put(n_snapshots).put(sign_text).put(plate);
    to.put(static_cast<std::uint8_t>(base.has_value()));
    if (base) to.put(*base);
  }
  static Order take(MessageBuffer& from) {
    Order order;
    for (auto* path : {&order.file, &order.raw, &order.sign}) *path = from.take_text();
    order.raw_bytes = from.take<std::uint64_t>();
    order.n_snapshots = from.take<std::uint64_t>();
    order.sign_text = from.take_text();
    order.plate = from.take<mesh::Grid>();
    if (from.take<std::uint8_t>() != 0) order.base = from.take<mesh::Grid>();
    return order;
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
  return order.sign.string() + "." + std::to_string(rank);
}

bool holds_sign(const std::filesystem::path& file, const Order& order) {
  std::ifstream stream(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == order.sign_text;
}

/// Whether this rank sees the files of rank 0, and leaves a sign for it.
bool answers_sign(const Order& order, int rank) {
  std::error_code error;
  if (!holds_sign(order.sign, order) || std::filesystem::file_size(order.raw, error) != order.raw_bytes ||
      error)
    return false;
  try {
    files::write_text(sign_of(order, rank), order.sign_text);
  } catch (const WriteError&) {
    return false;
  }
  return true;
}

void write(const Order& order, const input::Case& config, const std::function<SnapshotMesh()>& make_mesh,
           results::Writer writer) {
  std::optional<SnapshotMesh> mesh;
  results::SnapshotSeries series;
  writer.together([&] {
    mesh = make_mesh();
    series = results::read_snapshots(order.raw, mesh->slabs.n_nodes);
    if (series.time_s.size() != order.n_snapshots)
      throw WriteError("{}: is not what was written: it was changed meanwhile", order.raw.string());
  });
  writer.count = std::min(writer.count, static_cast<int>(mesh->slabs.n_slabs));
  results::write_snapshots(order.file, mesh->slabs, series, snapshot_contents(config, *mesh), writer);
}

/// Whether all ranks see the files of rank 0, and it sees theirs.
bool all_see(const Order& order, Processes& processes) {
  bool all_see = true;
  const bool sees = processes.is_root() || answers_sign(order, processes.rank());
  processes.gather(std::move(MessageBuffer().put(sees)), [&](int rank, MessageBuffer& answer) {
    all_see = answer.take<bool>() && (rank == 0 || holds_sign(sign_of(order, rank), order)) && all_see;
  });
  return processes.broadcast(std::move(MessageBuffer().put(all_see))).take<bool>();
}

Order order_of(const results::ResultFolder& folder, const InitialState& bodies) {
  Order order;
  order.file = std::filesystem::absolute(folder.unfinished() / "fields.vtkhdf");
  order.raw = std::filesystem::absolute(results::ResultStream::snapshot_file(folder.state()));
  order.sign = std::filesystem::absolute(folder.state() / "seen-by-all");
  order.sign_text = unique_text();
  order.plate = bodies.mesh.grid;
  if (bodies.base) order.base = bodies.base->grid;
  order.n_snapshots =
      results::read_snapshots(order.raw, static_cast<std::size_t>(bodies.n_nodes)).time_s.size();
  order.raw_bytes = std::filesystem::file_size(order.raw);
  return order;
}

}  // namespace

void write_fields(const results::ResultFolder* folder, const input::Case& config, const InitialState& bodies,
                  Processes& processes, const std::function<void(const std::string&)>& note) {
  const bool is_in_rows = input::has_equal_elements(config);
  const auto write_alone = [&](const Order& order) {
    if (order.n_snapshots == 0) return;
    const auto make_mesh = [&] {
      return is_in_rows ? snapshot_mesh_in_rows(config, order.plate, order.base)
                        : whole_snapshot_mesh(check(config, processes));
    };
    write(order, config, make_mesh, {});
  };
  if (processes.size() == 1) return write_alone(order_of(*folder, bodies));
  auto told = processes.from_root([&](MessageBuffer& to) {
    const auto order = order_of(*folder, bodies);
    files::write_text(order.sign, order.sign_text);
    order.put(to);
  });
  const auto order = Order::take(told);
  if (is_in_rows && order.n_snapshots > 0 && all_see(order, processes)) {
    const auto make_mesh = [&] {
      return snapshot_mesh_in_rows(config, order.plate, order.base, processes.size());
    };
    try {
      return write(order, config, make_mesh,
                   {processes.rank(), processes.size(), [&](const auto& work) { processes.together(work); }});
    } catch (const ProcessError& error) {
      throw WriteError("{}", error.what());
    }
  }
  processes.from_root([&](MessageBuffer&) {
    if (is_in_rows && order.n_snapshots > 0)
      note(fmt::format("{} is written by rank 0 alone: others do not see {}, or cannot write there",
                       order.file.filename().string(), folder->dir().string()));
    write_alone(order);
  });
}

}  // namespace slipfront::run
