// Tests the parts of comparisons and audits that shards write. Merged parts must have the text of a single run. Parts
// that do not belong together must be refused.
#include "workflow/json/parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/output.h"
#include "io/bytes/checksum.h"
#include "tests/support/strict_stream.h"
#include "tests/support/temporary_folder.h"
#include "workflow/sample/continued_samples.h"

namespace chronormal::parts_test {
namespace {

// Makes a strip of triangles that bends, in eight segments.
Motion bending() {
  Motion motion;
  std::vector<std::uint32_t> corners;
  constexpr std::uint32_t kColumns = 40;
  for (std::uint32_t x = 0; x + 1 < kColumns; ++x) {
    const std::uint32_t v = 2 * x;
    corners.insert(corners.end(), {v, v + 2, v + 1, v + 2, v + 3, v + 1});
  }
  motion.topology = Topology::triangles(2 * std::size_t{kColumns}, corners).value();
  for (std::size_t k = 0; k < 9; ++k) {
    Motion::Keyframe keyframe{{}, 0.1 * static_cast<double>(k), ""};
    for (std::uint32_t v = 0; v < 2 * kColumns; ++v) {
      const double angle = 0.05 * static_cast<double>(k + 1) * (v / 2);
      keyframe.positions.insert(keyframe.positions.end(),
                                {static_cast<float>(std::sin(angle)), static_cast<float>(v % 2),
                                 static_cast<float>(std::cos(angle + 0.3 * (v % 2)))});
    }
    motion.keyframes.push_back(std::move(keyframe));
  }
  motion.connect_as_sequence();
  return motion;
}

std::string merged(std::vector<Part> parts) {
  std::reverse(parts.begin(), parts.end());  // parts may be in any order
  const Result<MergedParts> all = merge_parts(parts);
  return all ? all.value().json : all.error().text();
}

std::string compared_part(MotionStream& stream, const CompareOptions& options, CompareRun& run) {
  const Result<Comparison> comparison = compare(stream, options, run);
  return comparison ? compare_part({"walk", comparison.value()}, run) : comparison.error().text();
}

std::string compared_part(const Motion& motion, const CompareOptions& options, const Shard& shard) {
  MotionStream stream(motion);
  CompareRun run;
  run.shard = shard;
  return compared_part(stream, options, run);
}

std::string audited_part(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options,
                         const Shard& shard) {
  AuditRun run;
  run.shard = shard;
  const Result<Audit> found = audit(stream, normals, options, run);
  return found ? audit_part("walk", found.value(), run, 1) : found.error().text();
}

std::vector<Part> compare_parts(const Motion& motion, const CompareOptions& options, std::size_t count) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < count; ++i) {
    parts.push_back({"part_" + std::to_string(i), compared_part(motion, options, Shard{i, count})});
  }
  return parts;
}

std::vector<Part> audit_parts(const Motion& motion, const StoredNormals& normals, const AuditOptions& options,
                              std::size_t count) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < count; ++i) {
    MotionStream stream(motion);
    parts.push_back({"part_" + std::to_string(i), audited_part(stream, normals, options, Shard{i, count})});
  }
  return parts;
}

// Writes the samples of one shard to a file.
Result<SampleSummary> write_share(MotionStream& stream, const SampleOptions& options, const Moments& moments,
                                  const SampleOutput& output, const Shard& shard) {
  SegmentRun run;
  run.shard = shard;
  return write_samples(stream, options, moments, output, run);
}

Result<SampleSummary> write_share(const Motion& motion, const SampleOptions& options, const Moments& moments,
                                  const SampleOutput& output, const Shard& shard) {
  MotionStream stream(motion);
  return write_share(stream, options, moments, output, shard);
}

// Replaces `from` by `to` in the text of a part, and replaces the checksum by the checksum of the new text.
std::string edited(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  text.erase(text.find(",\"checksum\":\"")).push_back('}');
  return with_checksum(text);
}

TEST(Shard, shares_are_a_partition_and_of_nearly_equal_size) {
  for (const std::size_t total : {0U, 1U, 7U, 8U, 1000003U}) {
    for (const std::size_t count : {1U, 2U, 3U, 7U, 10U}) {
      std::size_t end = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const IndexRange share = Shard{i, count}.of(total);
        EXPECT_EQ(share.first, end);
        EXPECT_GE(share.count, total / count);
        EXPECT_LE(share.count, total / count + 1);
        end = share.end();
      }
      EXPECT_EQ(end, total);
    }
  }
}

