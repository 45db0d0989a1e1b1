// Reads glTF files in which one number, one byte or the length is wrong. Each file must give an error with a place, or
// a valid result.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/gltf_invariants.h"
#include "tests/support/child_process.h"
#include "tests/support/gltf_documents.h"
#include "tests/support/random_edits.h"

namespace chronormal::gltf_boundary_test {
namespace {

using test::GltfBuilder, test::GltfFixture;
using Json = nlohmann::json;

constexpr std::size_t kMostGrowth = std::size_t{256} << 20;

// A reader of any number of files that counts refused files and collects complaints about broken invariants.
class Batch {
 public:
  // Reads a file. A sanitizer makes reading slow, so with a sanitizer only every seventh file is read.
  void read(const std::string& label, const std::string& bytes) {
    last_refused_ = true;
    if (++count_ % 7 != 0 && test::is_sanitized()) return;
    const auto start = std::chrono::steady_clock::now();
    const GltfFixture file(bytes);
    const fuzz::GltfReading reading = fuzz::read_all_of(file.result(), "a.gltf", GltfMotionOptions().most_bytes);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    refused_ += reading.errors.empty() ? 0U : 1U;
    if (!reading.broken.empty()) complaints_ += label + ": " + reading.broken + "\n";
    if (seconds > 1) complaints_ += label + ": " + std::to_string(seconds) + " s\n";
    last_refused_ = !reading.errors.empty();
  }
  void complain(const std::string& label) { complaints_ += label + "\n"; }
  [[nodiscard]] bool last_was_refused() const { return last_refused_; }

  // Returns a text with the number of files, the number of refused files, and the complaints.
  [[nodiscard]] std::string summary() const {
    return std::to_string(count_) + " " + std::to_string(refused_) + " " + complaints_;
  }

