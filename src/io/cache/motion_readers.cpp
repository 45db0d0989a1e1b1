#include "io/cache/motion_readers.h"

#include <algorithm>
#include <array>

#include "io/bytes/extension.h"
#include "io/cache/maya_cache.h"
#include "io/cache/md2.h"
#include "io/cache/mdd.h"
#include "io/cache/npz.h"
#include "io/cache/pc2.h"

namespace chronormal {
namespace {

constexpr std::array<std::string_view, 1> kNpzExtensions = {".npz"}, kMd2Extensions = {".md2"};
constexpr std::array<std::string_view, 1> kPc2Extensions = {".pc2"}, kMddExtensions = {".mdd"},
                                          kNpyExtensions = {".npy"};
constexpr std::array<std::string_view, 2> kMayaExtensions = {".mc", ".mcx"};

bool is_zip(std::string_view first_bytes) { return first_bytes.starts_with("PK\3\4"); }
bool is_md2(std::string_view first_bytes) { return first_bytes.starts_with("IDP2"); }

constexpr std::array<MotionReader, 2> kMotionReaders = {{
    {"npz", kNpzExtensions, is_zip, read_npz},
    {"md2", kMd2Extensions, is_md2, read_md2},
}};

constexpr std::array<CacheReader, 4> kCacheReaders = {{
    {"pc2", kPc2Extensions, read_pc2},
    {"mdd", kMddExtensions, read_mdd},
    {"npy", kNpyExtensions, read_npy},
    {"maya", kMayaExtensions, read_maya_points},
}};

template <class Readers>
auto find_reader(const Readers& readers, std::string_view file_name) -> decltype(readers.data()) {
  const std::string extension = lower_extension(file_name);
  for (const auto& reader : readers) {
    if (std::find(reader.extensions.begin(), reader.extensions.end(), extension) != reader.extensions.end())
      return &reader;
  }
  return nullptr;
}

}  // namespace

std::span<const MotionReader> motion_readers() noexcept { return kMotionReaders; }
std::span<const CacheReader> cache_readers() noexcept { return kCacheReaders; }

const MotionReader* find_motion_reader(std::string_view file_name) noexcept {
  return find_reader(kMotionReaders, file_name);
}
const CacheReader* find_cache_reader(std::string_view file_name) noexcept {
  return find_reader(kCacheReaders, file_name);
}

}  // namespace chronormal
