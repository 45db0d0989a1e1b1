#include "tests/support/child_process.h"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>

#include "tests/support/cpu_time.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define CHRONORMAL_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CHRONORMAL_SANITIZED
#endif

// Writes the coverage counters. The compiler provides __llvm_profile_write_file() only if it adds coverage counters
// (CHRONORMAL_COVERAGE).
extern "C" __attribute__((weak)) int __llvm_profile_write_file(void);

namespace chronormal::test {
namespace {

// Resets the peak of resident memory to the memory that is resident now, so that the peak of the parent process does
// not count.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

std::size_t peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::size_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
  }
  return 0;
}

void limit_address_space(std::size_t growth) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + growth;
  const rlimit limit{most, most};
  setrlimit(RLIMIT_AS, &limit);
}

// Allocates the large pieces of the heap that the parent has freed, so that all later large allocations come from the
// system. Otherwise the child would use these pieces and, after freeing them, keep their memory.
void take_free_pieces() {
  constexpr std::size_t kLarge = std::size_t{1} << 16;
  mallopt(M_MMAP_THRESHOLD, kLarge);
  for (std::size_t size = std::size_t{1} << 30; size >= kLarge; size /= 2) {
    for (;;) {
      const std::size_t from_system = mallinfo2().hblks;
      void* const piece = std::malloc(size);
      if (mallinfo2().hblks == from_system && piece != nullptr) continue;  // keeps the piece allocated
      std::free(piece);
      break;
    }
  }
}

void write_all(int file, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = write(file, text.data() + at, text.size() - at);
    if (written <= 0) return;
    at += static_cast<std::size_t>(written);
  }
}

// Runs work() in the child process. Writes to the pipe the growth of memory in bytes, a line feed, and the text that
// work() returned.
[[noreturn]] void work_and_exit(int out, unsigned most_seconds, const std::function<std::string()>& work,
                                const std::function<void()>& prepare) {
  // The limit of elapsed time is kWaits times the limit of processor time, since a process also waits for files and for
  // other processes.
  constexpr unsigned kWaits = 20;
  const rlimit limit{most_seconds, most_seconds};
  setrlimit(RLIMIT_CPU, &limit);
  alarm(kWaits * most_seconds);
  if (!is_sanitized()) take_free_pieces();
  if (prepare) prepare();
  malloc_trim(0);
  if (!is_sanitized()) limit_address_space(std::size_t{1} << 30);
  forget_peak();
  const std::size_t start = peak_bytes();
  std::string text;
  int code = 0;
  try {
    text = work();
  } catch (const std::exception& exception) {
    text = std::string("it threw: ").append(exception.what());
    code = 1;
  }
  write_all(out, std::to_string(peak_bytes() - start) + "\n" + text);
  // _exit() alone would lose the coverage counters.
  if (__llvm_profile_write_file != nullptr) (void)__llvm_profile_write_file();
  _exit(code);
}

}  // namespace

bool is_sanitized() {
#ifdef CHRONORMAL_SANITIZED
  return true;
#else
  return false;
#endif
}

ChildRun run_in_child(unsigned most_seconds, const std::function<std::string()>& work,
                      const std::function<void()>& prepare) {
  ChildRun run;
  int ends[2];
  if (pipe(ends) != 0) return run;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    work_and_exit(ends[1], most_seconds, work, prepare);
  }
  close(ends[1]);
  std::string text;
  char block[4096];
  for (ssize_t size = 0; (size = read(ends[0], block, sizeof block)) > 0;)
    text.append(block, static_cast<std::size_t>(size));
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  run.seconds = cpu_seconds(usage);
  const std::size_t mark = text.find('\n');
  if (mark == std::string::npos) {
    run.text = WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "it ended without a word";
    return run;
  }
  run.finished = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  run.peak_growth = std::stoull(text.substr(0, mark));
  run.text = text.substr(mark + 1);
  return run;
}

}  // namespace chronormal::test
