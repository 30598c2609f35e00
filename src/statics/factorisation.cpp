// SPDX-License-Identifier: BSD-3-Clause
#include "statics/factorisation.hpp"

#include <cholmod.h>
#include <malloc.h>
#include <omp.h>
#include <sys/mman.h>

extern "C" void openblas_set_num_threads(int n_threads);
extern "C" int openblas_get_num_threads();

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "base/error.hpp"
#include "solid/element.hpp"
#include "statics/dissection.hpp"

namespace slipfront::statics {

double estimated_factor_bytes(double n_unknowns, double n_interface) {
  // Nested dissection of a plane grid of four-node cells with two unknowns a node, the interface last: its
  // dense square, and as much again in the rows of the separators that reach it. Of plates of 1e4 to 1e6
  // unknowns, graded ones included, the first number is 5.7 to 6.9.
  return sizeof(double) *
         (7 * n_unknowns * std::log2(std::max(n_unknowns, 2.0)) + 2 * dense_entries(n_interface));
}

namespace {

Message smaller_factor() {
  return Message("{} = iterative or {}", Key("loading.solver"), larger_elements());
}
constexpr double index_bytes = sizeof(std::int64_t);

/// The matrix's upper half, 9 blocks a node in all, with its indices; it is there twice, once permuted.
double matrix_bytes(double n_unknowns) {
  return 9.5 * (sizeof(double) + index_bytes) * n_unknowns;
}

/// CHOLMOD's workspace, the rows of the supernodes, and the numbers of the unknowns.
double indices_bytes(double n_unknowns) {
  return 15 * index_bytes * n_unknowns;
}

}  // namespace

Budget factorisation_budget(double n_unknowns, double n_interface, double factor_bytes) {
  // Numbers of the unknowns before and after the dissection, and the mesh.
  const double numbers = (2 * index_bytes + 16) * n_unknowns;
  // 36 triplets a cell, one cell to two unknowns; the same by rows before equal ones are added.
  const double triplets = 18 * (sizeof(double) + 2 * index_bytes) * n_unknowns;
  const double rows = 18 * (sizeof(double) + index_bytes) * n_unknowns;
  const Budget assembly = {{"the assembly of the stiffness",
                            triplets + rows + matrix_bytes(n_unknowns) + numbers, smaller_factor()}};
  const Budget factorising = {
      {"the factor of the stiffness", factor_bytes, smaller_factor()},
      {"the stiffness and its permutation", 2 * matrix_bytes(n_unknowns), smaller_factor()},
      {"the update of the interface's block", sizeof(double) * dense_entries(n_interface), smaller_factor()},
      {"indices of the factorisation", indices_bytes(n_unknowns) + numbers, smaller_factor()}};
  Budget condensing = factor_budget(n_unknowns, n_interface, factor_bytes);
  condensing.push_back(
      {"the factor's block of the interface", sizeof(double) * dense_entries(n_interface), smaller_factor()});
  return largest_of({assembly, factorising, condensing});
}

Budget factor_budget(double n_unknowns, double n_interface, double factor_bytes) {
  return {{"the factor of the stiffness", factor_bytes, smaller_factor()},
          {"indices of the factorisation", indices_bytes(n_unknowns), smaller_factor()},
          {"the condensed stiffness", sizeof(double) * dense_entries(n_interface), smaller_factor()}};
}

namespace {

[[noreturn]] void throw_out_of_memory(const char* what) {
  throw UserError("out of memory in the static solution ({}); choose a larger {}", what,
                  Key("plate.element_size_m"));
}

/// To the system, before as much is taken again; glibc would keep arrays of up to 32 MB.
void return_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

/// OpenBLAS built without threads hands out its buffers without a lock: two threads inside it at once would
/// compute in the same one. Whoever calls CHOLMOD's numeric parts holds this.
std::mutex blas_in_use;

/// OpenBLAS takes a buffer of 128 MB when it is first called, and where it gets none it tries for ever: the
/// memory of the numeric factorisation has to be there with it.
void require_memory_with_blas(const cholmod_factor& factor, const cholmod_sparse& matrix) {
  const std::size_t buffer = std::size_t{132} << 20U;
  const std::size_t factor_bytes = sizeof(double) * (factor.xsize + factor.maxcsize);
  const std::size_t matrix_bytes = (sizeof(double) + sizeof(std::int64_t)) * matrix.nzmax;  // permuted
  const std::size_t indices = 8 * sizeof(std::int64_t) * factor.n;
  const std::size_t bytes = buffer + factor_bytes + matrix_bytes + indices;
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw_out_of_memory("factorisation");
  ::munmap(memory, bytes);
}

struct FreeSparse {
  cholmod_common* common;
  void operator()(cholmod_sparse* matrix) const { cholmod_l_free_sparse(&matrix, common); }
};
using Sparse = std::unique_ptr<cholmod_sparse, FreeSparse>;

/// [nodes] Whether they belong to the loaded edge.
std::vector<bool> is_top(const mesh::Mesh& mesh) {
  std::vector<bool> is(mesh.n_nodes(), false);
  for (const auto n : mesh.top) is[n] = true;
  return is;
}

/// Those whose rows of K feel the loaded edge: its own nodes and their neighbours.
std::vector<mesh::Node> nodes_near_top(const mesh::Mesh& mesh) {
  const auto is_loaded = is_top(mesh);
  std::vector<bool> feels(mesh.n_nodes(), false);
  for (const auto& cell : mesh.cells)
    if (std::ranges::any_of(cell, [&](mesh::Node n) { return is_loaded[n]; }))
      for (const auto n : cell) feels[n] = true;
  std::vector<mesh::Node> near;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (feels[n]) near.push_back(n);
  return near;
}

}  // namespace

struct Factorisation::Cholmod {
  mutable cholmod_common common{};
  cholmod_factor* factor = nullptr;
  Cholmod() {
    // Cases run side by side, and the result must not depend on the number of threads.
    if (openblas_get_num_threads() != 1) openblas_set_num_threads(1);  // setting it starts threads anew
    omp_set_max_active_levels(0);  // CHOLMOD's own loops are too short for a team of threads
    cholmod_l_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = true;
    common.print = 0;
  }
  ~Cholmod() {
    cholmod_l_free_factor(&factor, &common);
    cholmod_l_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  void check(const char* what) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw_out_of_memory(what);
    SLIPFRONT_ASSERT(common.status >= CHOLMOD_OK, what);
  }
};

Factorisation::~Factorisation() = default;

Factorisation::Factorisation(const mesh::Mesh& mesh, const solid::Material& material, TopConstraint top)
    : cholmod_(std::make_unique<Cholmod>()), mesh_(mesh), top_(top) {
  if (top == TopConstraint::vertical) spring_ = material.youngs_modulus_Pa;
  number_unknowns();
  factorise(material);
  condense();
  near_top_ = solid::assemble_rows(mesh, material, nodes_near_top(mesh));
}

void Factorisation::number_unknowns() {
  const auto is_loaded = is_top(mesh_);
  unknown_.assign(2 * static_cast<std::size_t>(mesh_.n_nodes()), -1);
  for (const auto n : dissect(mesh_, mesh_.lower)) {
    if (!is_loaded[n] || top_ == TopConstraint::vertical) unknown_[2 * n] = n_unknowns_++;
    if (!is_loaded[n]) unknown_[2 * n + 1] = n_unknowns_++;
  }
}

cholmod_triplet* Factorisation::triplets(const solid::Material& material) const {
  const std::size_t most = 36 * mesh_.cells.size() + mesh_.lower.size();
  cholmod_triplet* triplets =
      cholmod_l_allocate_triplet(n_unknowns_, n_unknowns_, most, 1, CHOLMOD_REAL, &cholmod_->common);
  cholmod_->check("triplets");
  auto* row = static_cast<std::int64_t*>(triplets->i);
  auto* column = static_cast<std::int64_t*>(triplets->j);
  auto* value = static_cast<double*>(triplets->x);
  const auto add = [&](std::int64_t i, std::int64_t j, double K_ij) {
    row[triplets->nnz] = i;
    column[triplets->nnz] = j;
    value[triplets->nnz] = K_ij;
    ++triplets->nnz;
  };
  solid::CellStiffness K{};
  solid::CellCoordinates shape_of_K{};
  for (const auto& cell : mesh_.cells) {
    auto c = solid::cell_coordinates(mesh_, cell);
    for (int k = 7; k >= 0; --k) c[k] -= c[k % 2];
    if (c != shape_of_K) {
      K = solid::cell_stiffness(c, material);
      shape_of_K = c;
    }
    for (int a = 0; a < 8; ++a) {
      const auto i = unknown_[2 * cell[a / 2] + a % 2];
      for (int b = 0; b < 8; ++b) {
        const auto j = unknown_[2 * cell[b / 2] + b % 2];
        if (i >= 0 && j >= i) add(i, j, K[8 * a + b]);
      }
    }
  }
  for (const auto n : mesh_.lower) add(unknown_[2 * n], unknown_[2 * n], spring_);
  return triplets;
}

void Factorisation::factorise(const solid::Material& material) {
  auto* common = &cholmod_->common;
  cholmod_triplet* entries = triplets(material);
  Sparse matrix(cholmod_l_triplet_to_sparse(entries, entries->nnz, common), {common});
  cholmod_l_free_triplet(&entries, common);
  cholmod_->check("assembly");
  return_freed_memory();

  std::vector<std::int64_t> identity(n_unknowns_);
  std::iota(identity.begin(), identity.end(), std::int64_t{0});
  cholmod_->factor = cholmod_l_analyze_p(matrix.get(), identity.data(), nullptr, 0, common);
  cholmod_->check("analysis");
  factor_bytes_ = 8.0 * static_cast<double>(cholmod_->factor->xsize);
  require_memory(factorisation_budget(static_cast<double>(n_unknowns_),
                                      static_cast<double>(mesh_.lower.size()), factor_bytes_),
                 fmt::format("the factorisation of {} static unknowns", n_unknowns_));
  require_memory_with_blas(*cholmod_->factor, *matrix);
  {
    const std::lock_guard alone(blas_in_use);
    cholmod_l_factorize(matrix.get(), cholmod_->factor, common);
  }
  matrix.reset();
  cholmod_->check("factorisation");
  return_freed_memory();
  SLIPFRONT_ASSERT(cholmod_->factor->minor == cholmod_->factor->n, "stiffness is not positive definite");
}

void Factorisation::condense() {
  // The interface's columns are the last ones of the factor, whatever the postordering of the others.
  const auto* L = cholmod_->factor;
  const auto* super = static_cast<const std::int64_t*>(L->super);
  const auto* pi = static_cast<const std::int64_t*>(L->pi);
  const auto* px = static_cast<const std::int64_t*>(L->px);
  const auto* s = static_cast<const std::int64_t*>(L->s);
  const auto* x = static_cast<const double*>(L->x);
  const auto* permutation = static_cast<const std::int64_t*>(L->Perm);
  const auto n_interface = static_cast<std::int64_t>(2 * mesh_.lower.size());
  const std::int64_t first = n_unknowns_ - n_interface;
  for (std::int64_t k = first; k < n_unknowns_; ++k)
    SLIPFRONT_ASSERT(permutation[k] == k, "the interface is not last in the factor");
  Eigen::MatrixXd L_ii = Eigen::MatrixXd::Zero(n_interface, n_interface);
  for (std::size_t node = 0; node < L->nsuper; ++node) {
    if (super[node + 1] <= first) continue;
    const std::int64_t n_rows = pi[node + 1] - pi[node];
    for (std::int64_t c = super[node]; c < super[node + 1]; ++c) {
      if (c < first) continue;
      for (std::int64_t r = c - super[node]; r < n_rows; ++r)
        L_ii(s[pi[node] + r] - first, c - first) = x[px[node] + (c - super[node]) * n_rows + r];
    }
  }
  condensed_.setZero(n_interface, n_interface);
  condensed_.selfadjointView<Eigen::Lower>().rankUpdate(L_ii);
  condensed_.triangularView<Eigen::StrictlyUpper>() = condensed_.transpose();
  for (std::int64_t k = 0; k < n_interface; k += 2) condensed_(k, k) -= spring_;
}

Eigen::VectorXd Factorisation::at_interface(const solid::Field& u) const {
  Eigen::VectorXd u_i(2 * mesh_.lower.size());
  for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
    u_i(2 * k) = u.x[mesh_.lower[k]];
    u_i(2 * k + 1) = u.y[mesh_.lower[k]];
  }
  return u_i;
}

