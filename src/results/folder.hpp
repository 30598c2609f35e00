// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "files/checksum.hpp"
#include "files/files.hpp"

namespace slipfront::results {

/// A folder for a set of results, held by this process alone as long as the object lives.
///
/// The work goes on in DIR/unfinished, so that earlier results stay until the new ones are complete. Its
/// folder `state` holds what going on needs and is no result. `publish` renames DIR/unfinished to
/// DIR/publishing, which makes the set complete at one instant, and then moves its files to DIR; if that is
/// cut off, the next one who claims the folder ends it, and readers take from DIR/publishing what is there.
/// The set's list of checksums is the last file to come.
class ResultFolder {
 public:
  /// Makes the folder where it is missing, locks it, and ends a publication that was cut off.
  /// @param work  what is to be done in it, "run" or the like: unfinished work of another kind is not resumed
  /// @param within  of whose unfinished work it is a part, or null
  /// @throws UserError where it cannot be used, or another process holds it.
  ResultFolder(const std::filesystem::path& dir, std::string work, const ResultFolder* within = nullptr);
  /// Gives the folder back; those that were made for it go again if nothing has come into them.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  const std::filesystem::path& dir() const { return dir_; }
  std::filesystem::path unfinished() const { return dir_ / "unfinished"; }
  std::filesystem::path state() const { return unfinished() / "state"; }

  /// Whether the folder holds anything but unfinished work.
  bool has_results() const;
  /// Whether work of this kind was left unfinished in it.
  bool has_unfinished() const;

  /// Refuses a folder that holds anything, unless it is to be overwritten.
  /// @param resumes  unfinished work of this kind is welcome
  void require_empty(bool overwrite, bool resumes = false) const;
  /// Refuses what is in the way of results, with up to so many folders of events: foreign files, links.
  void require_room(std::int64_t n_events) const;

  /// Begins the work anew; what was left unfinished is removed.
  void begin();
  /// Goes on with unfinished work of this kind, or begins it.
  void begin_or_resume();
  /// Gives up work that has come to nothing.
  void abandon();

  /// Publishes all files below `unfinished` but for `state`; files of an earlier set that the new one lacks
  /// are removed, and no others.
  /// @param adds  they are not removed, but belong to the new set
  /// @throws UserError where one of its folders has the name of something else, WriteError; before the set is
  /// complete all is left as it was, after it the set is kept.
  void publish(bool adds = false);

 private:
  std::filesystem::path publishing() const { return dir_ / "publishing"; }
  void make(const ResultFolder* within);
  void lock();
  void give_back();
  void finish_publication();

  std::filesystem::path dir_, outermost_made_;
  std::string work_;
  files::Descriptor lock_;
};

/// Removes a file or a folder with all that is in it, as far as it is there; links are not followed.
void remove_tree(const std::filesystem::path& path);

/// Writes the list of checksums of a folder's files; of a folder in it that has a separate list only that
/// list. Lists end the writing of a set: what has one is complete.
/// @param others  of files elsewhere that belong to the set
void seal(const std::filesystem::path& dir, const files::Checksums& others = {});

/// The folder of an event in that of its sequence, by its number from 1, and that of the slow slip before it.
std::filesystem::path event_folder(const std::filesystem::path& dir, std::size_t number);
std::filesystem::path slow_folder(const std::filesystem::path& dir, std::size_t number);

/// The file of a set in a folder, which may be on its way to it.
std::filesystem::path published(const std::filesystem::path& dir, const std::string& name);

}  // namespace slipfront::results
