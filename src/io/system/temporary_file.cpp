// Keeps a list of the names of the files that remove_temporaries() removes. A name is taken out of the list either by
// its TemporaryFile, when it is done with the file, or by remove_temporaries(). From then on, only the function that
// took the name may use it. remove_temporaries() never puts a name back.
#include "io/system/temporary_file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "chronormal/io/output.h"
#include "io/system/names.h"

namespace chronormal {
namespace {

// The number of places in the list of temporary files. The number is large, because the files for all frames of a
// sequence exist at the same time.
constexpr std::size_t kMostFiles = std::size_t{1} << 16U;

std::array<std::atomic<char*>, kMostFiles> names{};
std::array<std::atomic<char*>, kMostFiles>
    // Names that remove_temporaries() took. They are never freed, because their TemporaryFile objects may still read
    // them.
    removed{};
static_assert(std::atomic<char*>::is_always_lock_free,
              "a signal handler must not wait for a lock, so this type must be lock-free");

std::string random_digits() {
  std::uint64_t number = random_number();
  std::string digits;
  for (; digits.size() < 16; number >>= 4U) digits += "0123456789abcdef"[number & 0xFU];
  return digits;
}

// Returns a new name in the folder of `target`. The name does not contain the name of the target, so it is never too
// long for the file system.
std::string name_beside(const std::string& target) {
  return utf8_of(path_of(target).parent_path() / (".chronormal-" + random_digits() + ".tmp"));
}

// Puts a name into the first free place of the list of temporary files, and returns this place. Returns kMostFiles if
// the list is full; the file is then written without an entry, and remove_temporaries() does not find it.
std::size_t enter(char* name) noexcept {
  for (std::size_t i = 0; i < kMostFiles; ++i) {
    char* nobody = nullptr;
    if (names[i].compare_exchange_strong(nobody, name)) return i;
  }
  return kMostFiles;
}

// Copies a name onto the heap, because the list of temporary files needs names that outlive their objects. Returns
// nullptr and sets errno if there is no memory.
char* copy_of(const std::string& name) noexcept {
  void* const copy = std::malloc(name.size() + 1);
  return copy == nullptr ? nullptr : static_cast<char*>(std::memcpy(copy, name.c_str(), name.size() + 1));
}

}  // namespace

inline namespace internal {

TemporaryFile::TemporaryFile(const std::string& target, bool is_private) {
  open(name_beside(target), {.writes = true, .makes = Opening::Makes::kNew, .is_private = is_private});
}

std::unique_ptr<TemporaryFile> TemporaryFile::of_peer(const std::string& name) {
  std::unique_ptr<TemporaryFile> file(new TemporaryFile());
  file->open(name, {.writes = true});
  return file;
}

Error TemporaryFile::not_opened(const std::string& place) {
  Error error = failure(place, errno);
  error.message = "the folder of the output cannot be written to: " + error.message;
  return error;
}

// Moves the descriptor out of `file` before the destructor of `file` runs, which then removes the name but does not
// close the descriptor.
Descriptor TemporaryFile::nameless(const std::string& target) {
  TemporaryFile file;
  file.open(name_beside(target), {.reads = true, .writes = true, .makes = Opening::Makes::kNew, .is_private = true});
  return std::move(file.file_);
}

void TemporaryFile::open(const std::string& name, const Opening& how) {
  name_ = copy_of(name);
  if (name_ == nullptr) return;  // copy_of() has set errno to the reason
  place_ = stays_ ? kMostFiles : enter(name_);
  Opening without_links = how;
  without_links.follows_links = false;
  file_ = open_file(name, without_links);
  if (!file_.is_open()) forget();
}

TemporaryFile::TemporaryFile(const Kept& kept, bool is_private) : stays_(true) {
  open(kept.name, {.writes = true, .makes = Opening::Makes::kMissing, .is_private = is_private});
}

TemporaryFile::~TemporaryFile() {
  if (name_ == nullptr) return;
  if (!stays_) remove_file(name_);
  forget();
}

bool TemporaryFile::rename_to(const std::string& target, bool replace) noexcept {
  const bool renamed = rename_file(name_, target.c_str(), replace);
  if (renamed) forget();
  return renamed;
}

// Takes the name of the file out of the list of temporary files, and frees the name. If a signal handler has taken the
// name already, the process is about to end and the handler may still read the name. The name is then not freed.
void TemporaryFile::forget() noexcept {
  const int system_error = errno;
  char* own = name_;
  if (place_ == kMostFiles || names[place_].compare_exchange_strong(own, nullptr)) std::free(name_);
  name_ = nullptr;
  errno = system_error;
}

}  // namespace internal

void remove_temporaries() noexcept {
  const int system_error = errno;
  for (std::size_t i = 0; i < kMostFiles; ++i) {
    char* const name = names[i].exchange(nullptr);
    if (name == nullptr) continue;
    remove_file(name);
    removed[i] = name;
  }
  errno = system_error;
}

}  // namespace chronormal
