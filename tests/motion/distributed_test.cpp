// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.hpp"
#include "base/lanes.hpp"
#include "interface/friction/rate_and_state.hpp"
#include "mesh/node_columns.hpp"
#include "motion/distributed_stepper.hpp"
#include "motion/event.hpp"
#include "motion/problems.hpp"
#include "support/files.hpp"
#include "support/processes.hpp"

namespace slipfront::motion {
namespace {

using namespace support;

/// What a run of some steps leaves.
struct Outcome {
  Snapshot snapshot;
  record::SlipRecord record;
  record::History history;
  record::ProbeRecord probes;
  record::Energies energies;
  double node_updates = 0;
};

/// A run that may change its stepper on the way.
struct Journey {
  explicit Journey(const Begin& begin) : recorder(begin.state, 1.3, begin.halo, 1e-6) {}
  support::RowRecorder recorder;
  Outcome outcome;
};

void take_steps(Journey& journey, TimeStepper& stepper, std::int64_t n_steps) {
  auto& [recorder, outcome] = journey;
  auto before_m = stepper.probed_u_m();
  ProbeRecorder probes(stepper.probes(), stepper.step_s(), 3 * stepper.step_s(), before_m, before_m);
  recorder.to_row = [&]() -> record::History* {
    return stepper.step() % 7 == 0 ? &journey.outcome.history : nullptr;
  };
  recorder.probes = &probes;
  recorder.n_guaranteed = 1000;
  for (std::int64_t done = 0; done < n_steps;) {
    const auto n = std::min<std::int64_t>(23, n_steps - done);
    probes.expect(stepper.step(), n);
    done += stepper.advance(recorder, n);
    probes.take_rows(stepper.step(), outcome.probes);
  }
  outcome.snapshot = stepper.snapshot();
  outcome.record = recorder.record_until(stepper.time_s());
  outcome.energies = stepper.energies();
  outcome.node_updates = stepper.node_updates_per_step();
}

Outcome run(TimeStepper& stepper, const Begin& begin, std::int64_t n_steps) {
  Journey journey(begin);
  take_steps(journey, stepper, n_steps);
  return journey.outcome;
}

Outcome run_by_one(const Problem& problem, std::int64_t n_steps) {
  const Bodies bodies(problem);
  const auto begin = begin_of(problem, bodies);
  const auto sources = bodies.sources();
  Stepper stepper(sources, problem.contact, problem.time, {});
  stepper.set_probes(locate_probes(problem.probes, sources));
  stepper.start(begin.state, 0, begin.loads);
  return run(stepper, begin, n_steps);
}

std::vector<StateByNode> chunks_of(TimeStepper& stepper) {
  std::vector<StateByNode> chunks;
  stepper.keep([&](const StateByNode& chunk) { chunks.push_back(chunk); });
  return chunks;
}

/// The same of one rank, in so many chunks.
std::vector<StateByNode> chunks_of(Stepper& stepper, int n_chunks) {
  std::vector<StateByNode> chunks;
  for (int k = 0; k < n_chunks; ++k) chunks.push_back(keep(stepper.state(), stepper.step(), k, n_chunks));
  return chunks;
}

void restore(TimeStepper& stepper, const Loads& loads, const std::vector<StateByNode>& chunks) {
  auto next = chunks.begin();
  stepper.restore(loads, [&] {
    next->require_possible();
    return *next++;
  });
}

/// The bodies on several ranks, in threads; the state before the event is in them.
class Team {
 public:
  Team(int n_ranks, const Problem& problem) : problem_(problem), bodies_(problem), mail_(n_ranks) {
    const auto sources = bodies_.sources();
    for (const auto& source : sources) steps_.push_back(body_steps(source, problem.time));
    std::vector<const mesh::Mesh*> meshes = {&bodies_.above};
    if (bodies_.below) meshes.push_back(&*bodies_.below);
    const auto whole = decomposition_of(partition_bodies(sources, steps_, problem.time, n_ranks), meshes);
    const auto start = begin();
    for (int rank = 0; rank < n_ranks; ++rank) processes_.emplace_back(mail_, rank);
    steppers_.resize(processes_.size());
    on_ranks([&](std::unique_ptr<DistributedStepper>& stepper, int rank) {
      stepper = make_stepper(whole, rank);
      stepper->set_probes(locate_probes(problem.probes, sources));
      auto state = start.state;
      if (rank > 0) state.u_m = state.u_per_shear = state.below_u_m = state.below_u_per_shear = {};
      stepper->start(state, 0, start.loads);
    });
  }

