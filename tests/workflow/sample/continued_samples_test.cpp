// Tests samples that continue after the rows that an earlier run has written. tests/cli/resume_cli_test.cpp and
// tests/faults/killed_test.cpp test how the program continues.
#include "workflow/sample/continued_samples.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "chronormal/io/input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::continued_samples_test {
namespace {

constexpr const char* kRun = "a run";
const Moments kMoments{{0, 0.25, 0.5, 1}, {}};

// Writes at most `most` samples to an output, and then stops as if interrupted.
Result<SampleSummary> sampled(const test::TemporaryFolder& folder, std::size_t most, SampleOutput output) {
  const Motion motion = make_builtin_morph("twist").value();
  MotionStream stream(motion);
  Result<Journal> journal = Journal::open(folder / "out.journal", kRun);
  if (!journal) return journal.error();
  std::size_t computed = 0;
  SegmentRun run;
  run.journal = &journal.value();
  run.progress = [&](std::size_t, std::size_t) {
    if (++computed == most) throw std::runtime_error("the power is cut");
  };
  return write_samples(stream, {}, kMoments, output, run);
}

TEST(ContinuedSamples, count_the_normals_of_all_rows) {
  const test::TemporaryFolder folder;
  const SampleOutput output{folder / "out.npy"};
  EXPECT_THROW((void)sampled(folder, 3, output), std::runtime_error);
  EXPECT_TRUE(std::filesystem::exists(folder / "out.npy.partial"));
  const Result<SampleSummary> all = sampled(folder, 2, output);
  ASSERT_TRUE(all.ok()) << all.error().text();
  const Motion motion = make_builtin_morph("twist").value();
  const SampleSummary whole = write_samples(motion, {}, kMoments, {folder / "whole.npy"}).value();
  EXPECT_EQ(all.value().normals, whole.normals);
  EXPECT_EQ(all.value().zeros, whole.zeros);
  EXPECT_TRUE(test::read_whole(folder / "out.npy") == test::read_whole(folder / "whole.npy"));
  // The output is complete, but its journal still exists.
  const Result<SampleSummary> again = sampled(folder, 1, output);
  ASSERT_TRUE(again.ok()) << again.error().text();
  EXPECT_EQ(again.value().normals, whole.normals);
}

TEST(ContinuedSamples, refuse_what_cannot_be_continued) {
  const test::TemporaryFolder folder;
  for (const auto& [path, format, code] :
       {std::tuple(folder / "o.npz", SampleFormat::kNpz, ErrorCode::kUsage),
        std::tuple(folder / "o_%d.ply", SampleFormat::kPly, ErrorCode::kUsage),
        std::tuple(std::string("/dev/null"), SampleFormat::kNpy, ErrorCode::kUsage),
        std::tuple(folder / "no/folder.npy", SampleFormat::kNpy, ErrorCode::kFailed)}) {
    const Result<SampleSummary> refused = sampled(folder, 1, {path, format});
    ASSERT_FALSE(refused.ok()) << path;
    EXPECT_EQ(refused.error().code, code) << refused.error().text();
  }
  EXPECT_EQ(folder.entry_count(), 1U);  // the folder has only the journal
}

}  // namespace
}  // namespace chronormal::continued_samples_test