TEST(MergeParts, shards_of_a_comparison_give_the_bytes_of_one_run) {
  const Motion motion = bending();
  std::vector<CompareOptions> all(3);
  all[1].elements.kind = ElementKind::kVertices;
  all[1].schemes = {"slerp", "quadratic"};
  all[1].tolerance = 0.5;
  all[2].access = Access::kSequential;
  for (const CompareOptions& options : all) {
    const std::string whole = compare_json({{"walk", compare(motion, options).value()}}, false, false);
    for (const std::size_t count : {1U, 2U, 3U, 8U, 11U})
      EXPECT_EQ(merged(compare_parts(motion, options, count)), whole);
  }
}

TEST(MergeParts, shards_of_an_audit_give_the_bytes_of_one_run) {
  const Motion motion = bending();
  StoredNormals normals;  // the stored normals of all keyframes point up, which is wrong from the first keyframe on
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    normals.of_keyframes.emplace_back();
    for (std::size_t c = 0; c < motion.topology.corner_count(); ++c)
      normals.of_keyframes.back().insert(normals.of_keyframes.back().end(),
                                         {0, k == 4 ? 0.0F : 0.25F, k == 4 ? 0.0F : 1.0F});
  }
  for (const StoredNormals& stored : {StoredNormals{}, normals}) {
    for (const AuditRule rule : {AuditRule::kNlerp, AuditRule::kFlat}) {
      AuditOptions options;
      options.rule = rule;
      const std::string whole = audit_json("walk", audit(motion, stored, options).value(), {1});
      for (const std::size_t count : {2U, 5U, 9U})
        EXPECT_EQ(merged(audit_parts(motion, stored, options, count)), whole);
    }
  }
}

// Ends a run after some segments. Another run takes over its results and continues.
TEST(KnownSegments, a_comparison_that_goes_on_gives_the_bytes_of_one_run) {
  const Motion motion = bending();
  MotionStream stream(motion);
  const CompareOptions options;
  for (const Shard shard : {Shard{}, Shard{1, 2}}) {
    const std::string whole = compared_part(motion, options, shard);
    for (std::size_t most = 0; most <= shard.of(8).count; ++most) {
      std::vector<std::string> kept;
      CompareRun first, second;
      first.shard = second.shard = shard;
      first.keep = [&](const ComparedSegment& segment) -> Status {
        if (kept.size() == most) return Error{ErrorCode::kFailed, "", "the disk is full"};
        kept.push_back(segment_part(segment));
        return Success{};
      };
      EXPECT_EQ(compare(stream, options, first).ok(), most == shard.of(8).count);
      ASSERT_EQ(kept.size(), most);
      for (const std::string& text : kept) second.known.push_back(read_compared_segment(text, "journal").value());
      std::size_t computed = 0;
      second.keep = [&](const ComparedSegment&) -> Status {
        ++computed;
        return Success{};
      };
      EXPECT_EQ(compared_part(stream, options, second), whole);
      EXPECT_EQ(computed + most, shard.of(8).count);
    }
  }
}

TEST(KnownSegments, an_audit_that_goes_on_gives_the_bytes_of_one_run) {
  const Motion motion = bending();
  MotionStream stream(motion);
  for (const AuditRule rule : {AuditRule::kNlerp, AuditRule::kSlerp}) {
    for (const std::size_t most : {0U, 3U, 8U}) {
      AuditOptions options;
      options.rule = rule;
      const std::string whole = audit_json("walk", audit(motion, {}, options).value(), {1});
      std::vector<std::string> kept;
      AuditRun first, second;
      first.keep = [&](const SegmentErrors& segment) -> Status {
        if (kept.size() == most) return Error{ErrorCode::kFailed, "", "the disk is full"};
        kept.push_back(segment_part(segment));
        return Success{};
      };
      EXPECT_EQ(audit(stream, {}, options, first).ok(), most == 8);
      for (const std::string& text : kept) second.known.push_back(read_measured_segment(text, "journal").value());
      std::size_t measured = 0;
      second.keep = [&](const SegmentErrors&) -> Status {
        ++measured;
        return Success{};
      };
      EXPECT_EQ(audit_json("walk", audit(stream, {}, options, second).value(), {1}), whole);
      EXPECT_EQ(measured + most, 8U);
    }
  }
}

