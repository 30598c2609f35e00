// SPDX-License-Identifier: BSD-3-Clause
#include "problem/source.hpp"

#include <algorithm>
#include <utility>

#include "files/files.hpp"
#include "files/text.hpp"
#include "input/entries.hpp"
#include "input/schema.hpp"
#include "interface/friction/coulomb.hpp"

namespace slipfront::problem {

namespace {

std::string resolved_text(input::Case config) {
  if (!config.prestress.file.empty()) config.prestress.file = prestress_file;
  if (!config.friction_along_x.file.empty()) config.friction_along_x.file = friction_file;
  return input::to_toml(config);
}

/// What a state without motion keeps of friction: the coefficients at rest.
std::string strengths_text(const input::Case& config) {
  auto at_rest = config;
  if (!config.friction_along_x.varies()) {
    at_rest.friction = interface::Coulomb { interface::static_coefficient(config.friction) };
    at_rest.friction.parameter(interface::FrictionLaw::cohesion_key) = config.friction.cohesion_Pa();
  }
  std::string text;
  for (const auto& entry : input::entries_of(at_rest))
    if (input::table_of(entry.key) == "friction") text += input::toml_text(entry.get(at_rest)) + "\n";
  return text + config.friction_along_x.table.text;
}

std::string state_key(const input::Case& config) {
  using input::Stage;
  if (is_prestressed(config)) {
    const bool t_follows =
        config.friction.has_states() && config.prestress.file.empty() && !config.prestress.t_Pa;
    return text_of_stages(config, {Stage::mesh, Stage::tractions}) +
           (t_follows ? text_of_stages(config, {Stage::motion}) : "") +
           (config.friction_along_x.varies() || config.friction.cohesion_Pa() > 0 ? strengths_text(config)
                                                                                  : "");
  }
  // Nodes at the edges slip during a ramp, by the law itself.
  if (config.loading.method == statics::LoadingMethod::ramp)
    return text_of_stages(config, {Stage::mesh, Stage::statics, Stage::motion});
  return text_of_stages(config, {Stage::mesh, Stage::statics}) + strengths_text(config);
}

/// The first line in which two texts differ, of `text`.
std::string first_difference(const std::string& text, const std::string& other) {
  std::size_t k = 0;
  while (k < text.size() && k < other.size() && text[k] == other[k]) ++k;
  const auto begin = text.rfind('\n', k == 0 ? 0 : k - 1) + 1;
  std::string line = text.substr(begin, text.find('\n', k) - begin);
  return files::one_line(line.substr(0, line.find("  #")));
}

/// The text of a sequence's case with an end that is the same for all; its other keys count as before.
std::string without_end(const Source& source) {
  auto config = input::parse_case(source.case_text, case_file);
  auto& sequence = config.sequence;
  sequence.max_events = 2;
  sequence.end_s = infinity;
  sequence.to_global_sliding = false;
  sequence.path = {};
  return input::to_toml(config);
}

void require_same(const std::string& wanted, const std::string& kept, const std::string& name) {
  if (wanted != kept)
    throw UserError("{}: is another case than the one that was begun, which has \"{}\"; start a new run",
                    name, first_difference(kept, wanted));
}

}  // namespace

Source source_of(const input::Case& config) {
  return {config.title, resolved_text(config), config.prestress.table.text,
          config.friction_along_x.table.text, state_key(config)};
}

void write_case(const std::filesystem::path& dir, const Source& source) {
  if (!source.prestress_table.empty()) files::write_text(dir / prestress_file, source.prestress_table);
  if (!source.friction_table.empty()) files::write_text(dir / friction_file, source.friction_table);
  files::write_text(dir / case_file, source.case_text);
}

Problem read_problem(const std::filesystem::path& dir) {
  return make_problem(input::read_case(dir / case_file));
}

void require_same_keys(const Source& wanted, const Source& begun, const std::string& name) {
  require_same(wanted.case_text, begun.case_text, name);
}

void require_same_case(const Source& wanted, const Source& begun) {
  require_same_keys(wanted, begun, "the case");
  require_same(wanted.prestress_table, begun.prestress_table, "the table of its tractions");
  require_same(wanted.friction_table, begun.friction_table, "the table of its friction");
}

bool is_continuation(const Problem& problem, const Problem& done) {
  const auto &now = problem.source, &then = done.source;
  const auto begins_as = [](const std::vector<double>& values, const std::vector<double>& begin) {
    return values.size() >= begin.size() && std::equal(begin.begin(), begin.end(), values.begin());
  };
  const auto &sequence = problem.sequence, &done_sequence = done.sequence;
  const auto &path = sequence.path, &done_path = done_sequence.path;
  const bool ends_later = sequence.max_events >= done_sequence.max_events &&
                          sequence.end_s >= done_sequence.end_s &&
                          sequence.to_global_sliding <= done_sequence.to_global_sliding;
  return problem.is_sequence() && done.is_sequence() && ends_later && without_end(now) == without_end(then) &&
         now.prestress_table == then.prestress_table && now.friction_table == then.friction_table &&
         path.times_s.empty() == done_path.times_s.empty() && begins_as(path.times_s, done_path.times_s) &&
         begins_as(path.shears_m, done_path.shears_m);
}

void pack_case(const Problem& problem, MessageBuffer& to) {
  const auto& table = problem.friction.along_x.table;
  to.append(packed(problem.source.case_text, table.x_m, table.keys, table.values));
}

Problem unpack_case(MessageBuffer& from) {
  auto archive = MessageArchive::reader(from);
  std::string text;
  archive(text);
  auto config = input::parse_case(text, case_file);
  auto& table = config.friction_along_x.table;
  archive(table.x_m, table.keys, table.values);
  return make_problem(config);
}

}  // namespace slipfront::problem
