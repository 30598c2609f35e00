// SPDX-License-Identifier: BSD-3-Clause
#include "statics/petsc_equations.hpp"

#include "base/error.hpp"

#ifdef SLIPFRONT_PETSC
// Without the C++ bindings, which MPI no longer has: of Open MPI and of MPICH.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <petscksp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "solid/element.hpp"
#endif

namespace slipfront::statics {

#ifdef SLIPFRONT_PETSC

namespace {

constexpr int max_iterations = 2000;
/// What is solved with more than one beginning: after rounding, or where the first norm was too coarse.
constexpr int max_attempts = 8;
/// Of the error wanted, to which a solution goes on in a norm that only resembles it.
constexpr double margin = 0.3;
/// Finest levels on which aggregates have nodes two edges apart: more cycles, which take less each.
constexpr int aggressive_levels = 1;
/// What is taken for the least eigenvalue of the preconditioned equations until a less one is seen.
constexpr double first_eigenvalue = 0.25;
/// A displacement's norm over its guess's below which it is a motion as a whole.
constexpr double min_norm = 1e-3;
/// Decrease of the residual in the short solution that sees it where nodes slip.
constexpr double glance = 1e-3;

std::string& last_error() {
  static std::string text;
  return text;
}

/// Keeps PETSc's first message; the rest is its call stack.
PetscErrorCode keep_error(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                          const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL && message != nullptr) last_error() = message;
  return code;
}

void check(PetscErrorCode code) {
  if (code == 0) return;
  if (code == PETSC_ERR_MEM) throw std::bad_alloc();
  auto text = std::exchange(last_error(), {});
  std::ranges::replace(text, '\n', ' ');
  throw std::runtime_error(fmt::format("PETSc error {}: {}", static_cast<int>(code), text));
}

/// PETSc from its first use to the end of MPI, with a separate communicator. Neither the environment nor a
/// file of options nor the command line changes what it does.
class Library {
 public:
  static MPI_Comm comm() {
    static const Library library;
    return PETSC_COMM_WORLD;
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

 private:
  Library() {
    int is_on = 0;
    MPI_Initialized(&is_on);
    if (is_on == 0) {
      // Open MPI would start a helper for processes that this one might spawn.
      ::setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
      int provided = 0;
      MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
      is_alone_ = true;
    }
    MPI_Comm_dup(MPI_COMM_WORLD, &PETSC_COMM_WORLD);
    ::unsetenv("PETSC_OPTIONS");
    ::unsetenv("PETSC_OPTIONS_YAML");
    // They stay where PETSc finds them.
    static std::array<char, 10> program{"slipfront"};
    static std::array<char, 15> no_file{"-skip_petscrc"};
    static std::array<char, 20> no_signals{"-no_signal_handler"};
    static std::array<char*, 4> arguments{program.data(), no_file.data(), no_signals.data(), nullptr};
    static char** all = arguments.data();
    static int count = 3;
    check(PetscInitialize(&count, &all, nullptr, nullptr));
    check(PetscOptionsClear(nullptr));
    // Coarse equations made without the product of two of their three factors: several processes then take a
    // quarter less memory, and a fifth more time.
    int size = 1;
    MPI_Comm_size(PETSC_COMM_WORLD, &size);
    if (size > 1) check(PetscOptionsSetValue(nullptr, "-matptap_via", "allatonce"));
    check(PetscPushErrorHandler(keep_error, nullptr));
    // MPI frees what is attached to this communicator before it ends.
    int key = 0;
    MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, end, &key, nullptr);
    MPI_Comm_set_attr(MPI_COMM_SELF, key, nullptr);
  }
  ~Library() {
    if (is_alone_) MPI_Finalize();
  }
  static int end(MPI_Comm, int, void*, void*) {
    PetscFinalize();
    return MPI_SUCCESS;
  }
  bool is_alone_ = false;
};

/// One of PETSc's objects.
template <class T, PetscErrorCode (*destroy)(T*)>
class Owned {
 public:
  Owned() = default;
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  ~Owned() { destroy(&object_); }
  operator T() const { return object_; }  // NOLINT(google-explicit-constructor): as PETSc's functions take it
  /// For a function that makes one.
  T* renew() {
    check(destroy(&object_));
    return &object_;
  }