TEST(KnownSegments, those_of_another_run_are_refused) {
  const Motion motion = bending();
  MotionStream stream(motion);
  CompareRun untallied;
  untallied.known.resize(1);
  EXPECT_EQ(compare(stream, {}, untallied).error().text(),
            "the segments that were computed before belong to another comparison; compute all segments again");
  CompareRun second_half, first_half;
  second_half.shard = Shard{1, 2};
  ASSERT_TRUE(compare(stream, {}, second_half).ok());
  first_half.shard = Shard{0, 2};
  first_half.known = second_half.found;
  EXPECT_EQ(compare(stream, {}, first_half).error().code, ErrorCode::kUsage);
  AuditRun too_many;
  too_many.known.resize(9);
  EXPECT_EQ(audit(stream, {}, {}, too_many).error().text(),
            "the segments that were computed before belong to another audit; compute all segments again");
  EXPECT_EQ(read_compared_segment("{\"segment\": 1, \"tallies\": [[1]]}", "journal").error().place,
            "journal, /tallies/0");
}

TEST(MergeParts, says_whether_the_tolerance_was_kept) {
  const Motion motion = bending();
  CompareOptions options;
  options.tolerance = 180;
  EXPECT_TRUE(merge_parts(compare_parts(motion, options, 2)).value().is_within);
  options.tolerance = 0;
  options.schemes = {"linear"};
  EXPECT_FALSE(merge_parts(compare_parts(motion, options, 2)).value().is_within);
}

TEST(MergeParts, refuses_shards_that_do_not_make_a_whole) {
  const Motion motion = bending();
  const std::vector<Part> three = compare_parts(motion, {}, 3), audits = audit_parts(motion, {}, {}, 3);
  EXPECT_EQ(merged({three[0], three[2]}), "segment 2 is missing; give the files of all shards");
  EXPECT_EQ(merged({three[0], three[1]}), "segment 5 is missing; give the files of all shards");
  EXPECT_EQ(merged({three[0], three[1], three[2], three[1]}), "segment 2 is in two of the files; give each file once");
  EXPECT_EQ(merged({audits[0], audits[1]}), "segment 5 is missing; give the files of all shards");
  CompareOptions other;
  other.samples = 5;
  EXPECT_EQ(
      merged({three[0], compare_parts(motion, other, 3)[1]}),
      "part_0: this shard does not belong to part_1, since they differ in the options; merge only shards of one run");
  AuditOptions stepping;
  stepping.rule = AuditRule::kStep;
  EXPECT_EQ(
      merged({audits[0], audit_parts(motion, {}, stepping, 3)[1]}),
      "part_0: this shard does not belong to part_1, since they differ in the options; merge only shards of one run");
  EXPECT_EQ(merged({three[0], audits[1]}), "the files are shards of both compare and audit; merge them separately");
}

TEST(MergeParts, refuses_shards_of_other_inputs_and_of_other_times) {
  const Motion motion = bending();
  Motion later = motion;
  for (Motion::Keyframe& keyframe : later.keyframes) keyframe.time += 1;
  const std::vector<Part> two = compare_parts(motion, {}, 2), audits = audit_parts(motion, {}, {}, 2);
  const std::string differ = "part_0: this shard does not belong to part_1, since they differ in ";
  EXPECT_EQ(merged({two[0], compare_parts(later, {}, 2)[1]}),
            differ + "the times of the keyframes; merge only shards of one run");
  EXPECT_EQ(merged({audits[0], audit_parts(later, {}, {}, 2)[1]}),
            differ + "the times of the keyframes; merge only shards of one run");
  for (const auto& [first, second] : {std::pair(two[0], two[1]), std::pair(audits[0], audits[1])}) {
    const Part other{second.name, edited(second.text, "\"walk\"", "\"run\"")};
    EXPECT_EQ(merged({first, other}), differ + "the name of the input; merge only shards of one run");
  }
}

