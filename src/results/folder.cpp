// SPDX-License-Identifier: BSD-3-Clause
#include "results/folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/caller.hpp"
#include "base/error.hpp"
#include "files/text.hpp"
#include "results/outputs.hpp"

namespace slipfront::results {
namespace {

namespace fs = std::filesystem;

constexpr const char* lock_name = ".slipfront.lock";
constexpr const char* state_name = "state";
/// Names the kind of work, and tells a folder of this program from a foreign one of the same name.
constexpr const char* kind_name = "kind";

/// Names that a run's results have.
std::vector<const char*> names_of_run() {
  std::vector<const char*> names = {"case.resolved.toml", "run.json",      "fronts.csv",    "fracture.csv",
                                    "static.csv",         "energy.csv",    "sequence.json", "events.csv",
                                    "loading.csv",        "sequence.state"};
  for (const auto* output : outputs) names.push_back(output->file);
  return names;
}
/// Folders of a sequence: one for each event, see event_folder, and one for the slow slip before it, which
/// has but a history.
constexpr const char* events_name = "events";
constexpr const char* slow_name = "slow";

std::string overwrite_option() {
  return for_caller("--overwrite", "overwrite=True");
}

[[noreturn]] void throw_unusable(const fs::path& dir, const char* what, int error) {
  if (files::is_full(error))
    throw WriteError("output folder {}: cannot be {} ({}); free space there", dir.string(), what,
                     std::strerror(error));
  throw UserError("output folder {}: cannot be {} ({}); choose another place", dir.string(), what,
                  std::strerror(error));
}

std::string read_line(const fs::path& file) {
  if (!files::is_file(file)) return {};
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return files::one_line(line);
}

/// The page that `slipfront report` makes of results; with others it would be out of date.
void remove_report(const fs::path& dir) {
  const auto file = dir / "report.html";
  if (read_line(file).starts_with("<!DOCTYPE html><!-- slipfront report -->")) files::remove_file(file);
}

std::string host_and_process() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '?';
  return fmt::format("process {} on {}", getpid(), host.data());
}

/// Whether a lock's file is one: it holds the line above, the beginning of one, or nothing yet.
bool is_lock(const fs::path& file) {
  constexpr std::string_view begin = "process ";
  std::error_code error;
  const auto status = fs::symlink_status(file, error);
  if (!fs::exists(status)) return true;
  if (!fs::is_regular_file(status)) return false;
  // Read once: its owner may write or remove it meanwhile. Opening it says what cannot be read.
  std::array<char, begin.size()> first{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(first.data(), first.size());
  return begin.starts_with(std::string_view(first.data(), static_cast<std::size_t>(stream.gcount())));
}

/// Names in a folder, sorted.
std::vector<std::string> names_in(const fs::path& dir) {
  std::error_code error;
  std::set<std::string> names;
  for (fs::directory_iterator k(dir, error), end; !error && k != end; k.increment(error))
    names.insert(k->path().filename().string());
  if (error) throw_unusable(dir, "read", error.value());
  return {names.begin(), names.end()};
}

/// Left by a file that was cut off while it was written, see write_text.
bool is_cut_off(const std::string& name) {
  return name.ends_with(".new");
}

/// Calls file(name) for the files below a folder, by their names relative to it, and after that folder(name)
/// for each folder that was left. The state is passed over.
void walk(const fs::path& dir, const std::string& prefix, const std::function<void(const std::string&)>& file,
          const std::function<void(const std::string&)>& folder) {
  for (const auto& name : names_in(dir / prefix)) {
    const std::string relative = prefix + name;
    if (prefix.empty() && name == state_name) continue;
    if (!files::is_folder(dir / relative)) {
      file(relative);
      continue;
    }
    walk(dir, relative + "/", file, folder);
    folder(relative);
  }
}

/// Whether a folder holds a run or a sequence.
bool holds_run(const fs::path& dir) {
  return (files::is_file(dir / "run.json") || files::is_file(dir / "sequence.json")) &&
         files::is_file(dir / "case.resolved.toml");
}

/// What a sequence's folder has where folders of events go, or of the slow slip before them, by the names in
/// it.
std::vector<std::string> numbers_in(const fs::path& dir) {
  if (!files::is_folder(dir)) return {};
  auto names = names_in(dir);
  std::erase_if(names, [](const std::string& name) {
    return name.size() < 4 || name.find_first_not_of("0123456789") != std::string::npos;
  });
  return names;
}

/// Names in a folder's list of checksums; none where it is missing or damaged.
std::vector<std::string> listed_in(const fs::path& dir) {
  std::vector<std::string> names;
  try {
    for (const auto& [name, sum] : files::read_checksums(dir)) names.push_back(name);
  } catch (const UserError&) {
  }
  return names;
}

/// Names in the folder's list of checksums, in the lists that it names, and these lists. What is not in a
/// folder below it, but behind a link, is none of the set. Of a damaged list nothing is believed: in a folder
/// that holds a run they are those that a run has, and the sets of its events.
std::set<std::string> set_of(const fs::path& dir, const std::string& prefix = "") {
  std::set<std::string> names;
  const auto add_set_in = [&](const fs::path& folder) { names.merge(set_of(dir, folder.string() + "/")); };
  const auto listed = listed_in(dir / prefix);
  for (const auto& name : listed) {
    const fs::path path = prefix / fs::path(name);
    const bool is_inner = fs::path(name).has_parent_path();
    if (is_inner && !files::is_folder(dir / path.parent_path())) continue;
    names.insert(path.string());
    if (is_inner && path.filename() == files::checksum_list) add_set_in(path.parent_path());
  }
  if (listed.empty() && holds_run(dir / prefix)) {
    for (const char* name : names_of_run()) names.insert(prefix + name);
    for (const auto& name : numbers_in(dir / prefix / events_name))
      add_set_in(fs::path(prefix) / events_name / name);
    for (const auto& name : numbers_in(dir / prefix / slow_name))
      names.insert((fs::path(prefix) / slow_name / name / history_output.file).string());
  }
  if (!names.empty()) names.insert(prefix + files::checksum_list);
  return names;
}

/// Refuses to replace a file that is not of an earlier set.
void require_of_set(const std::set<std::string>& earlier, const fs::path& dir, const std::string& name,
                    const std::string& results_are) {
  if (files::is_folder(dir / name))
    throw UserError("{}: is a folder where a result file is to go; move it away{}", (dir / name).string(),
                    results_are);
  if (files::is_there(dir / name) && !earlier.contains(name))
    throw UserError("{}: is not of earlier results, and would be replaced; move it away{}",
                    (dir / name).string(), results_are);
}

/// Refuses anything else where a folder is to go.
void require_folder_or_nothing(const fs::path& path, const std::string& results_are) {
  if (files::is_there(path) && !files::is_folder(path))
    throw UserError("{}: is no folder, where one is to go; move it away{}", path.string(), results_are);
}

/// Removes what writing that was cut off has left.
void remove_cut_off(const fs::path& dir) {
  walk(
      dir, "",
      [&](const std::string& name) {
        if (is_cut_off(name)) files::remove_file(dir / name);
      },
      [](const std::string&) {});
}

void remove_empty_folders(const fs::path& dir, const std::set<std::string>& files) {
  for (const auto& name : files)
    for (auto parent = fs::path(name).parent_path(); !parent.empty(); parent = parent.parent_path())
      files::try_to_remove(dir / parent, true);
}

/// Removes what a folder holds but for one name.
void remove_others(const fs::path& dir, const char* name) {
  if (!files::is_folder(dir)) return;
  for (const auto& other : names_in(dir))
    if (other != name) remove_tree(dir / other);
}

/// The files of a set that is being moved to its folder, wherever they are now.
std::set<std::string> fresh_set(const fs::path& publishing, const fs::path& dir) {
  auto names = set_of(publishing);
  walk(
      publishing, "", [&](const std::string& name) { names.insert(name); }, [](const std::string&) {});
  // A list that has been moved is read where it is now.
  for (const auto& name : listed_in(publishing)) {
    names.insert(name);
    const fs::path path(name);
    if (path.filename() == files::checksum_list && path.has_parent_path() &&
        !files::is_there(publishing / path))
      names.merge(set_of(dir, path.parent_path().string() + "/"));
  }
  return names;
}

/// Removes a folder's state; the kind last, so that what is left of it is known for what it is.
void remove_state(const fs::path& dir) {
  remove_others(dir / state_name, kind_name);
  remove_tree(dir / state_name);
}

void remove_work(const fs::path& unfinished) {
  remove_others(unfinished, state_name);
  remove_state(unfinished);
  files::remove_file(unfinished);
}

/// Whether a folder holds any file that was written to its end, but for one name.
bool holds_others(const fs::path& dir, const char* name) {
  return std::ranges::any_of(names_in(dir),
                             [&](const auto& other) { return other != name && !is_cut_off(other); });
}

/// Whether there is a folder's state, or the beginning or the rest of one.
bool has_own_state(const fs::path& dir) {
  const auto state = dir / state_name;
  return files::is_folder(state) && (files::is_there(state / kind_name) || !holds_others(state, ""));
}

bool is_own_work(const fs::path& unfinished) {
  return files::is_folder(unfinished) && (has_own_state(unfinished) || names_in(unfinished).empty());
}

/// Whether there is more of it than its beginning.
bool is_under_way(const fs::path& unfinished) {
  return is_own_work(unfinished) && has_own_state(unfinished) &&
         (holds_others(unfinished, state_name) || holds_others(unfinished / state_name, kind_name));
}

/// Whether it is on its way, or what is left when it has arrived: the list at most.
bool is_own_publication(const fs::path& publishing) {
  return files::is_folder(publishing) &&
         (has_own_state(publishing) || !holds_others(publishing, files::checksum_list));
}

[[noreturn]] void throw_foreign(const fs::path& path, const char* kind) {
  throw UserError("{}: is not a {} of slipfront, which needs the name; move it away", path.string(), kind);
}

/// Refuses what this program makes nowhere: links, pipes and other kinds, at any depth.
void require_files_and_folders(const fs::path& path) {
  std::error_code error;
  if (files::is_folder(path)) {
    for (const auto& name : names_in(path)) require_files_and_folders(path / name);
    return;
  }
  if (!fs::is_regular_file(fs::symlink_status(path, error))) throw_foreign(path, "file");
  if (const auto names = fs::hard_link_count(path, error); !error && names > 1)
    throw UserError(
        "{}: has another name, a hard link, whose contents would change with it; put a copy in its place",
        path.string());
}

/// Refuses what has the name of this program's own work, or is in it, but is not.
void require_own(const fs::path& path, bool (*is_own)(const fs::path&)) {
  if (!files::is_there(path)) return;
  if (!files::is_folder(path)) throw_foreign(path, "folder");
  require_files_and_folders(path);
  if (!is_own(path)) throw_foreign(path, "folder");
}

}  // namespace

ResultFolder::ResultFolder(const fs::path& dir, std::string work, const ResultFolder* within)
    : dir_(within == nullptr ? files::resolved(dir) : dir), work_(std::move(work)) {
  try {
    // Before anything is made in it: a part is a folder of the work, nowhere else.
    if (within != nullptr && files::is_there(dir_) && !files::is_folder(dir_)) throw_foreign(dir_, "folder");
    make(within);
    lock();
    require_own(unfinished(), is_own_work);
    require_own(publishing(), is_own_publication);
    finish_publication();
  } catch (...) {
    give_back();
    throw;
  }
}

ResultFolder::~ResultFolder() {
  give_back();
}

void ResultFolder::give_back() {
  if (lock_.valid()) files::try_to_remove(dir_ / lock_name);  // before the lock goes: nobody else can hold it
  lock_.close();
  for (auto p = dir_; !outermost_made_.empty(); p = p.parent_path())
    if (!files::try_to_remove(p, true) || p == outermost_made_) return;
}

void ResultFolder::make(const ResultFolder* within) {
  std::error_code error;
  if (dir_.relative_path().empty())
    throw UserError("output folder \"{}\": is {}; name a folder for these results", dir_.string(),
                    dir_.empty() ? "no name" : "the root of all folders");
  // Its own end would take what another process keeps in it; and a sequence is of its own events alone.
  fs::path child;
  for (fs::path p = fs::absolute(dir_, error); p.has_relative_path(); p = p.parent_path()) {
    if (within != nullptr && p == fs::absolute(within->unfinished(), error)) break;
    const auto name = p.filename();
    if ((name == unfinished().filename() || name == publishing().filename()) && has_own_state(p))
      throw UserError(
          "output folder {}: is inside {}, where another run keeps its work; choose another place",
          dir_.string(), p.string());
    if ((child == events_name || child == slow_name) && files::is_file(p / "sequence.json"))
      throw UserError("output folder {}: is part of the sequence in {}; choose another place", dir_.string(),
                      p.string());
    child = name;
  }
  const auto status = fs::status(dir_, error);
  if (!fs::exists(status) && error && error != std::errc::no_such_file_or_directory)
    throw_unusable(dir_, "used", error.value());
  if (fs::exists(status) && !fs::is_directory(status))
    throw UserError("output folder {}: is a file; choose another name", dir_.string());
  fs::path outermost;  // a link to nowhere is not ours
  for (fs::path p = dir_; !p.empty() && !files::is_there(p); p = p.parent_path()) outermost = p;
  error.clear();
  fs::create_directories(dir_, error);
  if (error) throw_unusable(dir_, "created", error.value());
  outermost_made_ = outermost;
  if (::access(dir_.c_str(), R_OK | W_OK | X_OK) != 0) throw_unusable(dir_, "written", errno);
  auto names = names_of_run();
  names.push_back(files::checksum_list);
  for (const char* name : names)
    if (files::is_folder(dir_ / name))
      throw UserError("{}: is a folder where a result file is to go; move it away", (dir_ / name).string());
}

void ResultFolder::lock() {
  const auto file = dir_ / lock_name;
  for (;;) {
    if (!is_lock(file)) throw_foreign(file, "file");
    lock_ = files::Descriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (!lock_.valid()) throw_unusable(dir_, "locked", errno);
    // Held by the open file, so that it ends with the process, however that ends.
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    if (::fcntl(lock_.get(), F_OFD_SETLK, &whole) != 0) {
      const int error = errno;
      const std::string holder = read_line(file);
      lock_.close();
      if (error != EAGAIN && error != EACCES) throw_unusable(dir_, "locked", error);
      throw UserError("output folder {}: is in use by {}; wait for it or choose another folder",
                      dir_.string(), holder.empty() ? "another process" : holder);
    }
    struct stat held {
    }, named{};
    if (::fstat(lock_.get(), &held) == 0 && ::stat(file.c_str(), &named) == 0 && held.st_ino == named.st_ino)
      break;  // else its holder removed it while we opened it
  }
  const std::string text = host_and_process() + "\n";
  if (::ftruncate(lock_.get(), 0) != 0) throw_unusable(dir_, "written", errno);
  const auto n_written = ::pwrite(lock_.get(), text.data(), text.size(), 0);
  if (n_written != static_cast<ssize_t>(text.size()))
    throw_unusable(dir_, "written", n_written < 0 ? errno : ENOSPC);
}

bool ResultFolder::has_results() const {
  for (const auto& name : names_in(dir_))
    if (name != lock_name && name != unfinished().filename()) return true;
  return false;
}

bool ResultFolder::has_unfinished() const {
  return is_under_way(unfinished()) && read_line(state() / kind_name) == work_;
}

void ResultFolder::require_empty(bool overwrite, bool resumes) const {
  if (overwrite) return require_room(0);
  const bool goes_on = resumes && has_unfinished();
  if (is_under_way(unfinished()) && !goes_on) {
    const std::string work = read_line(state() / kind_name), command = work.substr(0, work.find(" with "));
    throw UserError("output folder {}: holds unfinished work; go on with it ({}) or pass {} to begin anew",
                    dir_.string(),
                    command == "run" ? for_caller("slipfront run --restart", "slipfront.resume")
                                     : fmt::format("slipfront {}, of the same program", command),
                    overwrite_option());
  }
  if (has_results() && goes_on)
    throw UserError(
        "output folder {}: holds results, and unfinished work that is to replace them; choose another or "
        "pass {} to go on with it",
        dir_.string(), overwrite_option());
  if (has_results())
    throw UserError("output folder {}: is not empty; choose another or pass {} to replace a run's results",
                    dir_.string(), overwrite_option());
}

void ResultFolder::require_room(std::int64_t n_events) const {
  const auto earlier = set_of(dir_);
  for (const char* name : names_of_run()) require_of_set(earlier, dir_, name, "");
  if (n_events == 0) return;
  for (const auto& [folder, most] : {std::pair{events_name, n_events}, {slow_name, n_events + 1}}) {
    require_folder_or_nothing(dir_ / folder, "");
    for (const auto& name : numbers_in(dir_ / folder)) {
      if (name.size() > 9 || std::stoll(name) > most) continue;
      const auto of_event = fs::path(folder) / name;
      require_folder_or_nothing(dir_ / of_event, "");
      for (const char* file : names_of_run()) require_of_set(earlier, dir_, of_event / file, "");
      require_of_set(earlier, dir_, of_event / files::checksum_list, "");
    }
  }
}

void ResultFolder::begin() {
  if (files::is_there(unfinished())) remove_work(unfinished());
  files::make_folder(unfinished());
  files::make_folder(state());
  files::write_text(state() / kind_name, work_ + "\n");
}

void ResultFolder::begin_or_resume() {
  if (!has_unfinished()) begin();
}

void ResultFolder::abandon() {
  if (files::is_there(unfinished())) remove_work(unfinished());
}

void ResultFolder::publish(bool adds) {
  remove_report(unfinished());  // of a part of them
  const auto earlier = set_of(dir_);
  const auto results_are = fmt::format("; the results are in {}", unfinished().string());
  walk(
      unfinished(), "", [](const std::string&) {},
      [&](const std::string& name) { require_folder_or_nothing(dir_ / name, results_are); });
  walk(
      unfinished(), "", [&](const std::string& name) { require_of_set(earlier, dir_, name, results_are); },
      [](const std::string&) {});
  seal(unfinished(), adds ? files::read_checksums(dir_) : files::Checksums{});
  walk(
      unfinished(), "", [&](const std::string& name) { files::sync_file(unfinished() / name); },
      [&](const std::string& name) { files::sync_file(unfinished() / name); });
  files::sync_file(unfinished());
  files::move_file(unfinished(), publishing());
  files::sync_file(dir_);
  finish_publication();
}

void ResultFolder::finish_publication() {
  if (!files::is_there(publishing())) return;
  if (files::is_there(publishing() / files::checksum_list)) {
    const auto fresh = fresh_set(publishing(), dir_);
    auto stale = set_of(dir_);
    for (const auto& name : fresh) stale.erase(name);
    // Lists last: as long as they are there, what they name can be found.
    const auto is_list = [](const std::string& name) {
      return fs::path(name).filename() == files::checksum_list;
    };
    for (const auto& name : stale)
      if (!is_list(name)) files::remove_file(dir_ / name);
    for (const auto& name : stale)
      if (is_list(name)) files::remove_file(dir_ / name);
    remove_empty_folders(dir_, stale);
    remove_report(dir_);
    walk(
        publishing(), "",
        [&](const std::string& name) {
          if (name == files::checksum_list) return;
          files::make_folders((dir_ / name).parent_path());
          files::move_file(publishing() / name, dir_ / name);
        },
        [&](const std::string& name) { files::remove_file(publishing() / name); });
    if (files::is_there(publishing() / state_name)) remove_state(publishing());
    files::move_file(publishing() / files::checksum_list, dir_ / files::checksum_list);
  }
  files::remove_file(publishing());
  files::sync_file(dir_);
}

void remove_tree(const fs::path& path) {
  if (files::is_folder(path))
    for (const auto& name : names_in(path)) remove_tree(path / name);
  files::remove_file(path);
}

/// Refuses to publish a part that is not as its own list says.
static void require_as_finished(const fs::path& part) {
  try {
    files::require_intact(part);
  } catch (const UserError& error) {
    throw WriteError("{}", error.what());
  }
}

void seal(const fs::path& dir, const files::Checksums& others) {
  remove_cut_off(dir);
  files::Checksums checksums = others;
  std::set<std::string> sealed;  // folders with a separate list
  const auto is_below_sealed = [&](fs::path name) {
    while (!(name = name.parent_path()).empty())
      if (sealed.contains(name.string())) return true;
    return false;
  };
  walk(
      dir, "",
      [&](const std::string& name) {
        const fs::path path(name);
        if (path.filename() != files::checksum_list || !path.has_parent_path()) return;
        require_as_finished(dir / path.parent_path());
        sealed.insert(path.parent_path().string());
      },
      [](const std::string&) {});
  walk(
      dir, "",
      [&](const std::string& name) {
        const bool is_list = fs::path(name).filename() == files::checksum_list;
        if (name == files::checksum_list || (is_below_sealed(name) && !is_list)) return;
        checksums[name] = files::sha256_of_file(dir / name);
      },
      [](const std::string&) {});
  files::write_checksums(dir, checksums);
}

fs::path event_folder(const fs::path& dir, std::size_t number) {
  return dir / events_name / fmt::format("{:04}", number);
}

fs::path slow_folder(const fs::path& dir, std::size_t number) {
  return dir / slow_name / fmt::format("{:04}", number);
}

fs::path published(const fs::path& dir, const std::string& name) {
  const auto on_its_way = dir / "publishing" / name;
  return files::is_there(on_its_way) ? on_its_way : dir / name;
}

}  // namespace slipfront::results
