// Tests all readers of motions and caches in the table of formats. Fails if this file has no fixture for a reader, or
// if the reader has no fuzz target.
#include "io/input/formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "io/bytes/expansion.h"
#include "io/cache/maya_cache.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/cpu_time.h"
#include "tests/support/places.h"
#include "tests/support/random_edits.h"

namespace chronormal::motion_readers_test {
namespace {

struct Fixture {
  std::string label;
  std::string bytes;
  bool is_self_contained = true;  // true if any cut of the file is an error
};

const std::map<std::string, std::vector<Fixture>, std::less<>>& fixture_table() {
  using test::npy, test::npy_header, test::raw;
  static const std::map<std::string, std::vector<Fixture>, std::less<>> table = {
      {"pc2", {{"two samples", test::small_pc2(40, 1)}}},
      {"mdd", {{"two samples", test::small_mdd(0, 0.5F)}}},
      {"npy",
       {{"float32", npy(npy_header("<f4", "(2, 3, 3)"), raw(test::turning_elements<float>(false)))},
        {"big float64, Fortran",
         npy(npy_header(">f8", "(2L, 3, 3,)", true), raw(test::turning_elements<double>(true), true), 3)}}},
      {"npz", {{"stored", test::small_npz(false)}, {"deflated", test::small_npz(true)}}},
      {"md2", {{"two keyframes", test::small_md2()}}},
      {"maya",
       {{"FOR4 float", test::small_maya<float>(false), false},
        {"FOR4 double", test::small_maya<double>(false), false},
        {"FOR8 float", test::small_maya<float>(true), false},
        {"FOR8 double", test::small_maya<double>(true), false}}},
      {"maya_xml", {{"description", test::maya_xml("OneFile", "mcc", 125, 250, 375), false}}},
  };
  return table;
}

// Checks that an error has the code kInvalidInput, a place in the file, and a message.
void check_error(const Error& error) {
  EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
  EXPECT_TRUE(error.place.starts_with("a.bin")) << error.text();
  EXPECT_FALSE(error.message.empty());
}
bool check(const Result<PositionCache>& result, std::size_t byte_count) {
  if (!result) return check_error(result.error()), false;
  const PositionCache& cache = result.value();
  EXPECT_GT(cache.vertex_count, 0U);
  EXPECT_FALSE(cache.samples.empty());
  EXPECT_LE(cache.vertex_count * cache.samples.size(), byte_count);
  for (const PositionCache::Sample& sample : cache.samples) {
    EXPECT_TRUE(std::isfinite(sample.time));
    EXPECT_EQ(sample.positions.size(), 3 * cache.vertex_count);
    EXPECT_TRUE(
        std::all_of(sample.positions.begin(), sample.positions.end(), [](float x) { return std::isfinite(x); }));
  }
  return true;
}
bool check(const Result<Motion>& result, std::size_t byte_count) {
  if (!result) return check_error(result.error()), false;
  EXPECT_TRUE(validate(result.value()).ok());
  EXPECT_LE(result.value().topology.vertex_count() * result.value().keyframes.size(), 1033 * byte_count);
  return true;
}
bool check(const Result<MayaCacheDescription>& result, std::size_t) {
  if (!result) return check_error(result.error()), false;
  EXPECT_GT(result.value().ticks_per_frame, 0);
  return true;
}

// Returns all readers by name. Each reader is a function that tells whether it accepts the given bytes.
std::map<std::string, std::function<bool(const std::string&)>> all_readers() {
  std::map<std::string, std::function<bool(const std::string&)>> readers;
  for (const Format& format : formats()) {
    if (format.read_cache != nullptr)
      readers.emplace(format.name, [&format](const std::string& bytes) {
        return check(format.read_cache(bytes, "a.bin", {1, 3, ""}), bytes.size());
      });
    if (format.read_motion != nullptr)
      readers.emplace(format.name, [&format](const std::string& bytes) {
        return check(format.read_motion(bytes, "a.bin", 1, Expansion::kUsual), bytes.size());
      });
  }
  readers.emplace("maya_xml",
                  [](const std::string& bytes) { return check(read_maya_description(bytes, "a.bin"), bytes.size()); });
  return readers;
}

// A fixture for the tests of one reader. The parameter of a test is the name of the reader.
class MotionReaders : public ::testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] static const std::vector<Fixture>& reader_fixtures() {
    static const std::vector<Fixture> none;
    const auto found = fixture_table().find(GetParam());
    return found == fixture_table().end() ? none : found->second;
  }
  bool read_anything(const std::string& bytes) {
    ++case_count_;
    const test::CpuClock clock;
    const bool is_read = read_(bytes);
    EXPECT_LT(clock.seconds(), 1.0);
    return is_read;
  }

  std::function<bool(const std::string&)> read_ = all_readers().at(GetParam());
  std::size_t case_count_ = 0;
};

TEST_P(MotionReaders, have_fixtures_that_they_read) {
  ASSERT_FALSE(reader_fixtures().empty()) << "give the reader " << GetParam() << " fixtures in this file";
  for (const Fixture& fixture : reader_fixtures()) EXPECT_TRUE(read_anything(fixture.bytes)) << fixture.label;
}