TEST(MergeParts, refuses_parts_that_no_shard_writes) {
  std::string text = compare_parts(bending(), {}, 1)[0].text;
  EXPECT_NE(
      merged({{"a", edited(text, "\"segment_count\":8", "\"segment_count\":0")}}).find("the shard has no segments"),
      std::string::npos);
  CompareOptions options;
  options.certify = true;
  options.tolerance = 90;
  options.schemes = {"linear"};
  text = compare_parts(bending(), options, 1)[0].text;
  text = edited(text, "\"certified\":true", "\"certified\":false");
  EXPECT_NE(merged({{"a", text}}).find("a tolerance, but no bounds"), std::string::npos);
}

TEST(MergeParts, merged_values_are_those_of_one_run_and_of_the_kind_that_was_asked_for) {
  const Motion motion = bending();
  const std::vector<Part> compared = compare_parts(motion, {}, 3), audited = audit_parts(motion, {}, {}, 3);
  const Result<NamedComparison> comparison = merge_compare_parts(compared);
  ASSERT_TRUE(comparison.ok());
  EXPECT_EQ(compare_json({comparison.value()}, false, false),
            compare_json({{"walk", compare(motion, {}).value()}}, false, false));
  const Result<Audit> all = merge_audit_parts(audited);
  ASSERT_TRUE(all.ok());
  EXPECT_EQ(audit_json("walk", all.value(), {1}), audit_json("walk", audit(motion, {}, {}).value(), {1}));
  EXPECT_EQ(merge_compare_parts(audited).error().code, ErrorCode::kUsage);
  EXPECT_EQ(merge_audit_parts(compared).error().code, ErrorCode::kUsage);
  EXPECT_EQ(merge_audit_parts(std::vector<Part>{audited[0]}).error().code, ErrorCode::kUsage);
  EXPECT_EQ(merge_compare_parts(std::vector<Part>{{"a", "{}"}}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(merge_audit_parts(std::vector<Part>{{"a", "{}"}}).error().code, ErrorCode::kInvalidInput);
}

TEST(MergeParts, damaged_parts_are_errors_with_a_place) {
  const Motion motion = bending();
  for (const std::string& text : {compare_parts(motion, {}, 1)[0].text, audit_parts(motion, {}, {}, 2)[0].text}) {
    for (std::size_t size = 0; size + 1 < text.size(); size += 1 + text.size() / 40) {
      const Result<MergedParts> cut = merge_parts(std::vector<Part>{{"cut", text.substr(0, size)}});
      ASSERT_FALSE(cut.ok());
      EXPECT_EQ(cut.error().code, ErrorCode::kInvalidInput);
      EXPECT_TRUE(cut.error().place.starts_with("cut")) << cut.error().text();
    }
  }
  EXPECT_EQ(merged({{"a", "{}"}}),
            "a: this file was not written with --shard, so it cannot be merged; give only shards");
  EXPECT_NE(merged({{"a", R"({"chronormal_part": 2, "command": "compare"})"}}).find("another version"),
            std::string::npos);
  EXPECT_NE(merged({{"a", R"({"chronormal_part": 6, "command": "bake"})"}}).find("the shard is damaged"),
            std::string::npos);
  const std::string text = audit_parts(motion, {}, {}, 2)[0].text;
  EXPECT_NE(merged({{"a", edited(text, "\"audit\"", "\"bake\"")}}).find("must be compare or audit"), std::string::npos);
  EXPECT_NE(
      merged({{"a", edited(text, "\"error\":[", "\"error\":[-1.5,")}}).find("must be a whole number of at least 0"),
      std::string::npos);
}

TEST(MergeArrays, shards_of_samples_give_the_bytes_of_one_run) {
  const test::TemporaryFolder folder;
  const Motion motion = bending();
  Moments moments;
  for (int i = 0; i <= 40; ++i) moments.times.push_back(0.02 * i);
  const SampleOptions options;
  ASSERT_TRUE(write_samples(motion, options, moments, {folder / "all.npy"}).ok());
  for (const std::size_t count : {2U, 3U, 7U}) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < count; ++i) {
      parts.push_back(folder / ("part_" + std::to_string(i) + ".npy"));
      ASSERT_TRUE(write_share(motion, options, moments, {parts.back(), SampleFormat::kNpy, true}, {i, count}).ok());
    }
    std::reverse(parts.begin(), parts.end());  // parts may be in any order
    ASSERT_TRUE(merge_arrays(parts, folder / "merged.npy", true).ok());
    EXPECT_TRUE(test::read_whole(folder / "merged.npy") == test::read_whole(folder / "all.npy")) << count;
  }
  EXPECT_EQ(write_share(motion, options, moments, {folder / "p.npz", SampleFormat::kNpz, true}, {0, 2}).error().code,
            ErrorCode::kUsage);
}

