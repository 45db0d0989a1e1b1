#include "io/input/numbering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/fixtures.h"

namespace chronormal::numbering_test {
namespace {

using Names = std::vector<std::string>;

Names sorted(Names names) {
  const Status status = sort_as_sequence("walk", names);
  if (!status) return {status.error().text()};
  return names;
}

std::vector<double> times_of(Names names) { return times_of_files(sorted(std::move(names))).times; }

TEST(Numbering, fractions_count_and_are_seconds) {
  const Names steps = {"t_0.obj", "t_0.05.obj", "t_0.1.obj", "t_0.15.obj", "t_0.2.obj"};
  EXPECT_EQ(sorted({steps[2], steps[4], steps[1], steps[3], steps[0]}), steps);
  const FileTimes times = times_of_files(steps);
  EXPECT_EQ(times.times, (std::vector<double>{0, 0.05, 0.1, 0.15, 0.2}));
  EXPECT_TRUE(times.series->are_seconds);
  EXPECT_TRUE(times.series->is_even());
  EXPECT_EQ(sorted({"f.1.25.obj", "f.1.obj", "f.10.obj", "f.1.5.obj", "f.2.obj"}),
            (Names{"f.1.obj", "f.1.25.obj", "f.1.5.obj", "f.2.obj", "f.10.obj"}));
  EXPECT_EQ(times_of({"f.1.25.obj", "f.1.obj"}), (std::vector<double>{1, 1.25}));
}

TEST(Numbering, a_minus_is_a_sign_after_a_blank_and_where_other_names_have_none) {
  const Names foo = {"foo -020.obj", "foo -019.obj", "foo 0000.obj", "foo 0001.obj"};
  EXPECT_EQ(sorted({foo[1], foo[0], foo[2], foo[3]}), foo);
  EXPECT_EQ(times_of(foo), (std::vector<double>{0, 1, 20, 21}));
  EXPECT_EQ(sorted({"t_-1.obj", "t_-2.obj", "t_0.obj", "t_1.obj"}),
            (Names{"t_-2.obj", "t_-1.obj", "t_0.obj", "t_1.obj"}));
  const Names frames = {"frame-001.obj", "frame-002.obj", "frame-100.obj"};
  EXPECT_EQ(sorted({frames[2], frames[0], frames[1]}), frames);
  EXPECT_EQ(sorted({"-1.obj", "-2.obj"}), (Names{"-2.obj", "-1.obj"}));
}

TEST(Numbering, an_exponent_counts_where_all_names_have_one) {
  EXPECT_EQ(sorted({"t_1e-05.obj", "t_2.5e-05.obj", "t_1e-04.obj", "t_9e-06.obj"}),
            (Names{"t_9e-06.obj", "t_1e-05.obj", "t_2.5e-05.obj", "t_1e-04.obj"}));
  EXPECT_EQ(times_of({"t_1e-05.obj", "t_1e+00.obj"}), (std::vector<double>{1e-05, 1}));
  // If all names have the form s2e1, the letter e does not begin an exponent: s2e1 has the two numbers 2 and 1.
  EXPECT_EQ(sorted({"s2e1.obj", "s2e2.obj", "s2e10.obj"}), (Names{"s2e1.obj", "s2e2.obj", "s2e10.obj"}));
}

TEST(Numbering, a_version_before_a_point_is_no_whole_part_of_a_number) {
  EXPECT_EQ(sorted({"a_v2.10.obj", "a_v2.9.obj", "a_v2.100.obj"}),
            (Names{"a_v2.9.obj", "a_v2.10.obj", "a_v2.100.obj"}));
  EXPECT_EQ(times_of({"a.001.0001.obj", "a.001.0002.obj", "a.001.0003.obj"}), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(sorted({"a.1.10.obj", "a.1.9.obj"}), (Names{"a.1.9.obj", "a.1.10.obj"}));
  EXPECT_EQ(times_of({"/v1.5/a1.obj", "/v1.5/a2.obj", "/v1.5/a3.obj"}), (std::vector<double>{0, 1, 2}));
}

TEST(Numbering, even_steps_of_whole_numbers_are_counted_and_uneven_ones_are_times) {
  EXPECT_EQ(times_of({"f_0010.obj", "f_0020.obj", "f_0030.obj"}), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(times_of({"f_0010.obj", "f_0020.obj", "f_0030.obj", "f_0060.obj"}), (std::vector<double>{0, 10, 20, 50}));
  EXPECT_FALSE(times_of_files({"f_1.obj", "f_2.obj", "f_4.obj"}).series->is_even());
  EXPECT_EQ(times_of({"f_1.obj", "f_99999999999999999999.obj"}), (std::vector<double>{0, 1}));
  // The names of files give no times if the files are not in the order of the numbers, or if the names have no numbers.
  EXPECT_FALSE(times_of_files({"f_4.obj", "f_2.obj"}).series);
  EXPECT_FALSE(times_of_files({"a.obj", "b.obj", "c.obj"}).series);
  EXPECT_EQ(times_of_files({"a/f_1.obj", "b/f_9.obj"}).times, (std::vector<double>{0, 1}));
}

TEST(Numbering, several_sequences_are_listed) {
  const std::string text = sorted({"walk_1.obj", "run_1.obj", "walk_2.obj", "run_2.obj", "walk_10.obj"}).front();
  EXPECT_EQ(text,
            "walk: the files are 2 sequences: walk_1.obj ... walk_10.obj (3 files), run_1.obj ... run_2.obj (2 files); "
            "choose one sequence with a pattern such as 'walk_*.obj'");
  EXPECT_NE(sorted({"take1_1.obj", "take1_2.obj", "take2_1.obj", "take2_2.obj"}).front().find("2 sequences"),
            std::string::npos);
  EXPECT_NE(sorted({"rest.obj", "walk_1.obj", "walk_2.obj"}).front().find("a sequence and other files"),
            std::string::npos);
  EXPECT_NE(sorted({"1.obj", "2.obj", "01.obj"}).front().find("01.obj and 1.obj have the same number"),
            std::string::npos);
  EXPECT_NE(sorted({"f_1.OBJ", "f_1.obj"}).front().find("the same number"), std::string::npos);
  // Names without a common pattern are sorted as text.
  EXPECT_EQ(sorted({"smile.obj", "neutral.obj", "brow2.obj"}), (Names{"brow2.obj", "neutral.obj", "smile.obj"}));
}

TEST(Numbering, dates_and_times_of_day_stand_in_their_order) {
  EXPECT_EQ(sorted({"s_2024-05-02_00-10.obj", "s_2024-05-01_23-50.obj"}),
            (Names{"s_2024-05-01_23-50.obj", "s_2024-05-02_00-10.obj"}));
}

TEST(Numbering, three_listed_files_are_sorted_and_two_are_not) {
  Names of_a_shell = {"f0.obj", "f1.obj", "f10.obj", "f2.obj"};
  EXPECT_TRUE(sort_listed(of_a_shell));
  EXPECT_EQ(of_a_shell, (Names{"f0.obj", "f1.obj", "f2.obj", "f10.obj"}));
  for (Names kept :
       {Names{"f10.obj", "f2.obj"}, Names{"f2.obj", "f1.obj", "f10.obj"}, Names{"f1.obj", "f10.obj", "g2.obj"},
        Names{"f1.obj", "f1.obj", "f10.obj", "f2.obj"}, Names{"f1.obj", "f2.obj", "f10.obj"}}) {
    const Names before = kept;
    EXPECT_FALSE(sort_listed(kept));
    EXPECT_EQ(kept, before);
  }
  // In most languages, the order of names ignores hyphens, so a list that is sorted in such a language is accepted and
  // sorted again by number.
  Names in_german = {"foo 0000.obj", "foo 0001.obj", "foo -0019.obj", "foo -0020.obj"};
  EXPECT_TRUE(sort_listed(in_german));
  EXPECT_EQ(in_german.front(), "foo -0020.obj");
}

// Draws numbers in thousandths, and makes names from them. The program must sort the names in the order of the numbers.
TEST(Numbering, names_that_are_drawn_stand_in_the_order_of_what_they_were_printed_from) {
  constexpr std::uint64_t kSeed = 5401;
  std::cout << "seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  constexpr const char* kStems[] = {"t_", "foo ", "sim.", "a1_", "cloth-v3_frame_", "x-"};
  for (int round = 0; round < 500; ++round) {
    const bool has_fraction = random.below(2) == 0, has_sign = random.below(3) == 0, is_padded = random.below(2) == 0;
    const std::string stem = kStems[random.below(std::size(kStems))], folder = random.below(2) == 0 ? "" : "in/v1.2/";
    const std::size_t count = 2 + random.below(30);
    std::vector<std::int64_t> thousandths;
    while (thousandths.size() < count) {
      std::int64_t value = static_cast<std::int64_t>(random.below(4000)) *
                           (has_fraction ? 1 + 9 * static_cast<std::int64_t>(random.below(9)) : 1000);
      if (has_sign && random.below(2) == 0) value = -value;
      if (std::find(thousandths.begin(), thousandths.end(), value) == thousandths.end()) thousandths.push_back(value);
    }
    // If no drawn number were positive, all names would have a sign, which could also be a hyphen.
    if (std::none_of(thousandths.begin(), thousandths.end(), [](std::int64_t value) { return value > 0; }))
      thousandths.push_back(1000000000);
    std::vector<std::pair<std::int64_t, std::string>> drawn;
    for (const std::int64_t value : thousandths) {
      const std::int64_t size = value < 0 ? -value : value;
      std::string whole = std::to_string(size / 1000), fraction = std::to_string(1000 + size % 1000).substr(1);
      while (fraction.ends_with('0')) fraction.pop_back();
      if (is_padded && !has_fraction) whole.insert(0, whole.size() < 5 ? 5 - whole.size() : 0, '0');
      const std::string number = (value < 0 ? "-" : "") + whole + (fraction.empty() ? "" : "." + fraction);
      drawn.emplace_back(value, folder + stem + number + (random.below(2) == 0 ? ".obj" : ".OBJ"));
    }
    Names names;
    for (const auto& [value, name] : drawn) names.push_back(name);
    std::sort(drawn.begin(), drawn.end());
    Names expected;
    for (const auto& [value, name] : drawn) expected.push_back(name);
    ASSERT_EQ(sorted(names), expected) << "round " << round;

    const std::vector<double> times = times_of_files(expected).times;
    const bool seconds =
        std::any_of(drawn.begin(), drawn.end(), [](const auto& each) { return each.first % 1000 != 0; });
    bool is_even = !seconds;
    for (std::size_t i = 2; i < drawn.size(); ++i)
      is_even = is_even && drawn[i].first - drawn[i - 1].first == drawn[1].first - drawn[0].first;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const double number = static_cast<double>(drawn[i].first) / 1000;
      const double first = static_cast<double>(drawn[0].first) / 1000;
      ASSERT_EQ(times[i], seconds ? number : is_even ? static_cast<double>(i) : number - first) << "round " << round;
    }
  }
}

}  // namespace
}  // namespace chronormal::numbering_test
