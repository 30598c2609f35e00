// SPDX-License-Identifier: BSD-3-Clause
#include "results/results.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "files/files.hpp"
#include "results/rows.hpp"

namespace slipfront::results {
namespace {

/// Long tables are written in pieces of this size.
constexpr std::size_t text_bytes_at_once = std::size_t{1} << 18U;

/// A CSV file, field by field.
class Csv {
 public:
  Csv(std::filesystem::path file, std::vector<std::string> columns, Numbers numbers,
      files::OutputFile& output)
      : file_(std::move(file)),
        columns_(std::move(columns)),
        numbers_(numbers),
        text_(fmt::format("{}\n", fmt::join(columns_, ","))),
        output_(output) {}
  /// @param missing  what the field holds where nothing is known of it: not a number where it may be empty
  void add(double value, double missing = 0) {
    if (numbers_ == Numbers::finite && !std::isfinite(value) && !(std::isnan(value) && std::isnan(missing)))
      throw_not_finite(file_, columns_[column_]);
    add(std::isnan(value) ? std::string() : fmt::format("{}", value));
  }
  void add(std::string_view text) {
    text_ += text;
    column_ = (column_ + 1) % columns_.size();
    text_ += column_ == 0 ? '\n' : ',';
    if (text_.size() >= text_bytes_at_once) hand_over();
  }
  void hand_over() {
    output_.write(text_);
    text_.clear();
  }

 private:
  std::filesystem::path file_;
  std::vector<std::string> columns_;
  Numbers numbers_;
  std::string text_;
  files::OutputFile& output_;
  std::size_t column_ = 0;
};

void write_csv(const std::filesystem::path& file, const std::vector<std::string>& columns, Numbers numbers,
               const std::function<void(Csv&)>& add_rows) {
  files::write_text(file, [&](files::OutputFile& output) {
    Csv csv(file, columns, numbers, output);
    add_rows(csv);
    csv.hand_over();
  });
}

}  // namespace

void throw_not_finite(const std::filesystem::path& file, const std::string& column) {
  throw BlowUp(
      fmt::format("{}: {} is not finite; look at the loads and the friction of the case, or choose "
                  "a smaller {}",
                  file.string(), column, Key("time.step_factor").name));
}

void write_static(const std::filesystem::path& file, const record::StaticState& state,
                  std::span<const NamedColumn> further) {
  SLIPFRONT_ASSERT(state.t_s_Pa.size() == state.x_m.size() && state.p_s_Pa.size() == state.x_m.size(),
                   "columns of the static state differ in length");
  std::vector<std::string> columns = {"x_m", "t_s_Pa", "p_s_Pa"};
  for (const NamedColumn& column : further) columns.emplace_back(column.name);
  write_csv(file, columns, Numbers::finite, [&](Csv& csv) {
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
      for (const double value : {state.x_m[i], state.t_s_Pa[i], state.p_s_Pa[i]}) csv.add(value);
      for (const NamedColumn& column : further) csv.add(column.values.at(i), nan);
    }
  });
}

void write_energies(const std::filesystem::path& file, std::span<const record::Energies> energies,
                    Numbers numbers) {
  std::vector<std::string> columns = {record::energy_time.name};
  for (const auto& term : record::energy_terms) columns.emplace_back(term.name);
  columns.emplace_back(record::imbalance_name);
  write_csv(file, columns, numbers, [&](Csv& csv) {
    for (const auto& e : energies) {
      csv.add(e.time_s);
      for (const auto& term : record::energy_terms) csv.add(e.*term.member);
      csv.add(record::imbalance_J_per_m(e, energies.front()));
    }
  });
}

void write_loading(const std::filesystem::path& file, std::span<const record::LoadingRow> rows,
                   Numbers numbers) {
  std::vector<std::string> columns = {"event", "phase"};
  for (const auto& column : record::loading_fields) columns.emplace_back(column.name);
  for (const auto& term : record::energy_terms) columns.emplace_back(term.name);
  columns.insert(columns.end(), {record::wave_loss.name, record::imbalance_name});
  const record::LoadingRow unknown;
  write_csv(file, columns, numbers, [&](Csv& csv) {
    for (const auto& row : rows) {
      csv.add(fmt::format("{}", row.n_events));
      csv.add(record::name(row.phase));
      for (const auto& column : record::loading_fields) csv.add(row.*column.member, unknown.*column.member);
      for (const auto& term : record::energy_terms) csv.add(row.energies.*term.member);
      csv.add(row.wave_loss_J_per_m);
      csv.add(record::imbalance_J_per_m(row, rows.front()));
    }
  });
}

void write_events(const std::filesystem::path& file, std::span<const record::SequenceEvent> events,
                  Numbers numbers) {
  std::vector<std::string> columns = {"event"};
  for (const auto& column : record::sequence_event_fields) columns.emplace_back(column.name);
  const record::SequenceEvent unknown;
  write_csv(file, columns, numbers, [&](Csv& csv) {
    for (std::size_t k = 0; k < events.size(); ++k) {
      csv.add(fmt::format("{}", k + 1));
      for (const auto& column : record::sequence_event_fields)
        csv.add(events[k].*column.member, unknown.*column.member);
    }
  });
}

void write_fronts(const std::filesystem::path& file, std::span<const fronts::Front> fronts, Numbers numbers) {
  const std::vector<std::string> columns = {
      "front_id", "x_m",    "onset_s", "direction", "v_tip_m_per_s", "t_s_Pa",       "p_s_Pa",
      "t_d_Pa",   "p_d_Pa", "t_r_Pa",  "p_r_Pa",    "U_s_J_per_m3",  "U_r_J_per_m3", "speed_kind"};
  write_csv(file, columns, numbers, [&](Csv& csv) {
    for (const fronts::Front& front : fronts)
      for (const fronts::FrontPoint& point : front.points) {
        csv.add(fmt::format("{}", front.id));
        csv.add(point.x_m);
        csv.add(point.onset_s);
        csv.add(fmt::format("{}", front.direction));
        for (const double value :
             {point.v_tip_m_per_s, point.t_s_Pa, point.p_s_Pa, point.t_d_Pa, point.p_d_Pa, point.t_r_Pa,
              point.p_r_Pa, point.U_s_J_per_m3, point.U_r_J_per_m3})
          csv.add(value, nan);
        csv.add(fronts::name(point.speed_kind));
      }
  });
}

void write_fracture(const std::filesystem::path& file, std::span<const fronts::Front> fronts,
                    const record::Breakdown& breakdown,
                    std::span<const std::vector<fracture::Passage>> passages, Numbers numbers) {
  std::vector<std::string> columns = {"front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s"};
  for (const auto& column : record::breakdown_fields) columns.emplace_back(column.name);
  for (const auto& column : fracture::passage_fields) columns.emplace_back(column.name);
  write_csv(file, columns, numbers, [&](Csv& csv) {
    for (std::size_t f = 0; f < fronts.size(); ++f) {
      const auto& front = fronts[f];
      for (std::size_t k = 0; k < front.points.size(); ++k) {
        const auto& point = front.points[k];
        csv.add(fmt::format("{}", front.id));
        csv.add(point.x_m);
        csv.add(point.onset_s);
        csv.add(fmt::format("{}", front.direction));
        csv.add(point.v_tip_m_per_s, nan);
        for (const auto& column : record::breakdown_fields)
          csv.add((breakdown.*column.member)[static_cast<std::size_t>(point.node)], nan);
        for (const auto& column : fracture::passage_fields) csv.add(passages[f][k].*column.member, nan);
      }
    }
  });
}

}  // namespace slipfront::results