TEST(MergeArrays, refuses_shards_that_do_not_make_a_whole) {
  const test::TemporaryFolder folder;
  const Motion motion = bending();
  const Moments moments{{0, 0.1, 0.2, 0.3, 0.4}, {}};
  const auto shard = [&](const std::string& name, std::size_t index, const SampleOptions& options, double scale = 1) {
    Moments scaled = moments;
    for (double& time : scaled.times) time *= scale;
    EXPECT_TRUE(write_share(motion, options, scaled, {folder / name, SampleFormat::kNpy, true}, {index, 3}).ok());
    return folder / name;
  };
  const std::string first = shard("1.npy", 0, {}), second = shard("2.npy", 1, {}), third = shard("3.npy", 2, {});
  SampleOptions by_angle;
  by_angle.weighting = Weighting::kAngle;
  const std::string other = shard("other.npy", 1, by_angle), later = shard("later.npy", 1, {}, 0.5);
  ASSERT_TRUE(write_samples(motion, {}, moments, {folder / "all.npy"}).ok());
  const auto merged_arrays = [&](const std::vector<std::string>& paths) {
    const Status status = merge_arrays(paths, folder / "merged.npy", true);
    return status ? "done" : status.error().message;
  };
  EXPECT_EQ(merged_arrays({third, first, second}), "done");
  EXPECT_EQ(merged_arrays({first, third}), "row 1 is missing; give the files of all shards");
  EXPECT_EQ(merged_arrays({second, third}), "row 0 is missing; give the files of all shards");
  EXPECT_EQ(merged_arrays({first, second}), "row 3 is missing; give the files of all shards");
  EXPECT_EQ(merged_arrays({first, second, second, third}), "row 1 is in two of the files; give each file once");
  for (const std::string& foreign : {other, later})
    EXPECT_EQ(
        merged_arrays({first, foreign, third}),
        "this shard does not belong to " + first + ", since they differ in the options; merge only shards of one run");
  EXPECT_EQ(merged_arrays({first, folder / "all.npy"}),
            "this file was not written by sample --shard, since it is (5, 80, 3) of '<f4'; give only shards");
  EXPECT_EQ(merge_arrays(std::vector{folder / "gone.npy"}, folder / "x.npy", true).error().code, ErrorCode::kFailed);
}

// A task that can be divided: `write` writes the part of a shard of a motion to a file. `merge` returns the text of
// merged files, or an error.
struct Task {
  std::string name;
  std::function<void(MotionStream& stream, const Shard& shard, const std::string& path)> write;
  std::function<Result<std::string>(const std::vector<std::string>& paths)> merge;
};