TEST_P(MotionReaders, have_a_fuzz_target_and_seeds) {
  const std::filesystem::path fuzz = std::filesystem::path(kSourceFolder) / "fuzz";
  EXPECT_TRUE(std::filesystem::is_regular_file(fuzz / (GetParam() + "_fuzz.cpp")));
  ASSERT_TRUE(std::filesystem::is_directory(fuzz / "seeds" / GetParam()));
  EXPECT_FALSE(std::filesystem::is_empty(fuzz / "seeds" / GetParam()));
}

TEST_P(MotionReaders, truncated_file_is_an_error_or_a_shorter_cache) {
  ASSERT_FALSE(reader_fixtures().empty());
  for (const Fixture& fixture : reader_fixtures()) {
    for (std::size_t size = 0; size < fixture.bytes.size(); ++size) {
      SCOPED_TRACE(fixture.label + " cut to " + std::to_string(size) + " bytes");
      const bool is_read = read_anything(fixture.bytes.substr(0, size));
      EXPECT_FALSE(is_read && fixture.is_self_contained);
    }
  }
}

TEST_P(MotionReaders, boundary_numbers_in_every_field_are_errors_or_results) {
  ASSERT_FALSE(reader_fixtures().empty());
  constexpr std::uint64_t kValues[] = {0,
                                       1,
                                       0x7F,
                                       0x80,
                                       0xFF,
                                       0x7FFF,
                                       0x8000,
                                       0xFFFF,
                                       0x7F800000,  // the bits of infinity as float32
                                       0x7FFFFFFF,
                                       0x80000000,
                                       0xFFFFFFFF,
                                       0x100000000,
                                       0x100000001,
                                       std::uint64_t{1} << 62,
                                       0x5555555555555556,
                                       0x7FF0000000000000,  // the bits of infinity as float64
                                       0x7FFFFFFFFFFFFFFF,
                                       0x8000000000000000,
                                       0xFFFFFFFFFFFFFFFF};
  for (const Fixture& fixture : reader_fixtures()) {
    for (const std::size_t width : {std::size_t{1}, std::size_t{2}, std::size_t{4}, std::size_t{8}}) {
      for (const std::uint64_t value : kValues) {
        if (width < 8 && value >> (8 * width) != 0 && value != 0xFFFFFFFFFFFFFFFF) continue;
        for (const bool big_endian : {false, true}) {
          std::string pattern = test::ByteWriter("", big_endian).add(value).bytes();
          pattern = big_endian ? pattern.substr(8 - width) : pattern.substr(0, width);
          for (std::size_t at = 0; at + width <= fixture.bytes.size(); ++at) {
            SCOPED_TRACE(fixture.label + ", byte " + std::to_string(at) + ", width " + std::to_string(width));
            std::string bytes = fixture.bytes;
            (void)read_anything(bytes.replace(at, width, pattern));
          }
        }
      }
    }
  }
  EXPECT_GE(case_count_, 3000U);
}

TEST_P(MotionReaders, boundary_numbers_in_text_are_errors_or_results) {
  for (const Fixture& fixture : reader_fixtures()) {
    const std::string& bytes = fixture.bytes;
    const auto is_digit = [&](std::size_t i) { return i < bytes.size() && bytes[i] >= '0' && bytes[i] <= '9'; };
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      if (!is_digit(at) || (at > 0 && is_digit(at - 1))) continue;
      std::size_t end = at;
      while (is_digit(end)) ++end;
      for (const char* const value : {"0", "1", "2147483647", "2147483648", "4294967296", "4611686018427387904",
                                      "6148914691236517206", "9223372036854775808", "18446744073709551615",
                                      "18446744073709551616", "-1", "-2147483648", "-9223372036854775808", "", "1.5"}) {
        SCOPED_TRACE(fixture.label + ", byte " + std::to_string(at) + " := " + value);
        // Replaces a number by another number, which may be longer or shorter. A text file then keeps its structure; a
        // binary file may lose it.
        (void)read_anything(std::string(bytes).replace(at, end - at, value));
      }
    }
  }
}

TEST_P(MotionReaders, random_edits_are_errors_or_results) {
  ASSERT_FALSE(reader_fixtures().empty());
  std::mt19937 random(20240601);
  for (const Fixture& fixture : reader_fixtures()) {
    for (int round = 0; round < 4000; ++round) {
      SCOPED_TRACE(fixture.label + ", round " + std::to_string(round));
      (void)read_anything(test::with_random_edits(fixture.bytes, random));
    }
  }
}

std::vector<std::string> all_reader_names() {
  std::vector<std::string> names;
  for (const auto& [name, read] : all_readers()) names.push_back(name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Io, MotionReaders, ::testing::ValuesIn(all_reader_names()),
                         [](const auto& param_info) { return param_info.param; });

TEST(MotionFormats, are_found_by_content_where_the_name_does_not_tell) {
  EXPECT_EQ(find_format("<stdin>", test::small_npz(false))->name, "npz");
  EXPECT_EQ(find_format("<stdin>", test::small_md2())->name, "md2");
}

}  // namespace
}  // namespace chronormal::motion_readers_test