 private:
  T object_ = nullptr;
};
using Matrix = Owned<Mat, MatDestroy>;
using Vector = Owned<Vec, VecDestroy>;
using Solver = Owned<KSP, KSPDestroy>;
using NullSpace = Owned<MatNullSpace, MatNullSpaceDestroy>;

/// Own entries of a vector, to be written.
class Entries {
 public:
  explicit Entries(Vec vector) : vector_(vector) { check(VecGetArray(vector, &values_)); }
  Entries(const Entries&) = delete;
  Entries& operator=(const Entries&) = delete;
  ~Entries() { VecRestoreArray(vector_, &values_); }
  double& operator[](std::size_t k) { return values_[k]; }

 private:
  Vec vector_;
  double* values_ = nullptr;
};

std::vector<double> entries_of(Vec vector) {
  PetscInt n = 0;
  check(VecGetLocalSize(vector, &n));
  const double* values = nullptr;
  check(VecGetArrayRead(vector, &values));
  std::vector<double> all(values, values + n);
  check(VecRestoreArrayRead(vector, &values));
  return all;
}

void set_entries(Vec vector, std::span<const double> values) {
  Entries entries(vector);
  for (std::size_t k = 0; k < values.size(); ++k) entries[k] = values[k];
}

double dot(Vec a, Vec b) {
  double product = 0;
  check(VecDot(a, b, &product));
  return product;
}

/// A cell's stiffness by pairs of unknowns: its nodes' own, and the opposite ones that move relative nodes.
struct CellRows {
  std::vector<PetscInt> pair;   ///< at most 8
  std::vector<double> entries;  ///< row-major, two rows and columns a pair
};

class CellAssembly {
 public:
  explicit CellAssembly(const Subdomain::Body& body) : body_(body) {}

  const CellRows& rows(const mesh::Cell& cell) {
    solid::CellCoordinates c{};
    for (std::size_t a = 0; a < 4; ++a) {
      c[2 * a] = body_.nodes[cell[a]].x_m;
      c[2 * a + 1] = body_.nodes[cell[a]].y_m;
    }
    const auto K = solid::cell_stiffness(c, body_.material);
    rows_.pair.clear();
    struct Term {
      std::size_t at;
      std::array<double, 2> factor;
    };
    std::array<std::array<Term, 2>, 4> terms{};
    std::array<std::size_t, 4> n_terms{};
    for (std::size_t a = 0; a < 4; ++a) {
      const auto& node = body_.nodes[cell[a]];
      const auto of_node = terms_of(node.opposite >= 0, body_.is_base);
      terms[a][n_terms[a]++] = {place(node.pair), of_node.own};
      if (node.opposite >= 0) terms[a][n_terms[a]++] = {place(node.opposite), of_node.opposite};
    }
    const std::size_t width = 2 * rows_.pair.size();
    rows_.entries.assign(width * width, 0.0);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        for (std::size_t s = 0; s < n_terms[a]; ++s)
          for (std::size_t t = 0; t < n_terms[b]; ++t)
            for (std::size_t k = 0; k < 4; ++k) {
              const std::size_t i = k / 2, j = k % 2;
              const auto &row = terms[a][s], &column = terms[b][t];
              rows_.entries[(2 * row.at + i) * width + 2 * column.at + j] +=
                  row.factor[i] * column.factor[j] * K[(2 * a + i) * 8 + 2 * b + j];
            }
    return rows_;
  }

 private:
  std::size_t place(PetscInt pair) {
    const auto found = std::ranges::find(rows_.pair, pair) - rows_.pair.begin();
    if (found == std::ssize(rows_.pair)) rows_.pair.push_back(pair);
    return static_cast<std::size_t>(found);
  }

  const Subdomain::Body& body_;
  CellRows rows_;
};

}  // namespace

