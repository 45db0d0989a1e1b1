#include "io/mesh/make_human_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/support/cpu_time.h"
#include "tests/support/places.h"
#include "tests/support/random_edits.h"
#include "tests/support/target_bytes.h"

namespace chronormal::make_human_target_test {
namespace {

using test::gzip, test::kLiftTarget, test::kSquare;

Result<MakeHumanTarget> read(const std::string& bytes, const std::vector<float>& base = kSquare) {
  return read_make_human_target(bytes, "a.target", VectorView<const float>::packed(base.data(), base.size() / 3));
}

void expect_lift(const std::string& bytes) {
  const Result<MakeHumanTarget> target = read(bytes);
  ASSERT_TRUE(target.ok()) << target.error().text();
  EXPECT_EQ(target.value().vertices, (std::vector<std::uint32_t>{3, 1}));
  EXPECT_EQ(target.value().deltas, (std::vector<float>{0, 0, 0.5F, -0.25F, 0.125F, 0.1F}));
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

std::string error_text(const std::string& bytes, const std::vector<float>& base = kSquare) {
  const Result<MakeHumanTarget> target = read(bytes, base);
  if (target) return "no error";
  EXPECT_EQ(target.error().code, ErrorCode::kInvalidInput);
  return target.error().text();
}

// Reads the given bytes as a target, and checks that the result breaks no invariant. Returns true if the bytes are a
// valid target.
bool check(const std::string& bytes, const std::vector<float>& base = kSquare) {
  const test::CpuClock clock;
  const Result<MakeHumanTarget> target = read(bytes, base);
  EXPECT_LT(clock.seconds(), 1.0);
  if (!target) {
    EXPECT_EQ(target.error().code, ErrorCode::kInvalidInput);
    const bool has_place =
        target.error().place.starts_with("a.target, line ") || target.error().place.starts_with("a.target, byte ");
    EXPECT_TRUE(has_place) << target.error().text();
    EXPECT_FALSE(target.error().message.empty());
    return false;
  }
  const auto& [vertices, deltas] = target.value();
  EXPECT_EQ(deltas.size(), 3 * vertices.size());
  EXPECT_EQ(std::set<std::uint32_t>(vertices.begin(), vertices.end()).size(), vertices.size());
  for (std::size_t i = 0; i < deltas.size(); ++i) {
    if (vertices[i / 3] >= base.size() / 3) return ADD_FAILURE() << "vertex " << vertices[i / 3], true;
    EXPECT_TRUE(std::isfinite(base[3 * std::size_t{vertices[i / 3]} + i % 3] + deltas[i]));
  }
  return true;
}

TEST(MakeHumanTarget, deltas_are_read_whatever_the_line_ends_and_comments) {
  expect_lift(kLiftTarget);
  expect_lift(replaced(kLiftTarget, "\n", "\r\n"));
  expect_lift(replaced(kLiftTarget, "\n", "\r"));
  expect_lift("\xEF\xBB\xBF" + kLiftTarget);
  expect_lift(kLiftTarget.substr(0, kLiftTarget.size() - 1));
  expect_lift(" \t3\t0  0 .5 \n\n\n  # in between\n001 -.25 .125 .1");
}

TEST(MakeHumanTarget, gzip_is_known_by_its_first_bytes_and_may_have_several_members) {
  expect_lift(gzip(kLiftTarget));
  for (std::size_t cut = 0; cut <= kLiftTarget.size(); ++cut) {
    SCOPED_TRACE(cut);
    expect_lift(gzip(kLiftTarget.substr(0, cut)) + gzip(kLiftTarget.substr(cut)));
  }
  std::string long_text = kLiftTarget;
  for (int line = 0; line < 1500; ++line) long_text += "# comment " + std::to_string(line * 7919 % 1000) + "\n";
  expect_lift(gzip(long_text));
}

TEST(MakeHumanTarget, target_without_deltas_moves_nothing_but_an_empty_file_is_an_error) {
  for (const std::string text : {"# nothing\n", "\n", "#", " \n\t\n"}) {
    EXPECT_TRUE(check(text)) << text;
    EXPECT_TRUE(check(gzip(text))) << text;
  }
  EXPECT_EQ(error_text(""), "a.target, line 1: the file is empty; copy or export it again");
}

TEST(MakeHumanTarget, wrong_lines_are_errors_with_their_number_and_what_is_wrong) {
  const auto second_line = [](const std::string& line) { return error_text("0 0 0 0\n" + line + "\n2 1 1 1\n"); };
  const std::string at = "a.target, line 2: ";
  EXPECT_EQ(second_line("x 1 1 1"),
            at + "'x' is not the index of a vertex; a line must have an index and three numbers");
  EXPECT_EQ(second_line("1.5 1 1 1"),
            at + "'1.5' is not the index of a vertex; a line must have an index and three numbers");
  EXPECT_EQ(second_line("1"), at + "x of vertex 1: a number is missing here; add it, or export the file again");
  EXPECT_EQ(second_line("1 1 1"), at + "z of vertex 1: a number is missing here; add it, or export the file again");
  EXPECT_EQ(second_line("1 1 1 # 1"), at + "z of vertex 1: a number is missing here; add it, or export the file again");
  EXPECT_EQ(second_line("1 1 y 1"),
            at + "y of vertex 1: 'y' is not a valid number here; correct it, or export the file again");
  EXPECT_EQ(second_line("1 nan 1 1"), at + "x of vertex 1: 'nan' is NaN or infinite; write a finite number");
  EXPECT_EQ(second_line("1 1 -inf 1"), at + "y of vertex 1: '-inf' is NaN or infinite; write a finite number");
  EXPECT_EQ(second_line("1 1 1 1e39"), at + "z of vertex 1: '1e39' is too large for float32; write a smaller number");
  EXPECT_EQ(second_line("1 1 1 1 1"),
            at + "the line has '1' after the delta of vertex 1, but must have only an index and three numbers");
  EXPECT_EQ(second_line("0 1 1 1"), at + "vertex 0 has two deltas in this file; remove one of them");
  EXPECT_EQ(error_text(gzip("0 0 0 0\n\nq")),
            "a.target, line 3: 'q' is not the index of a vertex; a line must have an index and three numbers");
}

TEST(MakeHumanTarget, indices_are_those_of_the_base_and_do_not_wrap_around) {
  EXPECT_TRUE(check("0 1 1 1\n3 1 1 1\n"));
  for (const std::string index :
       {"4", "-1", "-0x1", "2147483648", "4294967295", "4294967296", "4294967297", "9223372036854775807",
        "9223372036854775808", "18446744073709551616", "-9223372036854775809", "99999999999999999999999999"}) {
    const std::string text = error_text(index + " 1 1 1\n");
    EXPECT_TRUE(text.starts_with("a.target, line 1: '" + index + "' is ")) << text;
  }
  EXPECT_EQ(error_text("4 1 1 1"),
            "a.target, line 1: '4' is not a vertex of the base, whose 4 vertices are counted from 0; give the base "
            "that the target was made for");
}

TEST(MakeHumanTarget, delta_must_not_take_a_coordinate_out_of_float32) {
  const float most = std::numeric_limits<float>::max();
  EXPECT_TRUE(check("0 3.4028234e38 0 0\n", {0, 0, 0}));
  EXPECT_TRUE(check("0 -3.4028234e38 0 1\n", {most, 0, most}));
  EXPECT_EQ(error_text("0 0 0 1e38\n", {0, 0, most}),
            "a.target, line 1: z of vertex 0: the sum of base and delta is too large for float32; scale the mesh down");
  EXPECT_EQ(error_text("0 0 -3e38 0\n", {0, -3e38F, 0}),
            "a.target, line 1: y of vertex 0: the sum of base and delta is too large for float32; scale the mesh down");
}

TEST(MakeHumanTarget, text_cut_off_anywhere_is_an_error_or_the_lines_before_it) {
  for (std::size_t size = 0; size < kLiftTarget.size(); ++size) {
    SCOPED_TRACE(size);
    (void)check(kLiftTarget.substr(0, size));
    const Result<MakeHumanTarget> target = read(kLiftTarget.substr(0, size));
    if (size <= kLiftTarget.find("3 0") && size > 0) {
      EXPECT_TRUE(target.ok() && target.value().vertices.empty());
    }
    if (size >= kLiftTarget.find("1 -.25") + 1 && size < kLiftTarget.find("1e-1")) {
      EXPECT_FALSE(target.ok());
    }
  }
}

TEST(MakeHumanTarget, gzip_cut_off_anywhere_is_an_error_with_its_byte) {
  const std::string bytes = gzip(kLiftTarget);
  for (std::size_t size = 2; size < bytes.size(); ++size)
    EXPECT_EQ(error_text(bytes.substr(0, size)),
              "a.target, byte " + std::to_string(size) + ": the gzip data are cut off; copy the file again");
  EXPECT_FALSE(check(bytes.substr(0, 1)));
  // A cut inside the second member of a gzip file must also be an error.
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_FALSE(check(gzip("# first\n") + bytes.substr(0, size)));
}

TEST(MakeHumanTarget, damaged_gzip_is_an_error_with_a_byte_or_damaged_where_nobody_looks) {
  const std::string bytes = gzip(kLiftTarget);
  std::size_t harmless = 0;
  for (std::size_t at = 2; at < bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      SCOPED_TRACE("byte " + std::to_string(at) + ", bit " + std::to_string(bit));
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
      if (!check(damaged)) {
        EXPECT_TRUE(error_text(damaged).starts_with("a.target, byte ")) << error_text(damaged);
        continue;
      }
      // A changed byte goes unnoticed only in the date and the system of the gzip header, or in the unused bits between
      // the compressed data and the checksum.
      expect_lift(damaged);
      EXPECT_TRUE(at < 10 || at == bytes.size() - 9);
      ++harmless;
    }
  }
  EXPECT_LE(harmless, 49U + 7U);
  std::string checksum = bytes;
  checksum[bytes.size() - 8] = static_cast<char>(checksum[bytes.size() - 8] ^ 1);
  EXPECT_EQ(error_text(checksum), "a.target, byte " + std::to_string(bytes.size() - 4) +
                                      ": the gzip data are damaged; copy the file again (incorrect data check)");
  EXPECT_EQ(error_text(bytes + "more"),
            "a.target, byte " + std::to_string(bytes.size() + 2) +
                ": the gzip data are damaged; copy the file again (incorrect header check)");
}

TEST(MakeHumanTarget, gzip_may_unpack_to_a_stated_size_and_not_a_byte_more) {
  EXPECT_EQ(most_target_bytes(4), 65536U + 1024U);
  const auto padded = [](std::size_t size) {
    return gzip("3 0 0 .5\n1 -.25 .125 .1\n#" + std::string(size - 26, '-'));
  };
  EXPECT_EQ(std::string("3 0 0 .5\n1 -.25 .125 .1\n#").size(), 25U);
  expect_lift(padded(most_target_bytes(4) + 1));
  EXPECT_TRUE(error_text(padded(most_target_bytes(4) + 2)).find("unpacks to more than 66,560 bytes") !=
              std::string::npos);
  // Tests a file with many empty gzip members, and then a file whose members are large only together.
  std::string members;
  for (int i = 0; i < 1000; ++i) members += gzip("");
  expect_lift(members + gzip(kLiftTarget));
  for (int i = 0; i < 8; ++i) members += gzip(std::string(16384, '\n'));
  EXPECT_FALSE(check(members));

  const std::string bomb = gzip(std::string(std::size_t{1} << 28, '\n'));
  EXPECT_LT(bomb.size(), 300000U);
  EXPECT_FALSE(check(bomb));
}

TEST(MakeHumanTarget, boundary_numbers_everywhere_are_errors_or_targets) {
  const auto is_part = [](char c) { return c != ' ' && c != '\n' && c != '#'; };
  std::size_t cases = 0;
  for (std::size_t at = 0; at < kLiftTarget.size(); ++at) {
    if (!is_part(kLiftTarget[at]) || (at > 0 && is_part(kLiftTarget[at - 1]))) continue;
    std::size_t end = at;
    while (end < kLiftTarget.size() && is_part(kLiftTarget[end])) ++end;
    for (const char* const value :
         {"",     "0",   "-0",       "1",          "3",          "4",        "-1",         "+1",
          "++1",  "1.",  ".",        "-",          "1e",         "1e-400",   "1e400",      "3.4028235e38",
          "0x10", "nan", "infinity", "2147483648", "4294967296", "1e-46",    "-1e-46",     "9223372036854775808",
          "#",    "1#2", "\"1\"",    "1,5",        "\x01",       "\xFF\xFF", "4294967299", "-9223372036854775808"}) {
      SCOPED_TRACE("byte " + std::to_string(at) + " := " + value);
      const std::string bytes = std::string(kLiftTarget).replace(at, end - at, value);
      EXPECT_EQ(check(bytes), check(gzip(bytes)));
      ++cases;
    }
  }
  EXPECT_GE(cases, 300U);
}

TEST(MakeHumanTarget, random_edits_are_errors_or_targets) {
  std::mt19937 random(20240601);
  const std::string packed = gzip(kLiftTarget);
  for (const std::string& original : {kLiftTarget, packed}) {
    for (int round = 0; round < 8000; ++round) {
      SCOPED_TRACE(round);
      (void)check(test::with_random_edits(original, random));
    }
  }
}

TEST(MakeHumanTarget, is_known_by_its_extension) {
  for (const char* const name : {"a.target", "a.TARGET", "b.c/a.target.gz", "a.Target.Gz", ".target", "*.target"})
    EXPECT_TRUE(is_make_human_target(name)) << name;
  for (const char* const name : {"a.gz", "target", "a.target/b", "a.target.obj", "a.targets", "", "a.target.gz.gz"})
    EXPECT_FALSE(is_make_human_target(name)) << name;
}

TEST(MakeHumanTarget, has_a_fuzz_target_and_seeds) {
  const std::filesystem::path fuzz = std::filesystem::path(kSourceFolder) / "fuzz";
  EXPECT_TRUE(std::filesystem::is_regular_file(fuzz / "target_fuzz.cpp"));
  ASSERT_TRUE(std::filesystem::is_directory(fuzz / "seeds/target"));
  EXPECT_FALSE(std::filesystem::is_empty(fuzz / "seeds/target"));
}

}  // namespace
}  // namespace chronormal::make_human_target_test
