// The list has a place for every temporary file that exists at the same time. A name in it belongs to whoever takes it
// out: the file's owner, when it is done, or remove_temporaries(), which never gives it back.
#include "io/bytes/temporary_file.h"

#include <sys/random.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "chronormal/io/output.h"

namespace chronormal {
namespace {

constexpr std::size_t kMostFiles = std::size_t{1} << 16U;  // the frames of a sequence come into being together

std::array<std::atomic<char*>, kMostFiles> names{};
std::array<std::atomic<char*>, kMostFiles>
    removed{};  // by remove_temporaries(): who owned these may still look at them
static_assert(std::atomic<char*>::is_always_lock_free, "a signal handler may not wait");

// Makes 16 hexadecimal digits.
std::string random_digits() {
  std::uint64_t number = 0;
  if (::getentropy(&number, sizeof number) != 0)
    number = static_cast<std::uint64_t>(::getpid()) << 32U ^ reinterpret_cast<std::uintptr_t>(&number);
  std::string digits;
  for (; digits.size() < 16; number >>= 4U) digits += "0123456789abcdef"[number & 0xFU];
  return digits;
}

// Makes a name in the folder of target. It does not depend on the name of target, so that it is never too long.
std::string name_beside(const std::string& target) {
  const std::filesystem::path folder = std::filesystem::path(target).parent_path();
  return (folder / (".chronormal-" + random_digits() + ".tmp")).string();
}

// Takes the first free place of the list. Returns kMostFiles if there is none; the file is written all the same.
std::size_t enter(char* name) noexcept {
  for (std::size_t i = 0; i < kMostFiles; ++i) {
    char* nobody = nullptr;
    if (names[i].compare_exchange_strong(nobody, name)) return i;
  }
  return kMostFiles;
}

// Renames without replacing a file that somebody else made meanwhile, if the system and the file system can do that.
bool rename_to_new(const char* from, const char* to) noexcept {
#ifdef RENAME_NOREPLACE
  if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
#endif
  return std::rename(from, to) == 0;
}

}  // namespace

inline namespace internal {

TemporaryFile::TemporaryFile(const std::string& target, mode_t mode) {
  open(name_beside(target), O_WRONLY | O_CREAT | O_EXCL, mode);
}

std::unique_ptr<TemporaryFile> TemporaryFile::of_peer(const std::string& name) {
  std::unique_ptr<TemporaryFile> file(new TemporaryFile());
  file->open(name, O_WRONLY, 0);
  return file;
}

Error TemporaryFile::not_opened(const std::string& place) {
  Error error = failure(place, errno);
  error.message = "the folder of the output cannot be written to: " + error.message;
  return error;
}

// Moves the descriptor out before the object ends here and removes the name.
Descriptor TemporaryFile::nameless(const std::string& target) {
  TemporaryFile file;
  file.open(name_beside(target), O_RDWR | O_CREAT | O_EXCL, 0600);
  return std::move(file.file_);
}

void TemporaryFile::open(const std::string& name, int flags, mode_t mode) {
  name_ = ::strdup(name.c_str());
  if (name_ == nullptr) return;  // errno says so
  place_ = enter(name_);
  file_ = Descriptor(open_descriptor(name, O_NOFOLLOW | flags, mode));
  if (!file_.is_open()) forget();
}

TemporaryFile::TemporaryFile(const Kept& kept, mode_t mode) : place_(kMostFiles), stays_(true) {
  name_ = ::strdup(kept.name.c_str());
  if (name_ == nullptr) return;  // errno says so
  file_ = Descriptor(open_descriptor(kept.name, O_WRONLY | O_CREAT | O_NOFOLLOW, mode));
  if (!file_.is_open()) forget();
}

TemporaryFile::~TemporaryFile() {
  if (name_ == nullptr) return;
  if (!stays_) (void)::unlink(name_);
  forget();
}

bool TemporaryFile::rename_to(const std::string& target, bool replace) noexcept {
  const bool renamed = replace ? std::rename(name_, target.c_str()) == 0 : rename_to_new(name_, target.c_str());
  if (renamed) forget();
  return renamed;
}

// Takes the name out of the list. If a handler has taken it already, the process is about to end, and the handler may
// still read the name: it is not freed.
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
    (void)::unlink(name);
    removed[i] = name;
  }
  errno = system_error;
}

}  // namespace chronormal