std::string_view petsc_version() {
  static const auto text =
      fmt::format("{}.{}.{}", PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
  return text;
}

class PetscEquations::Impl {
 public:
  explicit Impl(const Subdomain& subdomain)
      : comm_(Library::comm()),
        first_(2 * subdomain.first),
        n_(2 * subdomain.count),
        interface_nodes_(subdomain.interface_nodes),
        gap_m_(subdomain.gap_m),
        top_(subdomain.top),
        held_(subdomain.held) {
    assemble(subdomain);
    check(MatCreateVecs(K_, u0_.renew(), f_.renew()));
    for (auto* vector : {&u1_, &r_, &z_}) check(VecDuplicate(u0_, vector->renew()));
    make_rigid_modes(subdomain);
    check(MatDuplicate(K_, MAT_COPY_VALUES, A_.renew()));
    check(MatSetOption(A_, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
    check(MatSetNearNullSpace(A_, rigid_));
    for (const auto& body : subdomain.bodies)
      diagonal_ = std::max(diagonal_, body.material.youngs_modulus_Pa);
  }

  void begin(TopConstraint constraint, std::span<const double> u0, std::span<const double> u1) {
    constraint_ = constraint;
    is_sheared_ = !u1.empty();
    set_entries(u0_, u0);
    if (is_sheared_) set_entries(u1_, u1);
    if (!is_sheared_) check(VecZeroEntries(u1_));
    solved_.reset();
    prescribed_.clear();
    has_seen_eigenvalue_ = false;
    make_solvers();
  }

  std::optional<AtInterface> solve(const Support& support, double accuracy) {
    if (!(solved_ == support && accuracy >= solved_accuracy_)) {
      solved_.reset();
      take(support);
      if (!improve(u0_, accuracy) || (is_sheared_ && !improve(u1_, accuracy))) return std::nullopt;
      solved_ = support;
      solved_accuracy_ = accuracy;
    }
    AtInterface at;
    take_at_interface(u0_, at.u0, at.f0);
    take_at_interface(u1_, at.u1, at.f1);
    return at;
  }

  std::vector<double> own_u0() const { return entries_of(u0_); }
  std::vector<double> own_u1() const { return entries_of(u1_); }
  int n_iterations() const { return n_iterations_; }

 private:
  std::size_t local(PetscInt unknown) const { return static_cast<std::size_t>(unknown - first_); }

  void assemble(const Subdomain& subdomain) {
    // Pairs that share a cell.
    std::vector<std::vector<PetscInt>> neighbours(static_cast<std::size_t>(subdomain.count));
    const auto for_cells = [&](auto&& f) {
      for (const auto& body : subdomain.bodies) {
        CellAssembly assembly(body);
        for (const auto& cell : body.cells) f(assembly.rows(cell));
      }
    };
    for_cells([&](const CellRows& cell) {
      for (const auto pair : cell.pair) {
        if (!subdomain.has(pair)) continue;
        auto& of_pair = neighbours[static_cast<std::size_t>(pair - subdomain.first)];
        for (const auto other : cell.pair)
          if (std::ranges::find(of_pair, other) == of_pair.end()) of_pair.push_back(other);
      }
    });
    std::vector<PetscInt> n_own, n_others;
    for (const auto& of_pair : neighbours) {
      const auto own = std::ranges::count_if(of_pair, [&](PetscInt pair) { return subdomain.has(pair); });
      n_own.push_back(static_cast<PetscInt>(own));
      n_others.push_back(static_cast<PetscInt>(std::ssize(of_pair) - own));
    }
    neighbours = {};
    check(MatCreate(comm_, K_.renew()));
    check(MatSetSizes(K_, n_, n_, PETSC_DETERMINE, PETSC_DETERMINE));
    check(MatSetType(K_, MATAIJ));
    check(MatSetBlockSize(K_, 2));
    check(MatXAIJSetPreallocation(K_, 2, n_own.data(), n_others.data(), nullptr, nullptr));
    check(MatSetOption(K_, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
    std::vector<PetscInt> rows;
    for_cells([&](const CellRows& cell) {
      rows.clear();  // those of other processes are left out
      for (const auto pair : cell.pair) rows.push_back(subdomain.has(pair) ? pair : -1);
      const auto width = static_cast<PetscInt>(cell.pair.size());
      check(MatSetValuesBlocked(K_, width, rows.data(), width, cell.pair.data(), cell.entries.data(),
                                ADD_VALUES));
    });
    check(MatAssemblyBegin(K_, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(K_, MAT_FINAL_ASSEMBLY));
  }

  /// Of the bodies moving together: no relative displacement.
  void make_rigid_modes(const Subdomain& subdomain) {
    std::array<Vector, 3> modes;
    for (auto& mode : modes) check(VecDuplicate(u0_, mode.renew()));
    {
      Entries x(modes[0]), y(modes[1]), turned(modes[2]);
      for (const auto& body : subdomain.bodies) {
        const double sign = body.is_base ? -1 : 1;
        for (const auto& node : body.nodes) {
          if (!subdomain.has(node.pair)) continue;
          const auto k = local(2 * node.pair);
          const double is_absolute = node.opposite < 0 ? 1 : 0;
          x[k] = is_absolute;
          y[k + 1] = sign * is_absolute;
          turned[k] = -sign * is_absolute * node.y_m;
          turned[k + 1] = sign * is_absolute * node.x_m;
          x[k + 1] = y[k] = 0;
        }
      }
    }
    for (std::size_t a = 0; a < modes.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) check(VecAXPY(modes[a], -dot(modes[a], modes[b]), modes[b]));
      check(VecNormalize(modes[a], nullptr));
    }
    const std::array<Vec, 3> vectors{modes[0], modes[1], modes[2]};
    check(MatNullSpaceCreate(comm_, PETSC_FALSE, 3, vectors.data(), rigid_.renew()));
  }

  void make_solvers() {
    check(KSPCreate(comm_, cg_.renew()));
    check(KSPSetType(cg_, KSPCG));
    check(KSPSetNormType(cg_, KSP_NORM_NATURAL));
    check(KSPSetComputeSingularValues(cg_, PETSC_TRUE));
    PC pc = preconditioner();
    check(PCSetType(pc, PCGAMG));
    check(PCGAMGSetAggressiveLevels(pc, aggressive_levels));
    check(KSPCreate(comm_, bicgstab_.renew()));
    check(KSPSetType(bicgstab_, KSPBCGS));
    check(KSPSetPCSide(bicgstab_, PC_RIGHT));
    check(KSPSetNormType(bicgstab_, KSP_NORM_UNPRECONDITIONED));
    check(KSPSetPC(bicgstab_, pc));
  }

  PC preconditioner() const {
    PC pc = nullptr;
    check(KSPGetPC(cg_, &pc));
    return pc;
  }

  /// From one state of contact to the next the preconditioner keeps its aggregates. Those of unknowns that
  /// have become prescribed since may make it indefinite.
  void renew_preconditioner() {
    make_solvers();
    set_operators();
    check(KSPSetUp(cg_));
  }

  /// Fixes what the edges and the contact fix, and has nodes slip.
  void take(const Support& support) {
    std::vector<PetscInt> prescribed;
    for (const auto& [pair, place] : top_) {
      if (constraint_ == TopConstraint::both) prescribed.push_back(2 * pair);
      prescribed.push_back(2 * pair + 1);
    }
    for (const auto pair : held_) {
      prescribed.push_back(2 * pair);
      prescribed.push_back(2 * pair + 1);
    }
    slip_.clear();
    {
      Entries u0(u0_), u1(u1_);
      for (std::size_t k = 0; k < interface_nodes_.size(); ++k) {
        const auto place = static_cast<std::size_t>(interface_nodes_[k].place);
        const PetscInt x = 2 * interface_nodes_[k].pair, y = x + 1;
        if (support.contact[place] == Contact::open) continue;
        prescribed.push_back(y);
        u0[local(y)] = -gap_m_[k];
        u1[local(y)] = 0;
        if (support.contact[place] == Contact::stick) {
          prescribed.push_back(x);
          u0[local(x)] = support.anchor_x_m[place];
          u1[local(x)] = 0;
        } else {
          slip_.push_back({x, support.slip_sign[place] * support.mu_s[place]});
        }
      }
    }
    int changed = prescribed != prescribed_ ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, comm_);
    if (changed != 0) {
      prescribed_ = prescribed;
      check(MatCopy(K_, A_, SAME_NONZERO_PATTERN));
      check(MatZeroRowsColumns(A_, static_cast<PetscInt>(prescribed.size()), prescribed.data(), diagonal_,
                               nullptr, nullptr));
    }
    int slips = slip_.empty() ? 0 : 1;
    MPI_Allreduce(MPI_IN_PLACE, &slips, 1, MPI_INT, MPI_MAX, comm_);
    slips_ = slips != 0;
    if (slips_) add_friction();
    set_operators();
  }

  void set_operators() {
    check(KSPSetOperators(cg_, A_, A_));
    check(KSPSetOperators(bicgstab_, slips_ ? static_cast<Mat>(with_friction_) : static_cast<Mat>(A_), A_));
  }

  /// A with the rows of nodes that slip, f_x + factor f_y = 0: the sum of A and what friction adds.
  void add_friction() {
    std::vector<PetscInt> n_own(static_cast<std::size_t>(n_)), n_others(n_own.size());
    struct Row {
      PetscInt number;
      std::vector<PetscInt> columns;
      std::vector<double> entries;
    };
    std::vector<Row> rows;
    for (const auto& [x, factor] : slip_) {
      PetscInt n = 0;
      const PetscInt* columns = nullptr;
      const double* entries = nullptr;
      check(MatGetRow(K_, x + 1, &n, &columns, &entries));
      auto& row = rows.emplace_back(Row{x, {columns, columns + n}, {entries, entries + n}});
      check(MatRestoreRow(K_, x + 1, &n, &columns, &entries));
      for (auto& entry : row.entries) entry *= factor;
      for (const auto column : row.columns)
        ++(column >= first_ && column < first_ + n_ ? n_own : n_others)[local(x)];
    }
    check(MatCreate(comm_, friction_.renew()));
    check(MatSetSizes(friction_, n_, n_, PETSC_DETERMINE, PETSC_DETERMINE));
    check(MatSetType(friction_, MATAIJ));
    check(MatSeqAIJSetPreallocation(friction_, 0, n_own.data()));
    check(MatMPIAIJSetPreallocation(friction_, 0, n_own.data(), 0, n_others.data()));
    for (const auto& row : rows)
      check(MatSetValues(friction_, 1, &row.number, static_cast<PetscInt>(row.columns.size()),
                         row.columns.data(), row.entries.data(), INSERT_VALUES));
    check(MatAssemblyBegin(friction_, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(friction_, MAT_FINAL_ASSEMBLY));
    std::array<Mat, 2> both{A_, friction_};
    check(MatCreateComposite(comm_, 2, both.data(), with_friction_.renew()));
  }

  void clear_prescribed(Vec vector) {
    Entries entries(vector);
    for (const auto unknown : prescribed_) entries[local(unknown)] = 0;
  }

  /// r = -A u with friction, of the forces K u; 0 where displacements are prescribed.
  void set_residual() {
    check(VecCopy(f_, r_));
    check(VecScale(r_, -1));
    {
      Entries r(r_);
      for (const auto& [x, factor] : slip_) r[local(x)] += factor * r[local(x + 1)];
    }
    clear_prescribed(r_);
  }

  /// Brings the rest of u into equilibrium.
  bool improve(Vec u, double accuracy) {
    check(KSPSetUp(slips_ ? bicgstab_ : cg_));
    check(MatMult(K_, u, f_));
    const double first_norm = std::sqrt(std::abs(dot(u, f_)));
    auto outcome = iterate(u, first_norm, accuracy);
    if (outcome == Outcome::preconditioner_fails) {
      renew_preconditioner();
      outcome = iterate(u, first_norm, accuracy);
    }
    return outcome == Outcome::in_equilibrium;
  }

  enum class Outcome { in_equilibrium, too_slow, preconditioner_fails };

  /// With z = B r and B near the inverse, r . z is the square of the error in the energy norm; more exactly
  /// it lies below it by the least eigenvalue of B A, at most, which conjugate gradients find on the way.
  /// Friction may enlarge the error further: as much as it did that of the last attempt, whose correction was
  /// the error.
  Outcome iterate(Vec u, double first_norm, double accuracy) {
    for (int attempt = 0; attempt < max_attempts; ++attempt) {
      set_residual();
      if (slips_ && !has_seen_eigenvalue_ && !solve_without_friction(glance))
        return Outcome::preconditioner_fails;
      check(PCApply(preconditioner(), r_, z_));
      ++n_iterations_;
      // That of the guess where the displacement itself takes no energy.
      const double norm = std::sqrt(std::abs(dot(u, f_)));
      const double wanted = accuracy * (norm > min_norm * first_norm ? norm : first_norm);
      const double error2 = dot(r_, z_);
      if (error2 < 0) return Outcome::preconditioner_fails;
      const double error = std::sqrt(error2 / min_eigenvalue_);
      if (!std::isfinite(error)) return Outcome::too_slow;
      if (error <= wanted) {
        clear_prescribed(z_);
        check(VecAXPY(u, 1, z_));
        return Outcome::in_equilibrium;
      }
      const double reduction = std::max(margin * wanted / error, 1e-12);
      if (!(slips_ ? solve_with_friction(reduction) : solve_without_friction(reduction)))
        return Outcome::preconditioner_fails;
      clear_prescribed(z_);
      check(VecAXPY(u, 1, z_));
      check(MatMult(K_, z_, r_));
      check(VecAXPY(f_, 1, r_));
      min_eigenvalue_ = std::min(min_eigenvalue_, error2 / std::abs(dot(z_, r_)));
    }
    return Outcome::too_slow;
  }

  /// z from r. @return iterations, none where it goes no further
  std::optional<PetscInt> solve_by(KSP solver, double reduction) {
    check(KSPSetTolerances(solver, reduction, std::numeric_limits<double>::min(), 1e10, max_iterations));
    check(KSPSolve(solver, r_, z_));
    PetscInt n = 0;
    check(KSPGetIterationNumber(solver, &n));
    n_iterations_ += solver == bicgstab_ ? 2 * n : n;
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    check(KSPGetConvergedReason(solver, &reason));
    if (reason < 0 && reason != KSP_DIVERGED_ITS) return std::nullopt;
    return n;
  }

  /// @return whether the preconditioner serves
  bool solve_with_friction(double reduction) { return solve_by(bicgstab_, reduction).has_value(); }

  bool solve_without_friction(double reduction) {
    const auto n = solve_by(cg_, reduction);
    if (!n) return false;
    if (*n < 2) return true;
    double largest = 0, least = 0;
    check(KSPComputeExtremeSingularValues(cg_, &largest, &least));
    if (least > 0) min_eigenvalue_ = std::min(min_eigenvalue_, least);
    has_seen_eigenvalue_ = true;
    return true;
  }

  void take_at_interface(Vec u, std::vector<double>& displacements, std::vector<double>& forces) {
    check(MatMult(K_, u, f_));
    const auto of_u = entries_of(u), of_f = entries_of(f_);
    for (const auto& [pair, place] : interface_nodes_)
      for (const PetscInt unknown : {2 * pair, 2 * pair + 1}) {
        displacements.push_back(of_u[local(unknown)]);
        forces.push_back(of_f[local(unknown)]);
      }
  }

  MPI_Comm comm_;
  PetscInt first_, n_;
  std::vector<Subdomain::Place> interface_nodes_;
  std::vector<double> gap_m_;
  std::vector<Subdomain::Place> top_;
  std::vector<std::int32_t> held_;
  Matrix K_;  ///< of all unknowns, none prescribed
  Matrix A_;  ///< the same with rows and columns of prescribed unknowns cleared
  Matrix friction_, with_friction_;
  NullSpace rigid_;
  Solver cg_, bicgstab_;
  Vector u0_, u1_, f_, r_, z_;
  double diagonal_ = 0;                       ///< of A for prescribed unknowns
  double min_eigenvalue_ = first_eigenvalue;  ///< of B A, as far as seen
  TopConstraint constraint_ = TopConstraint::both;
  bool is_sheared_ = false, slips_ = false;
  bool has_seen_eigenvalue_ = false;  ///< in this load case
  std::vector<PetscInt> prescribed_;
  struct Slip {
    PetscInt x;
    double factor;
  };
  std::vector<Slip> slip_;
  std::optional<Support> solved_;
  double solved_accuracy_ = 0;
  int n_iterations_ = 0;
};

#else

std::string_view petsc_version() {
  return {};
}

class PetscEquations::Impl {
 public:
  explicit Impl(const Subdomain&) { SLIPFRONT_ASSERT(false, "built without PETSc"); }
  void begin(TopConstraint, std::span<const double>, std::span<const double>) {}
  std::optional<AtInterface> solve(const Support&, double) { return std::nullopt; }
  std::vector<double> own_u0() const { return {}; }
  std::vector<double> own_u1() const { return {}; }
  int n_iterations() const { return 0; }
};

#endif

PetscEquations::PetscEquations(const Subdomain& subdomain) : impl_(std::make_unique<Impl>(subdomain)) {}
PetscEquations::~PetscEquations() = default;
void PetscEquations::begin(TopConstraint constraint, std::span<const double> u0, std::span<const double> u1) {
  impl_->begin(constraint, u0, u1);
}
std::optional<PetscEquations::AtInterface> PetscEquations::solve(const Support& support, double accuracy) {
  return impl_->solve(support, accuracy);
}
std::vector<double> PetscEquations::own_u0() const {
  return impl_->own_u0();
}
std::vector<double> PetscEquations::own_u1() const {
  return impl_->own_u1();
}
int PetscEquations::n_iterations() const {
  return impl_->n_iterations();
}

}  // namespace slipfront::statics