std::vector<Task> tasks(const std::string& merged_path) {
  const auto merge_texts = [](const std::vector<std::string>& paths) -> Result<std::string> {
    std::vector<Part> parts;
    for (const std::string& path : paths) parts.push_back({path, test::read_whole(path)});
    const Result<MergedParts> all = merge_parts(parts);
    return all ? Result<std::string>(all.value().json) : Result<std::string>(all.error());
  };
  const auto merge_rows = [merged_path](const std::vector<std::string>& paths) -> Result<std::string> {
    std::filesystem::remove(merged_path);
    const Status status = merge_arrays(paths, merged_path, false);
    EXPECT_EQ(std::filesystem::exists(merged_path), status.ok());
    return status ? Result<std::string>(test::read_whole(merged_path)) : Result<std::string>(status.error());
  };
  const auto write = [](const std::string& path, const std::string& text) {
    ASSERT_TRUE(write_output(path, text, true).ok());
  };
  return {{"compare",
           [write](MotionStream& stream, const Shard& shard, const std::string& path) {
             CompareOptions options;
             options.schemes = {"linear"};
             options.samples = 3;
             CompareRun run;
             run.shard = shard;
             write(path, compared_part(stream, options, run));
           },
           merge_texts},
          {"compare of vertices",
           [write](MotionStream& stream, const Shard& shard, const std::string& path) {
             CompareOptions options;
             options.schemes = {"slerp"};
             options.samples = 2;
             options.elements.kind = ElementKind::kVertices;
             CompareRun run;
             run.shard = shard;
             write(path, compared_part(stream, options, run));
           },
           merge_texts},
          {"audit",
           [write](MotionStream& stream, const Shard& shard, const std::string& path) {
             AuditOptions options;
             options.samples = 3;
             write(path, audited_part(stream, {}, options, shard));
           },
           merge_texts},
          {"sample",
           [](MotionStream& stream, const Shard& shard, const std::string& path) {
             Moments moments;
             for (int i = 0; i < 8; ++i) moments.times.push_back(0.1 * i + 0.05);
             ASSERT_TRUE(write_share(stream, {}, moments, {path, SampleFormat::kNpy, true}, shard).ok());
           },
           merge_rows},
          {"sample of faces at two times that have no keyframe in common",
           [](MotionStream& stream, const Shard& shard, const std::string& path) {
             const Moments moments{{0.05, 0.65}, {}};
             SampleOptions options;
             options.elements.kind = ElementKind::kFaces;
             const Shard half{shard.index % 2, 2};
             ASSERT_TRUE(write_share(stream, options, moments, {path, SampleFormat::kNpy, true}, half).ok());
           },
           [merge_rows](const std::vector<std::string>& paths) {
             return merge_rows(
                 {paths.begin(), paths.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, paths.size()))});
           }}};
}

// Writes the part of a shard. The motion is in memory if is_kept, and otherwise a stream that keeps only keyframes in
// use.
void write_part(const Task& task, const Motion& motion, bool is_kept, const Shard& shard, const std::string& path) {
  MotionStream whole(motion);
  if (is_kept) return task.write(whole, shard, path);
  std::size_t most_held = 0;
  MotionStream stream = test::strict(whole, most_held);
  task.write(stream, shard, path);
}

TEST(Parts, no_damage_gives_other_bytes) {
  constexpr unsigned kSeed = 49;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const test::TemporaryFolder folder;
  const Motion motion = bending();
  for (const Task& task : tasks(folder / "merged")) {
    SCOPED_TRACE(task.name);
    const std::vector<std::string> paths = {folder / "0", folder / "1"};
    for (std::size_t i = 0; i < 2; ++i) write_part(task, motion, true, {i, 2}, paths[i]);
    const Result<std::string> whole = task.merge(paths);
    ASSERT_TRUE(whole.ok()) << whole.error().text();
    const std::string part = test::read_whole(paths[1]);
    const auto try_damaged = [&](std::string damaged, const std::string& what) {
      if (damaged == part) return;
      ASSERT_TRUE(write_output(paths[1], damaged, true).ok());
      const Result<std::string> merged = task.merge(paths);
      EXPECT_FALSE(merged.ok()) << what;
    };
    // Changes every byte near the start and the end of the file, where the part describes itself, and some of the other
    // bytes.
    for (std::size_t at = 0; at < part.size(); at += at < 128 || at + 128 > part.size() ? 1 : 1 + random() % 97) {
      std::string damaged = part;
      damaged[at] = static_cast<char>(random());
      try_damaged(damaged, "byte " + std::to_string(at));
    }
    for (int i = 0; i < 40; ++i) {
      const std::size_t at = random() % part.size(), count = 1 + random() % 100;
      std::string more(count, '\0');
      for (char& c : more) c = static_cast<char>(random());
      try_damaged(part.substr(0, at), "cut at " + std::to_string(at));
      try_damaged(part + (i == 0 ? "\n" : more), "extended");
      try_damaged(std::string(part).insert(at, more), "inserted at " + std::to_string(at));
      try_damaged(std::string(part).erase(at, count), "removed at " + std::to_string(at));
    }
  }
}