  Begin begin() const { return begin_of(problem_, bodies_); }
  /// What each rank finds: all find the same, but rank 0 alone a snapshot.
  std::vector<Journey> take_steps(const std::vector<Journey>& before, std::int64_t n_steps) {
    auto journeys = before;
    on_ranks([&](auto& stepper, int rank) {
      motion::take_steps(journeys[static_cast<std::size_t>(rank)], *stepper, n_steps);
    });
    return journeys;
  }
  Journey take_steps(const Journey& before, std::int64_t n_steps) {
    const auto journeys = take_steps(std::vector<Journey>(steppers_.size(), before), n_steps);
    for (const auto& other : journeys) {
      EXPECT_EQ(other.outcome.energies, journeys.front().outcome.energies);
      EXPECT_EQ(other.outcome.history.t_Pa, journeys.front().outcome.history.t_Pa);
      EXPECT_EQ(other.outcome.probes.v_x_m_per_s, journeys.front().outcome.probes.v_x_m_per_s);
      EXPECT_EQ(other.outcome.record.onsets.size(), journeys.front().outcome.record.onsets.size());
    }
    return journeys.front();
  }
  std::vector<StateByNode> chunks() {
    std::vector<StateByNode> chunks;
    on_ranks([&](auto& stepper, int rank) {
      stepper->keep([&](const StateByNode& chunk) {
        EXPECT_EQ(rank, 0);
        chunks.push_back(chunk);
      });
    });
    return chunks;
  }
  void restore(const Loads& loads, const std::vector<StateByNode>& chunks) {
    on_ranks([&](auto& stepper, int /*rank*/) { motion::restore(*stepper, loads, chunks); });
  }

 private:
  template <class F>
  void on_ranks(F&& f) {
    test::on_ranks(static_cast<int>(steppers_.size()),
                   [&](int rank) { f(steppers_[static_cast<std::size_t>(rank)], rank); });
  }
  std::unique_ptr<DistributedStepper> make_stepper(const Decomposition& whole, int rank) {
    auto& processes = processes_[static_cast<std::size_t>(rank)];
    const auto& partition = whole.partition;
    const auto all = partition.all(rank);
    std::deque<mesh::Mesh> meshes;
    std::deque<BodySubdomain> parts;
    std::vector<BodySource> own;
    const auto sources = bodies_.sources();
    for (std::size_t b = 0; b < sources.size(); ++b) {
      meshes.push_back(mesh::make_columns(bodies_.plates[b], all));
      parts.push_back({all, partition.n_columns(), partition.own(rank), steps_[b],
                       [&](std::span<double> values) { processes.reduce_max(values); }});
      own.push_back({meshes.back(), sources[b].material, &parts.back(), nullptr, sources[b].machine});
    }
    return std::make_unique<DistributedStepper>(processes, whole, own, problem_.contact, problem_.time,
                                                problem_.execution);
  }