Factorisation::Load Factorisation::load(const Top& top) const {
  const Eigen::VectorXd u_i = at_interface(solve(top, Eigen::VectorXd::Zero(2 * mesh_.lower.size())));
  Eigen::VectorXd g = condensed_ * u_i;
  for (Eigen::Index k = 0; k < g.size(); k += 2) g(k) += spring_ * u_i(k);
  return {top, g};
}

solid::Field Factorisation::displacement(const Load& load, const Eigen::VectorXd& interface_u_m) const {
  Eigen::VectorXd force = condensed_ * interface_u_m - load.g_N;
  for (Eigen::Index k = 0; k < force.size(); k += 2) force(k) += spring_ * interface_u_m(k);
  return solve(load.top, force);
}

solid::Field Factorisation::displacement(const Eigen::VectorXd& interface_force_N) const {
  SLIPFRONT_ASSERT(top_ == TopConstraint::both, "forces on a plate that nothing holds along x");
  const std::vector<double> held(mesh_.top.size(), 0.0);
  return solve({held, held}, interface_force_N);
}

solid::Field Factorisation::solve(const Top& top, const Eigen::VectorXd& interface_force) const {
  SLIPFRONT_ASSERT(top.u_x_m.size() == mesh_.top.size() && top.u_y_m.size() == mesh_.top.size(),
                   "size of the loaded edge");
  auto* common = &cholmod_->common;
  solid::Field u(mesh_.n_nodes());
  for (std::size_t k = 0; k < mesh_.top.size(); ++k) {
    if (top_ == TopConstraint::both) u.x[mesh_.top[k]] = top.u_x_m[k];
    u.y[mesh_.top[k]] = top.u_y_m[k];
  }
  cholmod_dense* rhs = cholmod_l_zeros(n_unknowns_, 1, CHOLMOD_REAL, common);
  cholmod_->check("right-hand side");
  auto* f = static_cast<double*>(rhs->x);
  solid::for_each_row_product(near_top_, u, [&](std::size_t r, double x, double y) {
    const auto n = near_top_.node[r];
    if (unknown_[2 * n] >= 0) f[unknown_[2 * n]] -= x;
    if (unknown_[2 * n + 1] >= 0) f[unknown_[2 * n + 1]] -= y;
  });
  for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
    f[unknown_[2 * mesh_.lower[k]]] += interface_force(2 * k);
    f[unknown_[2 * mesh_.lower[k] + 1]] += interface_force(2 * k + 1);
  }
  cholmod_dense* solution = nullptr;
  {
    const std::lock_guard alone(blas_in_use);
    solution = cholmod_l_solve(CHOLMOD_A, cholmod_->factor, rhs, common);
  }
  cholmod_l_free_dense(&rhs, common);
  cholmod_->check("solution");
  const auto* z = static_cast<const double*>(solution->x);
  for (mesh::Node n = 0; n < mesh_.n_nodes(); ++n) {
    if (unknown_[2 * n] >= 0) u.x[n] = z[unknown_[2 * n]];
    if (unknown_[2 * n + 1] >= 0) u.y[n] = z[unknown_[2 * n + 1]];
  }
  cholmod_l_free_dense(&solution, common);
  return u;
}

}  // namespace slipfront::statics
