// Describes the machine on which a run is measured, and restarts the program with huge pages.
#include "measure/machine.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string_view>
#include <thread>

#include "normals/curves/kernels/prefetch.h"
#include "simd/targets.h"

namespace chronormal::bench {
namespace {

constexpr const char* kTunables = "GLIBC_TUNABLES";
constexpr const char* kHugePages = "glibc.malloc.hugetlb=1";

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (const std::size_t colon = line.find(": "); line.starts_with("model name") && colon != std::string::npos)
      return line.substr(colon + 2);
  }
  return "unknown";
}

// Returns the sizes of the caches as text, such as "L1d 48K, L2 1024K, L3 32768K".
std::string caches() {
  std::string text;
  for (int index = 0; index < 8; ++index) {
    const std::string folder = fmt::format("/sys/devices/system/cpu/cpu0/cache/index{}/", index);
    const std::string level = first_line(folder + "level"), type = first_line(folder + "type");
    if (level.empty() || type == "Instruction") continue;
    text += fmt::format("{}L{}{} {}", text.empty() ? "" : ", ", level, type == "Data" ? "d" : "",
                        first_line(folder + "size"));
  }
  return text.empty() ? "unknown" : text;
}

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

std::string output_of(const std::string& command) {
  FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "";
  char text[256] = {};
  const std::size_t size = std::fread(text, 1, sizeof text - 1, pipe);
  pclose(pipe);
  std::string line(text, size);
  return line.substr(0, line.find('\n'));
}

std::string commit() {
  const std::string git = fmt::format("git -C '{}' ", CHRONORMAL_SOURCE_DIR);
  const std::string id = output_of(git + "rev-parse --short=10 HEAD 2>/dev/null");
  if (id.empty()) return "unknown";
  return output_of(git + "status --porcelain 2>/dev/null").empty() ? id : fmt::format("{} and changes", id);
}

std::string date() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d", &utc);
  return text;
}

std::string huge_pages() {
  const std::string setting = first_line("/sys/kernel/mm/transparent_hugepage/enabled");
  const std::size_t open = setting.find('['), close = setting.find(']');
  if (open == std::string::npos || close == std::string::npos) return "none";
  const std::string mode = setting.substr(open + 1, close - open - 1);
  const char* const tunables = std::getenv(kTunables);
  const bool for_all = tunables != nullptr && std::string_view(tunables).find(kHugePages) != std::string_view::npos;
  return fmt::format("{}{}", mode, for_all ? ", for libraries too" : "");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> describe_machine() {
  return {{"cpu", cpu_name()},          {"cores", std::to_string(std::thread::hardware_concurrency())},
          {"caches", caches()},         {"instruction_set", target_name(current_target())},
          {"huge_pages", huge_pages()}, {"compiler", compiler()},
          {"commit", commit()},         {"date", date()}};
}

std::string chosen_prefetch() {
  const auto distance = [](WorkingSet set) {
    const std::size_t bytes = prefetch_of_curves(set).best();
    return bytes > 0 ? fmt::format("{} KiB ahead", bytes / 1024) : std::string("none");
  };
  return fmt::format("{} up to 1 MiB, {} up to 8 MiB, {} in the shared cache, {} in memory",
                     distance(WorkingSet::kSmall), distance(WorkingSet::kMedium), distance(WorkingSet::kSharedCache),
                     distance(WorkingSet::kMemory));
}

void restart_with_huge_pages(char** argv) {
  const char* const tunables = std::getenv(kTunables);
  if (tunables != nullptr && std::string_view(tunables).find("glibc.malloc.hugetlb") != std::string_view::npos) return;
  const std::string value =
      tunables == nullptr || *tunables == '\0' ? std::string(kHugePages) : fmt::format("{}:{}", tunables, kHugePages);
  if (setenv(kTunables, value.c_str(), 1) != 0) return;
  execv("/proc/self/exe", argv);  // if this fails, the run continues with small pages
}

}  // namespace chronormal::bench
