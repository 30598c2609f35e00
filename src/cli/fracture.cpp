// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "advice/notes.hpp"
#include "advice/prediction.hpp"
#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/print.hpp"
#include "cli/words.hpp"
#include "files/files.hpp"
#include "fracture/prediction.hpp"
#include "problem/problem.hpp"
#include "setup/meshes.hpp"

namespace slipfront::cli {
namespace {

struct FractureOptions {
  std::optional<double> fracture_energy_J_per_m2, residual_coefficient, x_m;
  std::string output;
};

/// By it a file is known that may be replaced.
constexpr std::string_view mark = "# fronts by slipfront fracture\n";

/// @throws UserError where anything but such a table is there
void require_own(const std::filesystem::path& file) {
  if (!files::is_there(file)) return;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file)))
    throw UserError("{}: is no regular file: not replaced; give another name with -o", file.string());
  std::string beginning(mark.size(), ' ');
  std::ifstream stream(file, std::ios::binary);
  stream.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  if (!stream || beginning != mark)
    throw UserError(
        "{}: is there and not a table of slipfront fracture: not replaced; give another name with -o",
        file.string());
}

std::string csv(const fracture::Prediction& prediction) {
  std::string text = std::string(mark) + "direction";
  for (const auto& column : fracture::predicted_fields) text += fmt::format(",{}", column.name);
  text += "\n";
  for (const auto& front : prediction.fronts)
    for (const auto& point : front.points) {
      text += fmt::format("{}", front.direction);
      for (const auto& column : fracture::predicted_fields) {
        const double value = point.*column.member;
        text += !std::isfinite(value) ? "," : fmt::format(",{}", value);
      }
      text += "\n";
    }
  return text;
}

std::string line_of(const advice::FracturePrediction& p, const fracture::PredictedFront& front, double c_S) {
  const auto& last = front.points.back();
  double fastest = 0;
  for (const auto& point : front.points) fastest = std::max(fastest, point.v_tip_m_per_s);
  const auto to = fmt::format("front to {}x: ", front.direction > 0 ? '+' : '-');
  if (std::isinf(last.fracture_energy_J_per_m2) && fastest == 0)
    return to + fmt::format("does not run: friction does not weaken at {:.4f} m\n", last.x_m);
  if (fastest == 0)
    return to + fmt::format("does not run: G {:.3g} J/m2, fracture energy {:.3g}\n", last.G_static_J_per_m2,
                            last.fracture_energy_J_per_m2);
  const auto runs = to + fmt::format("from {:.4f} m, at most {:.4g} m/s, {:.2g} c_S, ",
                                     front.points.front().x_m, fastest, fastest / c_S);
  if (front.end == fracture::PredictedEnd::contact_end) return runs + "through to the end of the contact\n";
  if (!p.predicts_arrest(front))
    return runs +
           fmt::format("G at rest below the fracture energy from {:.4f} m on, see the note\n", last.x_m);
  if (std::isinf(last.fracture_energy_J_per_m2))
    return runs + fmt::format("arrests at {:.4f} m, where friction does not weaken\n", last.x_m);
  return runs +
         fmt::format("arrests at {:.4f} m: G {:.3g} J/m2, {:.2g} % short of the fracture energy {:.3g}\n",
                     last.x_m, last.G_static_J_per_m2,
                     100 * (1 - last.G_static_J_per_m2 / last.fracture_energy_J_per_m2),
                     last.fracture_energy_J_per_m2);
}

void predict(const CaseArguments& arguments, const FractureOptions& options) {
  if (!options.output.empty()) require_own(options.output);
  const auto given = arguments.read();
  const auto problem = problem::make_problem(given.config());
  advice::TipFriction friction;
  friction.x_m = {0};
  if (options.fracture_energy_J_per_m2)
    friction.fracture_energy_J_per_m2 = {*options.fracture_energy_J_per_m2};
  if (options.residual_coefficient) friction.residual_coefficient = {*options.residual_coefficient};
  std::optional<advice::FrontPredictor> predictor;
  try {
    given.placing_errors([&] { return predictor.emplace(problem), true; });
  } catch (const UserError& error) {
    if (!problem.is_slow()) throw;
    given.placing_errors([&] { return setup::check(problem); });  // else it is the case that is refused
    print_output(fmt::format("note: {}\n", advice::no_static_state(error)));
    return;
  }
  const auto p = given.placing_errors([&] { return predictor->predict(friction, options.x_m); });
  const auto& of = p.of_fronts;
  const double c_S = solid::shear_speed_m_per_s(problem.above().material);
  std::string text = fmt::format("statics of {}, {} nodes on the interface\n", p.bodies, p.n_nodes);
  text += fmt::format("first crack {:.4g} m: {}\n", of.first_length_m,
                      of.starts      ? "it runs"
                      : p.covers_all ? "the whole interface"
                                     : "its energy release rate is below the fracture energy");
  if (!of.starts && !p.covers_all)
    text += std::isnan(of.critical_length_m)
                ? "no crack from there runs, however long\n"
                : fmt::format("critical crack {:.4g} m: from this length on it runs, as follows\n",
                              of.critical_length_m);
  if (std::isfinite(p.nucleation_length_m) && !p.covers_all)
    text += fmt::format(
        "nucleation length {:.3g} m, of this sample where the crack begins: slow slip over it runs away\n",
        p.nucleation_length_m);
  for (const auto& front : of.fronts) text += line_of(p, front, c_S);
  text += lines_of(given, p.notes);
  if (!options.output.empty()) {
    files::write_text(options.output, csv(of));
    text += fmt::format("results: {}\n", options.output);
  }
  print_output(text);
}

}  // namespace

void add_fracture(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "fracture",
      "Predict a case's fronts as cracks: whether they start, how fast they run, where they arrest");
  command->group("Cases");
  const auto arguments = add_case_arguments(*command);
  auto options = std::make_shared<FractureOptions>();
  command
      ->add_option("--fracture-energy", options->fracture_energy_J_per_m2,
                   "J/m2, instead of that of the friction law; laws that do not weaken over a slip have none")
      ->check(positive())
      ->check(finite());
  command
      ->add_option("--residual-coefficient", options->residual_coefficient,
                   "Residual traction over pressure, instead of mu_k")
      ->check(finite());
  command->add_option("--x", options->x_m, "Where the crack begins, m, instead of at the case's trigger")
      ->check(finite());
  command->add_option("-o,--output", options->output, "CSV table, a row per front and node")
      ->type_name("FILE")
      ->check(not_empty());
  command->callback([arguments, options] { predict(*arguments, *options); });
}

}  // namespace slipfront::cli
