// Fuzz target of the journals of interrupted runs: for any bytes, the result is an error, or a journal that holds only
// whole records.
#include "io/bytes/journal.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "cache_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static std::string path;  // the path of a file that is removed when the process ends
  if (path.empty()) {
    path = "/tmp/chronormal_fuzz_XXXXXX";
    const int file = ::mkstemp(path.data());
    chronormal::fuzz::require(file >= 0, "there is room for a journal");
    ::close(file);
    (void)std::atexit([] { (void)::unlink(path.c_str()); });
  }
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  std::size_t records = 0;
  {
    const auto opened = chronormal::Journal::open(path, "a run");
    if (!opened) {
      chronormal::fuzz::require(!opened.error().message.empty(), "an error has a message");
      return 0;
    }
    records = opened.value().records().size();
    chronormal::fuzz::require(records <= size, "a record takes a byte or more");
  }
  const auto again = chronormal::Journal::open(path, "a run");
  chronormal::fuzz::require(again && again.value().records().size() == records, "what was damaged is gone");
  return 0;
}
