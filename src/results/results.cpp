// SPDX-License-Identifier: BSD-3-Clause
#include "results/results.hpp"

#include <fmt/core.h>

#include <cmath>

#include "base/error.hpp"
#include "files/files.hpp"

namespace slipfront::results {
namespace {

/// Long tables are written in pieces of this size.
constexpr std::size_t text_bytes_at_once = std::size_t{1} << 18U;

/// A field of a CSV file; empty where the value is undefined.
std::string field(double value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

}  // namespace

void write_static(const std::filesystem::path& file, const record::StaticState& state,
                  std::span<const NamedColumn> further) {
  SLIPFRONT_ASSERT(state.t_s_Pa.size() == state.x_m.size() && state.p_s_Pa.size() == state.x_m.size(),
                   "columns of the static state differ in length");
  std::string text = "x_m,t_s_Pa,p_s_Pa";
  for (const NamedColumn& column : further) text += fmt::format(",{}", column.name);
  text += "\n";
  for (std::size_t i = 0; i < state.x_m.size(); ++i) {
    text += fmt::format("{},{},{}", field(state.x_m[i]), field(state.t_s_Pa[i]), field(state.p_s_Pa[i]));
    for (const NamedColumn& column : further) text += fmt::format(",{}", field(column.values.at(i)));
    text += "\n";
  }
  files::write_text(file, text);
}

void write_energies(const std::filesystem::path& file, std::span<const record::Energies> energies) {
  std::string text = record::energy_time.name;
  for (const auto& term : record::energy_terms) text += fmt::format(",{}", term.name);
  text += fmt::format(",{}\n", record::imbalance_name);
  files::write_text(file, [&](files::OutputFile& output) {
    for (const auto& e : energies) {
      text += field(e.time_s);
      for (const auto& term : record::energy_terms) text += fmt::format(",{}", field(e.*term.member));
      text += fmt::format(",{}\n", field(record::imbalance_J_per_m(e, energies.front())));
      if (text.size() < text_bytes_at_once) continue;
      output.write(text);
      text.clear();
    }
    output.write(text);
  });
}

void write_loading(const std::filesystem::path& file, std::span<const record::LoadingRow> rows) {
  std::string text = "event,phase";
  for (const auto& column : record::loading_fields) text += fmt::format(",{}", column.name);
  for (const auto& term : record::energy_terms) text += fmt::format(",{}", term.name);
  text += fmt::format(",{},{}\n", record::wave_loss.name, record::imbalance_name);
  for (const auto& row : rows) {
    text += fmt::format("{},{}", row.n_events, record::name(row.phase));
    for (const auto& column : record::loading_fields) text += fmt::format(",{}", field(row.*column.member));
    for (const auto& term : record::energy_terms)
      text += fmt::format(",{}", field(row.energies.*term.member));
    text += fmt::format(",{},{}\n", field(row.wave_loss_J_per_m),
                        field(record::imbalance_J_per_m(row, rows.front())));
  }
  files::write_text(file, text);
}

void write_events(const std::filesystem::path& file, std::span<const record::SequenceEvent> events) {
  std::string text = "event";
  for (const auto& column : record::sequence_event_fields) text += fmt::format(",{}", column.name);
  text += "\n";
  for (std::size_t k = 0; k < events.size(); ++k) {
    text += fmt::format("{}", k + 1);
    for (const auto& column : record::sequence_event_fields)
      text += fmt::format(",{}", field(events[k].*column.member));
    text += "\n";
  }
  files::write_text(file, text);
}

void write_fronts(const std::filesystem::path& file, std::span<const fronts::Front> fronts) {
  std::string text =
      "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
      "U_s_J_per_m3,U_r_J_per_m3,speed_kind\n";
  for (const fronts::Front& front : fronts)
    for (const fronts::FrontPoint& point : front.points)
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", front.id, field(point.x_m),
                          field(point.onset_s), front.direction, field(point.v_tip_m_per_s),
                          field(point.t_s_Pa), field(point.p_s_Pa), field(point.t_d_Pa), field(point.p_d_Pa),
                          field(point.t_r_Pa), field(point.p_r_Pa), field(point.U_s_J_per_m3),
                          field(point.U_r_J_per_m3), fronts::name(point.speed_kind));
  files::write_text(file, text);
}

void write_fracture(const std::filesystem::path& file, std::span<const fronts::Front> fronts,
                    const fracture::Recorded& recorded, const fracture::Bodies& bodies) {
  std::string text = "front_id,x_m,onset_s,direction,v_tip_m_per_s";
  for (const auto& column : record::breakdown_fields) text += fmt::format(",{}", column.name);
  for (const auto& column : fracture::passage_fields) text += fmt::format(",{}", column.name);
  text += "\n";
  for (const auto& front : fronts) {
    const auto passages = fracture::passages(front, recorded, bodies);
    for (std::size_t k = 0; k < passages.size(); ++k) {
      const auto& point = front.points[k];
      text += fmt::format("{},{},{},{},{}", front.id, field(point.x_m), field(point.onset_s), front.direction,
                          field(point.v_tip_m_per_s));
      for (const auto& column : record::breakdown_fields)
        text += fmt::format(",{}",
                            field((recorded.breakdown.*column.member)[static_cast<std::size_t>(point.node)]));
      for (const auto& column : fracture::passage_fields)
        text += fmt::format(",{}", field(passages[k].*column.member));
      text += "\n";
    }
  }
  files::write_text(file, text);
}

}  // namespace slipfront::results