 private:
  std::size_t count_ = 0, refused_ = 0;
  bool last_refused_ = false;
  std::string complaints_;
};

void expect_good_batch(std::size_t least_count, const std::function<void(Batch&)>& work) {
  const test::ChildRun run = test::run_in_child(250, [&] {
    Batch batch;
    work(batch);
    return batch.summary();
  });
  ASSERT_TRUE(run.finished) << run.text;
  std::size_t end = 0;
  const std::size_t count = std::stoull(run.text, &end), refused = std::stoull(run.text.substr(end));
  EXPECT_GE(count, least_count);
  EXPECT_GT(refused, 0U);
  EXPECT_EQ(run.text, std::to_string(count) + " " + std::to_string(refused) + " ");
  if (!test::is_sanitized()) {
    EXPECT_LT(run.peak_growth, kMostGrowth);  // not under a sanitizer, which keeps freed memory
  }
  std::printf("%zu files, %zu of them refused, in %.2f s, %zu KiB\n", count, refused, run.seconds,
              run.peak_growth / 1024);
}

// Calls visit() for every number in a JSON document, with the JSON pointer to the number.
void for_each_number(const Json& value, const Json::json_pointer& at,
                     const std::function<void(const Json::json_pointer&)>& visit) {
  if (value.is_number()) visit(at);
  if (!value.is_structured()) return;
  for (const auto& [key, item] : value.items())
    for_each_number(item, value.is_array() ? at / std::stoull(key) : at / key, visit);
}

TEST(GltfBoundary, documents_that_are_to_be_broken_are_right) {
  for (const auto& [name, builder] : test::all_documents()) {
    const GltfFixture file(builder.gltf());
    const fuzz::GltfReading reading = fuzz::read_all_of(file.result(), "a.gltf", std::size_t{1} << 20);
    EXPECT_EQ(reading.broken, "") << name;
    EXPECT_TRUE(reading.errors.empty()) << name << ": " << reading.errors.front().text();
    EXPECT_EQ(reading.motions, 2U) << name;
    EXPECT_TRUE(reading.has_mesh) << name;
  }
}

TEST(GltfBoundary, every_number_of_a_document_at_its_boundaries) {
  expect_good_batch(2000, [](Batch& batch) {
    const std::vector<Json> values = {-1,
                                      0,
                                      1,
                                      1.5,
                                      3,
                                      255,
                                      65535,
                                      2147483647,
                                      2147483648U,
                                      4294967295U,
                                      4294967296,
                                      std::int64_t{1} << 53,
                                      std::int64_t{1} << 62,
                                      std::uint64_t{1} << 63,
                                      ~std::uint64_t{0},
                                      ~std::uint64_t{0} - 3,
                                      -9223372036854775807,
                                      1e300,
                                      1e-300};
    for (const auto& [name, builder] : test::all_documents()) {
      const Json whole = Json::parse(builder.gltf());
      for_each_number(whole, Json::json_pointer(), [&, &label = name](const Json::json_pointer& at) {
        for (const Json& value : values) {
          Json broken = whole;
          broken[at] = value;
          batch.read(label + " " + at.to_string() + " := " + value.dump(), broken.dump());
        }
      });
    }
  });
}

TEST(GltfBoundary, every_value_of_a_document_of_another_type_or_missing) {
  expect_good_batch(2000, [](Batch& batch) {
    const std::vector<Json> values = {nullptr, true, "", "x", Json::array(), Json::object(), {1}, {{"a", 1}}, 7};
    for (const auto& [name, builder] : test::all_documents()) {
      const Json whole = Json::parse(builder.gltf()), flat = whole.flatten();
      for (const auto& [key, unused] : flat.items()) {
        // Replaces the value at the pointer, and then, one after the other, each object or array that contains this
        // value.
        for (Json::json_pointer at(key); !at.empty(); at.pop_back()) {
          for (const Json& value : values) {
            Json broken = whole;
            broken[at] = value;
            batch.read(name + " " + at.to_string() + " := " + value.dump(), broken.dump());
          }
          Json without = whole;
          Json& parent = without[at.parent_pointer()];
          if (parent.is_object())
            parent.erase(at.back());
          else
            parent.erase(std::stoull(at.back()));
          batch.read(name + " without " + at.to_string(), without.dump());
        }
      }
    }
  });
}

TEST(GltfBoundary, every_word_of_a_container) {
  expect_good_batch(500, [](Batch& batch) {
    for (const auto& [name, builder] : test::all_documents()) {
      const std::string glb = builder.glb();
      std::vector<std::size_t> words = {0, 4, 8, 12, 16};
      const std::size_t second = glb.find(std::string("BIN\0", 4)) - 4;
      words.insert(words.end(), {second, second + 4});
      for (const std::size_t at : words) {
        std::uint32_t word = 0;
        std::memcpy(&word, glb.data() + at, 4);
        for (const std::uint32_t value : {0U, 1U, 2U, 3U, 4U, 12U, 20U, word - 4, word - 1, word + 1, word + 4,
                                          0x7FFFFFFFU, 0x80000000U, 0xFFFFFFF0U, 0xFFFFFFFCU, 0xFFFFFFFFU}) {
          std::string broken = glb;
          std::memcpy(broken.data() + at, &value, 4);
          batch.read(name + " byte " + std::to_string(at) + " := " + std::to_string(value), broken);
        }
      }
    }
  });
}

TEST(GltfBoundary, every_truncated_file_is_refused) {
  expect_good_batch(5000, [](Batch& batch) {
    for (const auto& [name, builder] : test::all_documents()) {
      for (const std::string& bytes : {builder.glb(), builder.gltf()}) {
        for (std::size_t size = 0; size < bytes.size(); ++size) {
          const std::string label = name + " cut to " + std::to_string(size) + " bytes";
          batch.read(label, bytes.substr(0, size));
          if (!batch.last_was_refused()) batch.complain(label + " was read");
        }
      }
    }
  });
}

TEST(GltfBoundary, every_byte_of_a_file) {
  expect_good_batch(20000, [](Batch& batch) {
    for (const auto& [name, builder] : test::all_documents()) {
      const std::string glb = builder.glb();
      const std::size_t json_end = glb.find(std::string("BIN\0", 4));
      for (std::size_t at = 0; at < glb.size(); ++at) {
        std::string values("\0\xFF", 2);
        if (at >= 20 && at < json_end) values += "\"{9";
        for (const char value : values) {
          std::string broken = glb;
          broken[at] = value;
          batch.read(name + " byte " + std::to_string(at), broken);
        }
      }
    }
  });
}

TEST(GltfBoundary, every_bit_and_count_of_compressed_bytes) {
  expect_good_batch(5000, [](Batch& batch) {
    for (const auto& [name, builder] : test::all_documents()) {
      if (name == "sparse" || name == "quantised") continue;
      const auto read_with = [&, &whole = builder, &label = name](std::size_t at, const std::string& bytes) {
        GltfBuilder broken = whole;
        broken.buffer.replace(at, bytes.size(), bytes);
        batch.read(label + " byte " + std::to_string(at) + ", " + std::to_string(bytes.size()) + " bytes",
                   broken.glb());
      };
      for (std::size_t at = 0; at < builder.buffer.size(); ++at) {
        for (int bit = 0; bit < 8; ++bit)
          read_with(at, std::string(1, static_cast<char>(builder.buffer[at] ^ (1 << bit))));
        // Draco encodes counts in 7, 14, 21, 28 or 32 bits, or as plain numbers of 32 bits. The test tries large counts
        // in each encoding.
        for (const char* const count : {"\x7F", "\xFF\x7F", "\xFF\xFF\x7F", "\xFF\xFF\xFF\x7F", "\xFF\xFF\xFF\xFF\x0F",
                                        "\xFF\xFF\xFF\xFF", "\xAA\xAA\xAA\x0A", "\x80\x80\x80\x80\x08"}) {
          if (at + std::strlen(count) <= builder.buffer.size()) read_with(at, count);
        }
      }
    }
  });
}

TEST(GltfBoundary, random_edits) {
  expect_good_batch(20000, [](Batch& batch) {
    std::mt19937 random(20240603);
    for (const auto& [name, builder] : test::all_documents()) {
      for (int round = 0; round < 2000; ++round) {
        const std::string label = name + " round " + std::to_string(round);
        batch.read(label, test::with_random_edits(builder.gltf(), random));
        GltfBuilder broken = builder;  // a valid container with invalid compressed bytes
        broken.buffer = test::with_random_edits(builder.buffer, random);
        batch.read(label + ", buffer", broken.glb());
      }
    }
  });
}

}  // namespace
}  // namespace chronormal::gltf_boundary_test