// A random keyframe changes between two shards. The number of shards is random, too. If the motion is in memory, every
// shard sees all keyframes. Otherwise, a change can be noticed only in keyframes that two shards read.
TEST(Parts, of_a_keyframe_that_changed_between_the_shards_do_not_belong_together) {
  constexpr unsigned kSeed = 20261126;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const test::TemporaryFolder folder;
  for (const Task& task : tasks(folder / "merged")) {
    for (int round = 0; round < 12; ++round) {
      const bool is_kept = round % 2 == 0;
      const std::size_t count = 2 + random() % 3, later = 1 + random() % (count - 1);
      const Motion before = bending();
      Motion after = before;
      // If the shards read streams, changes a keyframe that two shards read: the first keyframe of the later shard,
      // keyframe 0, or the last keyframe.
      const std::size_t boundary = Shard{later, count}.of(8).first;
      const std::size_t changed = is_kept ? random() % 9 : std::vector<std::size_t>{0, boundary, 8}[random() % 3];
      std::vector<float>& positions = after.keyframes[changed].positions;
      float& coordinate = positions[6 + random() % (positions.size() - 6)];  // the first two vertices rest
      coordinate = std::nextafter(coordinate, 2.0F);
      std::vector<std::string> paths;
      for (std::size_t i = 0; i < count; ++i) {
        paths.push_back(folder / std::to_string(i));
        write_part(task, i < later ? before : after, is_kept, {i, count}, paths.back());
      }
      const bool is_of_two = task.name.find("two times") != std::string::npos;
      if (is_of_two && (later != 1 || (!is_kept && changed == boundary))) continue;
      const Result<std::string> merged = task.merge(paths);
      ASSERT_FALSE(merged.ok()) << task.name << ", keyframe " << changed << ", " << is_kept;
      EXPECT_EQ(merged.error().code, ErrorCode::kUsage);
      const std::string text = merged.error().text();
      EXPECT_TRUE(text.starts_with(paths[later] + ": this shard does not belong to " + folder.path()))
          << task.name << text;
      EXPECT_TRUE(text.ends_with(", since they differ in keyframe " + std::to_string(changed) +
                                 "; merge only shards of one run"))
          << task.name << text;
    }
  }
}

TEST(Parts, of_two_sequences_with_the_same_faces_and_times_do_not_belong_together) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const test::TemporaryFolder folder;
  const Motion one = bending();
  Motion other = one;
  for (Motion::Keyframe& keyframe : other.keyframes)
    for (float& coordinate : keyframe.positions) coordinate += static_cast<float>(random() % 1000) * 0.001F;
  for (const Task& task : tasks(folder / "merged")) {
    for (const bool is_kept : {true, false}) {
      const std::vector<std::string> paths = {folder / "0", folder / "1"};
      for (const std::size_t from_other : {0U, 1U}) {
        for (std::size_t i = 0; i < 2; ++i) write_part(task, i == from_other ? other : one, is_kept, {i, 2}, paths[i]);
        const Result<std::string> merged = task.merge(paths);
        ASSERT_FALSE(merged.ok()) << task.name;
        EXPECT_TRUE(merged.error().text().starts_with(paths[1] + ": this shard does not belong to " + paths[0]))
            << task.name;
      }
    }
  }
}

// An audit reads keyframes in two passes. In this test, one keyframe changes between the passes.
TEST(Parts, are_not_written_of_a_keyframe_that_changes_while_it_is_read) {
  const Motion motion = bending();
  std::vector<int> reads(9);
  Motion outline = motion;
  for (Motion::Keyframe& keyframe : outline.keyframes) keyframe.positions.clear();
  MotionStream stream(
      outline,
      [&](const Motion&, std::size_t k, std::span<float> positions) -> Status {
        std::copy(motion.keyframes[k].positions.begin(), motion.keyframes[k].positions.end(), positions.begin());
        if (++reads[k] > 1 && k == 5) positions[0] += 1;
        return Success{};
      },
      0);
  EXPECT_EQ(audited_part(stream, {}, {}, Shard{1, 2}),
            "keyframe 5 has changed while it was read; run the command again");
}

}  // namespace
}  // namespace chronormal::parts_test