  Problem problem_;
  Bodies bodies_;
  test::Mailboxes mail_;
  std::deque<test::ThreadProcess> processes_;
  std::vector<BodySteps> steps_;
  std::vector<std::unique_ptr<DistributedStepper>> steppers_;
};

Outcome run_by(int n_ranks, const Problem& problem, std::int64_t n_steps) {
  Team team(n_ranks, problem);
  return team.take_steps(Journey(team.begin()), n_steps).outcome;
}

/// Bits of what slipped when, under which tractions.
std::vector<std::uint64_t> numbers_of(const record::SlipRecord& record) {
  std::vector<std::uint64_t> bits;
  for (const auto& change : record.onsets)
    bits.insert(bits.end(), {bits_of(change.time_s), 0U + change.node});
  for (const auto& change : record.stops) bits.insert(bits.end(), {bits_of(change.time_s), 0U + change.node});
  for (const auto& [t_Pa, p_Pa] : record.around) bits.insert(bits.end(), {bits_of(t_Pa), bits_of(p_Pa)});
  return bits;
}

/// @param rounding  of the sums over nodes
void expect_same(const Outcome& one, const Outcome& several, double rounding) {
  EXPECT_EQ(one.snapshot.time_s, several.snapshot.time_s);
  EXPECT_EQ(one.snapshot.u_m.x, several.snapshot.u_m.x);
  EXPECT_EQ(one.snapshot.u_m.y, several.snapshot.u_m.y);
  EXPECT_EQ(one.snapshot.v_m_per_s.x, several.snapshot.v_m_per_s.x);
  EXPECT_EQ(one.snapshot.v_m_per_s.y, several.snapshot.v_m_per_s.y);
  EXPECT_EQ(numbers_of(one.record), numbers_of(several.record));
  EXPECT_EQ(one.record.n_onsets_left_out, several.record.n_onsets_left_out);
  EXPECT_EQ(one.record.resolution_s, several.record.resolution_s);
  EXPECT_EQ(one.history.time_s, several.history.time_s);
  for (const auto& field : record::history_fields)
    EXPECT_EQ(one.history.*field.member, several.history.*field.member) << field.name;
  EXPECT_EQ(one.history.law_states, several.history.law_states);
  EXPECT_EQ(one.probes.time_s, several.probes.time_s);
  for (const auto& field : record::probe_fields)
    EXPECT_EQ(one.probes.*field.member, several.probes.*field.member) << field.name;
  double largest = 0;
  for (const auto& term : record::energy_terms)
    largest = std::max(largest, std::abs(one.energies.*term.member));
  for (const auto& term : record::energy_terms)
    EXPECT_NEAR(one.energies.*term.member, several.energies.*term.member, rounding * largest) << term.name;
  EXPECT_EQ(one.node_updates, several.node_updates);
}

constexpr std::int64_t run_steps = 120;

void expect_parts_change_nothing(const Problem& problem, const std::vector<int>& numbers = {2, 3}) {
  const auto one = run_by_one(problem, run_steps);
  EXPECT_GT(one.record.onsets.size(), 20U);
  for (const int n : numbers) {
    SCOPED_TRACE(fmt::format("{} processes", n));
    const bool is_single = problem.time.precision == Precision::single_precision;
    expect_same(one, run_by(n, problem, run_steps), is_single ? 1e-7 : 1e-13);
  }
}

class PartsOf : public ::testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, PartsOf, ::testing::ValuesIn(variants),
                         [](const auto& variant) { return variant.param.name; });

TEST_P(PartsOf, ABodyMoveAsItDoes) {
  Problem problem;
  GetParam().change(problem);
  expect_parts_change_nothing(problem, GetParam().numbers);
}

TEST(Subdomains, ShareTheStepsBetweenExchangesAmongThreads) {
  Problem problem;
  problem.plate.height_m = 0.2;
  const Bodies bodies(problem);
  for (const auto& [max_steps, per_sweep] :
       {std::pair{0, 16}, std::pair{16, 8}, std::pair{5, 3}, std::pair{1, 1}}) {
    const Execution execution{.threads = 2, .steps_per_sweep = 16, .max_steps = max_steps};
    EXPECT_EQ(Stepper(bodies.sources(), problem.contact, problem.time, execution).steps_per_sweep(),
              per_sweep);
  }
}

/// Wrong numbers put into the first columns of whole bodies, as far as they have come after a step.
TEST(Subdomains, AreWrongNoFartherThanTheColumnsOfAStep) {
  auto even = graded(), of_one_step = graded(), of_two = graded(), without_sub_steps = graded();
  even.plate.coarsenings = 0;
  of_one_step.time.local_steps = false;
  of_two.below = &gel;
  of_two.plate.coarsenings = 1;
  without_sub_steps.time.interface_substeps = without_sub_steps.time.interface_rows = 1;
  for (const auto& problem : {even, graded(), of_one_step, of_two, without_sub_steps}) {
    const Bodies bodies(problem);
    const auto sources = bodies.sources();
    const auto begin = begin_of(problem, bodies);
    Stepper stepper(sources, problem.contact, problem.time, {});
    stepper.start(begin.state, 0, begin.loads);
    const int n_wrong = 16;
    stepper.visit_columns({0, n_wrong}, []<class T>(T* values, std::size_t n) {
      if constexpr (std::is_floating_point_v<T>) std::fill_n(values, n, std::numeric_limits<T>::quiet_NaN());
    });
    Journey journey(begin);
    stepper.advance(journey.recorder, 1);
    int end = 0;
    std::vector<BodySteps> steps;
    for (const auto& body : stepper.bodies()) {
      steps.push_back(body.steps());
      for (std::size_t n = 0; n < body.u_m().size(); ++n)
        if (!std::isfinite(body.u_m().x[n]) || !std::isfinite(body.v_m_per_s().x[n]))
          end = std::max(end, body.columns().column_of(static_cast<mesh::Node>(n)) + 1);
    }
    const int most = columns_per_step(sources, step_plan(steps, problem.time));
    EXPECT_LE(end, n_wrong + most);
    EXPECT_GT(end, n_wrong);
  }
}

TEST(Subdomains, GoOnWithWhatAnyNumberOfThemKept) {
  Problem even, of_two, of_graded = graded(), of_two_graded = graded(), repeating = graded();
  of_two.below = of_two_graded.below = &gel;
  of_two_graded.plate.coarsenings = 1;
  of_two_graded.plate.width_m = 0.4;
  for (auto* problem : {&even, &of_two, &of_graded, &of_two_graded})
    problem->plate.corner = mesh::Corner::relief;
  repeating.plate.sides = mesh::Sides::periodic;
  repeating.plate.top = mesh::Top::absorbing;
  auto with_state = of_two;
  with_state.contact.law = interface::RateAndStateAging {};
  for (auto problem : {even, of_two, of_graded, of_two_graded, repeating, with_state}) {
    if (problem.contact.law.states().empty())
      problem.contact.algorithm = interface::ContactAlgorithm::predictor_corrector;
    const auto one = run_by_one(problem, run_steps);
    Team two(2, problem), three(3, problem);
    const auto begin = two.begin();
    Journey journey(begin);
    // Probes' velocities begin anew with each stepper.
    const auto compare = [&] {
      journey.outcome.probes = one.probes;
      expect_same(one, journey.outcome, 1e-13);
    };
    const std::int64_t first = 49, second = 47;
    journey = two.take_steps(journey, first);
    three.restore(begin.loads, two.chunks());
    journey = three.take_steps(journey, second);
    const Bodies bodies(problem);
    Stepper by_one(bodies.sources(), problem.contact, problem.time, {});
    restore(by_one, begin.loads, three.chunks());
    two.restore(begin.loads, chunks_of(by_one, 4));
    const auto by_two = journey;
    take_steps(journey, by_one, run_steps - first - second);
    compare();
    journey = two.take_steps(by_two, run_steps - first - second);
    compare();
  }
}

TEST(Subdomains, DoNotGoOnWithAnotherState) {
  Problem narrow, wide;
  wide.plate.width_m = 0.21;
  const Bodies bodies(narrow), others(wide);
  auto loads = begin_of(narrow, bodies).loads, other_loads = begin_of(wide, others).loads;
  for (auto* of : {&loads, &other_loads}) of->strength_fraction.clear();
  Stepper stepper(bodies.sources(), narrow.contact, narrow.time, {});
  Stepper other(others.sources(), wide.contact, wide.time, {});
  stepper.start(begin_of(narrow, bodies).state, 0, loads);
  other.start(begin_of(wide, others).state, 0, other_loads);
  const auto kept = chunks_of(stepper);
  Team two(2, narrow);
  const auto refusal = [&](TimeStepper& of, const Loads& its_loads, const auto& chunks) {
    return error_of([&] { restore(of, its_loads, chunks); });
  };
  const auto bodies_differ = testing::HasSubstr("belongs to other bodies");
  EXPECT_THAT(refusal(other, other_loads, kept), bodies_differ);
  EXPECT_THAT(refusal(stepper, loads, chunks_of(other)), bodies_differ);
  const auto weaker = begin_of(narrow, bodies).loads;
  EXPECT_THAT(refusal(stepper, weaker, kept), testing::HasSubstr("has loads of another case"));
  const auto refused = [&](const Loads& its_loads, const auto& chunks) {
    return error_of([&] { two.restore(its_loads, chunks); });
  };
  EXPECT_THAT(refused(weaker, kept), testing::HasSubstr("has loads of another case"));
  EXPECT_THAT(refused(loads, chunks_of(other)), bodies_differ);

  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  struct Change {
    const char* refusal;
    void (*change)(StateByNode& chunk);
  };
  for (const auto& [expected, change] : std::initializer_list<Change>{
           {"numbers", [](StateByNode& c) { c.values[5] = nan; }},
           {"numbers", [](StateByNode& c) { c.sums[1] = nan; }},
           {"numbers", [](StateByNode& c) { c.flags[0] = 2; }},
           {"other bodies", [](StateByNode& c) { c.number = 1; }},
           {"other bodies", [](StateByNode& c) { c.n_chunks = 0; }},
           {"other bodies", [](StateByNode& c) { c.runs[0].key = -1; }},
           {"other bodies", [](StateByNode& c) { c.runs[0].key += 1; }},
           {"other bodies", [](StateByNode& c) { c.runs[0].key = std::int64_t{1} << 62; }},
           {"other bodies", [](StateByNode& c) { c.runs[0].count = ~std::uint64_t{0}; }},
           {"other bodies", [](StateByNode& c) { c.runs.pop_back(); }},
           {"other bodies", [](StateByNode& c) { c.runs[0].width = 0; }},
           {"other bodies", [](StateByNode& c) { c.runs[0].body = 3; }},
           {"other bodies", [](StateByNode& c) { c.values.pop_back(); }},
           {"other bodies", [](StateByNode& c) { c.runs[0].list = 1; }},
           {"other bodies", [](StateByNode& c) { c.sums.pop_back(); }},
           {"other bodies", [](StateByNode& c) { c.flags.pop_back(); }}}) {
    auto chunks = kept;
    change(chunks.front());
    EXPECT_THAT(refusal(stepper, loads, chunks), testing::HasSubstr(expected));
    EXPECT_THAT(refused(loads, chunks), testing::HasSubstr(expected));
  }
  EXPECT_EQ(refusal(stepper, loads, kept), "(nothing thrown)");
}

TEST(BodySteps, OfManySquaresFollowFromInterfaceAndCorners) {
  // Sides that rounding makes unequal.
  mesh::Plate even{.width_m = 0.7, .element_size_m = 0.7 / 859, .corner = mesh::Corner::none};
  even.height_m = 600 * even.element_size_m;
  auto repeating = even, steep = even;
  repeating.sides = mesh::Sides::periodic;
  steep.corner = mesh::Corner::relief;
  steep.relief_length_m = 5e-3;
  steep.relief_height_m = 2e-3;
  steep.relief_depth_m = 9e-3;
  auto flat = steep;
  flat.relief_height_m = 1e-5;
  for (const auto* plate : {&even, &repeating, &steep, &flat}) {
    const auto whole = mesh::make_plate(*plate), interface = mesh::make_interface(*plate);
    std::optional<mesh::Mesh> corners;
    if (plate->corner == mesh::Corner::relief)
      corners = mesh::make_corners(*plate, solid::rings_around_others);
    ASSERT_TRUE(solid::takes_frequency_bound(whole.n_nodes(), mesh::blocks(whole)));
    const auto expected = body_steps({whole, pmma}, {});
    const auto found = body_steps({interface, pmma, nullptr, corners ? &*corners : nullptr}, {});
    EXPECT_EQ(found.stable_step_s, expected.stable_step_s);
    EXPECT_EQ(found.block_ratios, expected.block_ratios);
    // Of the steep reliefs the corners have the highest frequency, elsewhere squares.
    if (plate == &steep) {
      EXPECT_GT(body_steps({interface, pmma}, {}).stable_step_s, expected.stable_step_s);
    }
  }
}

/// How 1e10 nodes are divided that no process has, of plates of other measures as many as they have.
Partition divided(const mesh::Plate& plate, int n_subdomains) {
  const auto interface = mesh::make_interface(plate);
  const TimeStepping time{.interface_rows = 1, .interface_substeps = 1};
  const std::vector<BodySource> bodies = {{interface, pmma}};
  return partition_bodies(bodies, std::vector{body_steps(bodies.front(), time)}, time, n_subdomains);
}

TEST(Partition, OfAPlateThatNoneHoldsHasPartsThatCanBeNumbered) {
  const mesh::Plate plate{
      .width_m = 141.421, .height_m = 70.71, .element_size_m = 1e-3, .corner = mesh::Corner::none};
  for (const int n_subdomains : {5, 1000, 10000}) {
    const auto partition = divided(plate, n_subdomains);
    EXPECT_EQ(partition.n_columns(), 141422);
    for (int part = 0; part < n_subdomains; ++part)
      ASSERT_LT(partition.all(part).count() * std::int64_t{70711}, std::int64_t{1} << 31);
  }
  const auto refusal = [](const mesh::Plate& of, int n_subdomains) {
    return error_of([&] { divided(of, n_subdomains); });
  };
  for (const int n_subdomains : {2, 4})
    EXPECT_THAT(refusal(plate, n_subdomains), testing::HasSubstr("number; use more ranks, at least 5"));
  // No narrower than their halos, parts of 1e9 nodes to a column have too many.
  auto high = plate;
  high.width_m = 0.04;
  high.height_m = 1e6;
  EXPECT_THAT(refusal(high, 2), testing::HasSubstr("more ranks would have too few columns"));
}

TEST(SnapshotPieces, AreAllOfTheNodesOneAfterTheOther) {
  // 1e11 nodes, a body of as many columns below; rows of half a million, and of almost as many as there
  // may be.
  const std::vector<std::vector<mesh::Grid>> bodies = {
      {{.columns = 447213, .rows = 223606}, {.columns = 447213, .rows = 1000}},
      {{.columns = 5000, .rows = 500000}},
      {{.columns = 2147483645, .rows = 3}}};
  for (const auto& grids : bodies) {
    std::vector<mesh::NodeColumns> columns;
    for (const auto& grid : grids) columns.emplace_back(std::span(&grid, 1));
    const auto pieces = snapshot_chunks(columns);
    auto piece = pieces.begin();
    for (int component = 0; component < n_motion_components; ++component)
      for (std::size_t b = 0; b < grids.size(); ++b) {
        std::int64_t next = 0;
        for (int row = 0; row <= grids[b].rows; row = (piece++)->end_row) {
          ASSERT_EQ(piece->component, MotionComponent{component});
          ASSERT_EQ(piece->body, static_cast<int>(b));
          ASSERT_EQ(piece->first_row, row);
          const auto nodes = nodes_of(*piece, columns);
          ASSERT_EQ(nodes.first, next);
          ASSERT_EQ(nodes.count, std::int64_t{grids[b].stride()} * (piece->end_row - row));
          ASSERT_LE(nodes.count, std::max(nodes_of_snapshot_chunk, grids[b].stride()));
          next = nodes.end();
        }
        EXPECT_EQ(next, grids[b].n_nodes());
      }
    EXPECT_EQ(piece, pieces.end());
  }
}

TEST(LowerIn, OfAnInterfaceIsThatOfThePlate) {
  for (const auto sides : {mesh::Sides::free, mesh::Sides::periodic}) {
    const mesh::Plate plate{.width_m = 0.05,
                            .height_m = 0.01,
                            .element_size_m = 1e-3,
                            .corner = mesh::Corner::none,
                            .sides = sides};
    const auto whole = mesh::make_plate(plate), interface = mesh::make_interface(plate);
    for (const auto& columns : {mesh::Subset({{0, 20}}), mesh::Subset({{17, 51}}), mesh::Subset({{3, 4}}),
                                mesh::Subset({{0, 9}, {40, 51}})}) {
      const auto of_whole = interface_nodes_in(whole, columns),
                 of_interface = interface_nodes_in(interface, columns);
      ASSERT_EQ(of_interface.count(), of_whole.count());
      for (int k = 0; k < of_whole.count(); ++k) EXPECT_EQ(of_interface.number_at(k), of_whole.number_at(k));
    }
  }
}

/// How many processes a refusal of n allows.
int allowed_instead(int n, const Problem& problem, const std::string& why) {
  try {
    const Team team(n, problem);
  } catch (const UserError& error) {
    const std::string text = error.what();
    EXPECT_THAT(text, testing::HasSubstr(why));
    const auto at = text.rfind("choose at most ");
    return at == std::string::npos ? 0 : std::stoi(text.substr(at + 15));
  }
  return n;
}

/// As many processes as are allowed instead of each number change nothing.
/// @return how many these are
std::set<int> expect_allowed_change_nothing(const Problem& problem, std::initializer_list<int> numbers,
                                            const std::string& why) {
  std::set<int> allowed;
  for (const int n : numbers) allowed.insert(allowed_instead(n, problem, why));
  EXPECT_GT(*allowed.begin(), 0);
  expect_parts_change_nothing(problem, std::vector<int>(allowed.begin(), allowed.end()));
  return allowed;
}

TEST(Subdomains, DoNotEndAtARoundedCorner) {
  Problem problem;
  problem.plate.corner = mesh::Corner::fillet;
  const auto numbers = {6, 7, 9, 11, 13, 15};
  std::ptrdiff_t n_refused = 0;
  for (const int interface_rows : {2, 10}) {
    problem.time.interface_rows = interface_rows;
    const auto allowed = expect_allowed_change_nothing(problem, numbers, "rounded corner");
    EXPECT_GT(allowed.size(), 1U);
    n_refused += std::ranges::count_if(numbers, [&](int n) { return !allowed.contains(n); });
  }
  EXPECT_GT(n_refused, 1);
}

TEST(Subdomains, OfARingHaveHalosThatDoNotMeet) {
  Problem problem;
  problem.plate.sides = mesh::Sides::periodic;
  problem.plate.coarsenings = 3;
  problem.plate.height_m = 0.12;
  problem.plate.fine_height_m = 6e-3;
  problem.time.interface_substeps = 1;
  std::set<int> allowed_of_all;
  for (const int columns : {128, 208, 256}) {
    SCOPED_TRACE(fmt::format("{} columns", columns));
    problem.plate.width_m = columns * problem.plate.element_size_m;
    allowed_of_all.merge(expect_allowed_change_nothing(problem, {2, 3, 4}, "fewer than"));
  }
  EXPECT_GT(allowed_of_all.size(), 2U);
}

TEST(Subdomains, AreNoNarrowerThanTheirHalo) {
  const Problem problem;
  const int most = allowed_instead(40, problem, "fewer than");
  EXPECT_LT(most, 40);
  EXPECT_EQ(allowed_instead(most, problem, ""), most);
  mesh::Mesh mesh;
  mesh.grid.columns = 2000;
  const auto partition = partition_columns(mesh, 8, 5, 3);
  for (int part = 0; part < 8; ++part) {
    EXPECT_GE(partition.own(part).end - partition.own(part).begin, partition.halo);
    EXPECT_GE(partition.halo, 5 * partition.steps_per_exchange + 3);
  }
}

}  // namespace
}  // namespace slipfront::motion
