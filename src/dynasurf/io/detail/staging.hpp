#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/io/detail/manifest.hpp"
#include "dynasurf/io/detail/output_state.hpp"

/// Where results are written before they are published: files and folders named `.NAME.partial-` and 16 hex digits
/// beside their destination. Whoever writes one holds a lock (flock) on it, on the manifest of a folder, which the
/// system drops when the process ends, however it ends and whichever process numbers or hosts see the place. What is
/// not locked is left over from a run that ended, and is swept. A run that exchanges a former result for a new one
/// locks both folders until it has decided which of them stays.
namespace dynasurf::io::staging {

namespace fs = std::filesystem;

/// Throws IoError "PATH: cannot DOING: reason".
[[noreturn]] void fail(const fs::path& path, const char* doing, int code);

/// An open file; closed with the object.
struct Descriptor {
  int fd = -1;
  Descriptor() = default;
  explicit Descriptor(int opened) : fd(opened) {}
  Descriptor(Descriptor&& other) noexcept : fd(other.fd) { other.fd = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();
};

/// Opens and locks a new file. Without a descriptor when the name is taken, or a sweeper took the file away before it
/// was locked. Throws IoError.
Descriptor make_locked_file(const fs::path& path);

/// Opens and locks a folder, so that no other run sweeps it or exchanges it for a result. Without a descriptor, and
/// errno set, when it cannot be opened; EWOULDBLOCK says that another run holds it. Not locked where a file system
/// knows no locks of folders (NFS), which then knows no exchange either.
Descriptor lock_folder(const fs::path& path) noexcept;

/// A place to write to that nobody else uses. Folders hold their manifest from the start: it carries the lock.
struct Place {
  fs::path path;
  Descriptor lock;  ///< of the file, or of the manifest in the folder
  bool is_folder = false;
  std::mutex guard;
  std::map<std::string, ManifestEntry> written;  ///< by name: what a folder is to hold when it is published
};

/// Makes a new file or folder beside `destination` and locks it. Throws IoError.
std::shared_ptr<Place> make_place(const fs::path& destination, bool folder);

/// The innermost place of this process that `path` is, or lies in; null when there is none.
std::shared_ptr<Place> place_of(const fs::path& path);

/// Notes that a file below a folder was written with these bytes.
void record(Place& folder, const fs::path& file, std::string_view content);
/// The same of a file that another library wrote: reads it.
void record(Place& folder, const fs::path& file);

/// Removes a place, its manifest last: a removal that is cut short leaves what can still be recognised. Silent.
void remove_place(const fs::path& path) noexcept;

/// Forgets a place and removes what still stands there, unless `published`.
void release(const std::shared_ptr<Place>& place, bool published) noexcept;

/// Removes what dead processes left beside `destination`: unfinished places and results that were replaced. Whatever
/// else stands under such a name is given a visible one, `<name>.old-N`.
void sweep(const fs::path& destination) noexcept;

/// Moves `from` to the first free `<destination>.old-N` and returns that. Throws IoError.
fs::path move_aside(const fs::path& from, const fs::path& destination);

/// Held while a result takes its place. Throws Cancelled after discard_all().
std::unique_lock<std::mutex> begin_to_publish();
/// Removes all places of this process and lets nothing be published any more. Waits for a publication in progress.
void discard_all() noexcept;
OutputState state() noexcept;
void note_published() noexcept;

}  // namespace dynasurf::io::staging
