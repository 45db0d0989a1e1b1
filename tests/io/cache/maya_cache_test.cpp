#include "io/cache/maya_cache.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/support/cache_bytes.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::maya_cache_test {
namespace {

using std::string_literals::operator""s;

void expect_turning(const Result<PositionCache>& cache) {
  ASSERT_TRUE(cache.ok()) << cache.error().text();
  EXPECT_EQ(cache.value().vertex_count, 3U);
  ASSERT_EQ(cache.value().samples.size(), 2U);
  EXPECT_EQ(cache.value().samples[0].time, 250.0 / 6000);
  EXPECT_EQ(cache.value().samples[1].time, 375.0 / 6000);
  EXPECT_EQ(cache.value().samples[0].positions, test::kTurning[0]);
  EXPECT_EQ(cache.value().samples[1].positions, test::kTurning[1]);
}

// Makes a cache file for one point in time. The groups of the file have no tag TIME, since the header has the time.
std::string frame_bytes(bool wide, std::int32_t ticks, const std::vector<float>& positions) {
  const test::MayaWriter writer(wide);
  return writer.header(ticks) + writer.group("MYCH", writer.points<float>("body", positions));
}

template <class T>
std::string error_text(const Result<T>& result) {
  EXPECT_FALSE(result.ok());
  return result ? "" : result.error().text();
}

TEST(ReadMayaPoints, reads_float_and_double_with_both_sizes_of_chunks) {
  for (const bool wide : {false, true}) {
    expect_turning(read_maya_points(test::small_maya<float>(wide), "a.mc", {1, 3, ""}));
    expect_turning(read_maya_points(test::small_maya<double>(wide), "a.mc", {1, 3, ""}));
    expect_turning(read_maya_points(test::small_maya<double>(wide), "a.mc", {1, 0, "body"}));
  }
}

TEST(ReadMayaPoints, a_channel_must_be_the_only_one_that_can_be_meant) {
  const std::string bytes = test::small_maya<float>(false);
  EXPECT_EQ(error_text(read_maya_points(bytes, "a.mc")),
            "a.mc, channels: several channels fit the mesh, 'body' (3), 'other' (1); name one of them, as in "
            "cache.xml#'body'");
  EXPECT_EQ(error_text(read_maya_points(bytes, "a.mc", {1, 4, ""})),
            "a.mc, channels: no channel has the 4 points of the mesh, only 'body' (3), 'other' (1); give the mesh that "
            "the cache was made for");
  EXPECT_EQ(error_text(read_maya_points(bytes, "a.mc", {1, 3, "head"})),
            "a.mc, channels: the cache has no channel 'head'; choose one of 'body' (3), 'other' (1)");
  EXPECT_EQ(error_text(read_maya_points(test::MayaWriter(false).header(0), "a.mc")),
            "a.mc, channels: the cache has no points; export it again");
}

TEST(ReadMayaPoints, errors_say_where_and_what) {
  const test::MayaWriter writer(false);
  const auto error_with = [&](const std::string& chunks, const std::string& header) {
    return error_text(read_maya_points(header + writer.group("MYCH", chunks), "a.mc"));
  };
  EXPECT_EQ(error_text(read_maya_points("FOR5", "a.mc")),
            "a.mc, byte 0: this is not a Maya cache, since it begins neither with FOR4 nor with FOR8; name a .mc or "
            ".mcx file");
  EXPECT_EQ(error_with(writer.chunk("FVCA", ""), writer.header(0)),
            "a.mc, byte 60: the cache is damaged, since these points have no channel name (CHNM) or no size (SIZE); "
            "export the cache again");
  EXPECT_EQ(
      error_with(writer.points<float>("a", {1, 2, 3}), ""),
      "a.mc, byte 36: the points have no time, since neither TIME nor STIM comes before them; export the cache again");
  EXPECT_EQ(
      error_with(writer.chunk("CHNM", "a") + writer.integer("SIZE", -1) + writer.chunk("FVCA", ""), writer.header(0)),
      "a.mc, byte 84: the number of points of the channel 'a' is -1, which does not fit its 0 bytes; export the cache "
      "again");
  EXPECT_EQ(
      error_with(writer.chunk("CHNM", "a") + writer.integer("SIZE", 1) + writer.chunk("DVCA", std::string(12, 'x')),
                 writer.header(0)),
      "a.mc, byte 84: the number of points of the channel 'a' is 1, which does not fit its 12 bytes; export the cache "
      "again");
  EXPECT_EQ(error_with(writer.chunk("TIME", "12345"), ""),
            "a.mc, byte 20: the chunk 'TIME' must have 4 bytes; export the cache again");
  EXPECT_EQ(error_with(writer.points<double>("a", {1, 2, 3}) + writer.chunk("CHNM", "a") + writer.integer("SIZE", 1) +
                           writer.chunk("DVCA", test::raw<double>({1, 1e39, 1}, true)),
                       writer.header(0)),
            "a.mc, byte 156, channel 'a', point 0: the coordinate is too large for float32; scale the mesh down");
  EXPECT_EQ(error_with(writer.points<float>("a", {1, 2, 3}) + writer.points<float>("a", {1, 2, 3, 4, 5, 6}),
                       writer.header(0)),
            "a.mc, byte 136: the channel 'a' has 2 points here, but 1 in earlier samples; export the cache again");
  EXPECT_EQ(error_with(writer.points<float>("a", {}), writer.header(0)),
            "a.mc, byte 92: the channel 'a' has no points; export the cache again");
  std::string bytes = test::small_maya<float>(true);
  bytes.replace(8, 8, "\x7F\xFF\xFF\xFF\xFF\xFF\xFF\xFF");
  EXPECT_NE(
      error_text(read_maya_points(bytes, "a.mc")).find("the chunk 'FOR8' should have 9,223,372,036,854,775,807 bytes"),
      std::string::npos);
}

TEST(ReadMayaDescription, reads_what_matters_and_passes_over_the_rest) {
  const Result<MayaCacheDescription> result =
      read_maya_description(test::maya_xml("OneFilePerFrame", "mcx", 125, -250, 500), "c.xml");
  ASSERT_TRUE(result.ok()) << result.error().text();
  EXPECT_TRUE(result.value().has_file_per_frame);
  EXPECT_EQ(result.value().extension, ".mcx");
  EXPECT_EQ(result.value().ticks_per_frame, 250);
  ASSERT_EQ(result.value().channels.size(), 2U);
  EXPECT_EQ(result.value().channels[1].name, "body");
  EXPECT_EQ(result.value().channels[1].interpretation, "positions");
  EXPECT_TRUE(result.value().channels[1].is_regular);
  EXPECT_EQ(result.value().channels[1].step, 125);
  EXPECT_EQ(result.value().channels[1].start, -250);
  EXPECT_EQ(result.value().channels[1].end, 500);
}

TEST(ReadMayaDescription, errors_say_where_and_what) {
  const auto error_with = [](const std::string& from, const std::string& to) {
    std::string xml = test::maya_xml("OneFile", "mcc", 125, 250, 375);
    xml.replace(xml.find(from), from.size(), to);
    return error_text(read_maya_description(xml, "c.xml"));
  };
  EXPECT_NE(error_with("Autodesk_Cache_File", "x").find("c.xml, byte "), std::string::npos);
  EXPECT_EQ(error_text(read_maya_description("<a/>", "c.xml")),
            "c.xml, byte 0: this is not the description of a Maya cache, since it has no element Autodesk_Cache_File; "
            "name the .xml file that Maya wrote");
  EXPECT_NE(error_with("OneFile", "TwoFiles").find("Type of cacheType is 'TwoFiles'"), std::string::npos);
  EXPECT_NE(error_with("mcc", "abc").find("Format of cacheType is 'abc'"), std::string::npos);
  EXPECT_NE(error_with("\"250\"", "\"0\"").find("TimePerFrame must be greater than 0; export the cache again"),
            std::string::npos);
  EXPECT_NE(error_with("\"125\"", "\"4294967296\"").find("SamplingRate: '4294967296' is too large"), std::string::npos);
  EXPECT_NE(error_with("\"125\"", "\"-1\"").find("a SamplingRate greater than 0"), std::string::npos);
  EXPECT_NE(error_with("\"375\"", "\"249\"").find("a StartTime not later than its EndTime; export the cache again"),
            std::string::npos);
  EXPECT_EQ(error_text(read_maya_description(std::string((std::size_t{1} << 24) + 1, ' '), "c.xml")),
            "c.xml, byte 16777216: the description of the Maya cache is larger than 16 MiB; export the cache again");
}

TEST(ReadMayaCache, reads_one_file) {
  const test::TemporaryFolder folder;
  for (const bool wide : {false, true}) {
    folder.write(wide ? "c.mcx" : "c.mc", test::small_maya<float>(wide));
    folder.write("c.xml", test::maya_xml("OneFile", wide ? "mcx" : "mcc", 125, 250, 375));
    expect_turning(read_maya_cache(folder / "c.xml", {1, 3, ""}));
  }
}

TEST(ReadMayaCache, reads_a_file_per_frame_in_the_order_of_time_and_no_other_file) {
  const test::TemporaryFolder folder;
  folder.write("c.xml", test::maya_xml("OneFilePerFrame", "mcx", 2125, 250, 2375));
  folder.write("cFrame1.mcx", frame_bytes(true, 250, test::kTurning[0]));
  folder.write("cFrame9Tick125.mcx", frame_bytes(true, 2375, test::kTurning[1]));
  for (const char* const other : {"cFrame2.mc", "bcFrame2.mcx", "cFrameX.mcx", "cFrame2Tick.mcx", "cFrame2Tick1x.mcx",
                                  "cFrame.mcx", "c.mcx", "cFrame3.mcx.bak"})
    folder.write(other, "not a cache");
  const Result<PositionCache> cache = read_maya_cache(folder / "c.xml", {1, 3, ""});
  ASSERT_TRUE(cache.ok()) << cache.error().text();
  ASSERT_EQ(cache.value().samples.size(), 2U);
  EXPECT_EQ(cache.value().samples[1].time, 2375.0 / 6000);
  EXPECT_EQ(cache.value().samples[1].positions, test::kTurning[1]);

  // In alphabetical order, cFrame10 comes before cFrame9, although frame 10 comes after frame 9.
  folder.write("c.xml", test::maya_xml("OneFilePerFrame", "mcx", 125, 2375, 2500));
  std::filesystem::rename(folder / "cFrame1.mcx", folder / "cFrame10.mcx");
  folder.write("cFrame10.mcx", frame_bytes(true, 2500, test::kTurning[0]));
  const Result<PositionCache> sorted = read_maya_cache(folder / "c.xml", {1, 3, ""});
  ASSERT_TRUE(sorted.ok()) << sorted.error().text();
  EXPECT_EQ(sorted.value().samples.at(0).positions, test::kTurning[1]);
}

TEST(ReadMayaCache, a_missing_sample_is_an_error_that_names_its_file) {
  const test::TemporaryFolder folder;
  folder.write("c.xml", test::maya_xml("OneFilePerFrame", "mcc", 125, -250, 0));
  EXPECT_EQ(error_text(read_maya_cache(folder / "c.xml")),
            "c.xml: the files of the cache are missing; they should be in the same folder, named like cFrame0.mc");
  folder.write("cFrame-1.mc", frame_bytes(false, -250, test::kTurning[0]));
  folder.write("cFrame0.mc", frame_bytes(false, 0, test::kTurning[1]));
  EXPECT_EQ(error_text(read_maya_cache(folder / "c.xml")),
            "c.xml: the sample at tick -125 is missing in the cache; copy its file into the folder of the .xml file; "
            "its name should be cFrame-1Tick125.mc");
  folder.write("cFrame-1Tick125.mc", frame_bytes(false, -125, test::kTurning[0]));
  EXPECT_TRUE(read_maya_cache(folder / "c.xml").ok());
  folder.write("c.xml", test::maya_xml("OneFile", "mcc", 125, 250, 500));
  folder.write("c.mc", test::small_maya<float>(false));
  EXPECT_EQ(error_text(read_maya_cache(folder / "c.xml", {1, 3, ""})),
            "c.xml: the sample at tick 500 is missing in the cache");
}

TEST(ReadMayaCache, among_channels_of_the_same_size_the_interpretation_decides) {
  const test::TemporaryFolder folder;
  const test::MayaWriter writer(false);
  std::string bytes = writer.header(0);
  for (int k = 0; k < 2; ++k)
    bytes += writer.group("MYCH", writer.integer("TIME", 250 + 125 * k) +
                                      writer.points<float>("other", test::kTurning[1 - k]) +
                                      writer.points<float>("body", test::kTurning[k]));
  folder.write("c.mc", bytes);
  std::string xml = test::maya_xml("OneFile", "mcc", 125, 250, 375);
  folder.write("c.xml", xml);
  EXPECT_NE(error_text(read_maya_cache(folder / "c.xml", {1, 3, ""})).find("several channels"), std::string::npos);
  xml.replace(xml.find("\"positions\""), 11, "\"velocity\"");
  folder.write("c.xml", xml);
  expect_turning(read_maya_cache(folder / "c.xml", {1, 3, ""}));
}

TEST(ReadMayaCache, files_that_are_not_there_are_named) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_maya_cache(folder / "c.xml").error().code, ErrorCode::kFailed);
  folder.write("c.xml", test::maya_xml("OneFile", "mcc", 125, 250, 375));
  const Result<PositionCache> cache = read_maya_cache(folder / "c.xml");
  ASSERT_FALSE(cache.ok());
  EXPECT_EQ(cache.error().code, ErrorCode::kFailed);
  EXPECT_EQ(cache.error().place, folder / "c.mc");
}

TEST(ReadMayaCache, files_for_each_frame_are_not_found_in_memory) {
  const std::string xml = test::maya_xml("OneFilePerFrame", "mcx", 125, 250, 375);
  const Result<PositionCache> cache =
      read_maya_cache("c.xml", {1, 3, ""}, [&xml](const std::string&) { return Result<std::string_view>(xml); });
  ASSERT_FALSE(cache.ok());
  EXPECT_EQ(cache.error().code, ErrorCode::kUsage);
  EXPECT_EQ(cache.error().text(),
            "c.xml: the cache has a file for each frame, and such files can only be found in a folder on disk; give "
            "the path of the .xml file in that folder");
}

}  // namespace
}  // namespace chronormal::maya_cache_test
