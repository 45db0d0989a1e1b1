// Tests where edited files can be written (containers, folders, streams), and what happens if writing fails.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "fuzz/json_tokens.h"
#include "tests/support/glb_parts.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::gltf_edit_files_test {
namespace {

using test::base64;
using test::bytes_of;
using test::bytes_or_error;
using test::GlbParts;
using test::GltfBuilder;
using test::GltfFixture;
using test::kLift;
using test::read_whole;
using test::take_apart;
using test::TemporaryFolder;
using Json = nlohmann::json;

// Makes a document with a triangle that has one target. The positions and the deltas are in two buffers with one view
// each. Some bytes of the second buffer are unused.
GltfBuilder two_buffers(const std::string& first, const std::string& second) {
  GltfBuilder builder;
  builder.json["buffers"] = {{{"byteLength", 36}, {"name", "one"}, {"extras", "\xC3\xA9"}}, {{"byteLength", 41}}};
  if (!first.empty()) builder.json["buffers"][0]["uri"] = first;
  builder.json["buffers"][1]["uri"] = second;
  builder.add("bufferViews", {{"buffer", 0}, {"byteLength", 36}});
  builder.add("bufferViews", {{"buffer", 1}, {"byteOffset", 4}, {"byteLength", 36}});
  const auto a = builder.add_accessor_over(0, "VEC3", 5126, 3), b = builder.add_accessor_over(1, "VEC3", 5126, 3);
  builder.add_mesh(GltfBuilder::primitive(a, std::nullopt, {{{"POSITION", b}}}));
  return builder;
}
const std::vector<float> kFirst = {0, 0, 0, 1, 0, 0, 0, 1, 0}, kSecond = {1, 2, 3, 4, 5, 6, 7, 8, 9};
std::string first_bytes() { return bytes_of(kFirst); }
std::string second_bytes() { return "skip" + bytes_of(kSecond) + "x"; }
std::string as_data(const std::string& bytes) { return "data:application/octet-stream;base64," + base64(bytes); }

// Opens a file and compares its arrays with the arrays of two_buffers(). If with_third, the file must also have a third
// array.
void expect_arrays(const std::string& path, bool with_third) {
  const Result<GltfDocument> document = GltfDocument::open(path);
  ASSERT_TRUE(document.ok()) << document.error().text();
  const auto geometry = document.value().geometry(0, 0, {.shading = true});
  ASSERT_TRUE(geometry.ok()) << geometry.error().text();
  EXPECT_EQ(geometry.value().positions, kFirst);
  EXPECT_EQ(geometry.value().targets[0].positions, kSecond);
  if (with_third) {
    EXPECT_EQ(geometry.value().targets[0].normals, kSecond);
  }
}

TEST(GltfEditFiles, any_container_and_folder_gives_the_same_arrays) {
  const TemporaryFolder folder, elsewhere;
  folder.write("a b.bin", first_bytes());
  folder.write("b.bin", second_bytes() + "more");
  std::string glb_json = two_buffers("", "b.bin").json.dump();
  const std::vector<std::pair<std::string, std::string>> sources = {
      {"files.gltf", two_buffers("a%20b.bin", "b.bin").json.dump()},
      {"data.gltf", two_buffers(as_data(first_bytes()), as_data(second_bytes())).json.dump()},
      {"mixed.glb", test::glb_bytes(glb_json, first_bytes())},
      {"unused_bin.glb", test::glb_bytes(two_buffers("a%20b.bin", "b.bin").json.dump(), "junk")},
      {"no_bin.glb", test::glb_bytes(two_buffers(as_data(first_bytes()), "b.bin").json.dump(), std::nullopt)},
  };
  for (const auto& [name, bytes] : sources) {
    const Result<GltfDocument> document = GltfDocument::open(folder.write(name, bytes));
    ASSERT_TRUE(document.ok()) << name << document.error().text();
    for (const bool with_third : {false, true}) {
      for (const std::string& path :
           {folder / "out.glb", folder / "out.gltf", elsewhere / "out.glb", elsewhere / "out.GLTF"}) {
        SCOPED_TRACE(name + " to " + path);
        GltfEdit edit(document.value());
        if (with_third) {
          edit.set("/meshes/0/primitives/0/attributes/NORMAL", std::to_string(edit.add_vectors(kFirst)));
          edit.set("/meshes/0/primitives/0/targets/0/NORMAL", std::to_string(edit.add_vectors(kSecond)));
        }
        const Status status = edit.write(path, true);
        ASSERT_TRUE(status.ok()) << status.error().text();
        expect_arrays(path, with_third);
        const std::string written = read_whole(path);
        EXPECT_EQ(bytes_or_error(edit, path), written);
        EXPECT_EQ(written.starts_with("glTF"), path.ends_with(".glb"));
        const std::string text = written.starts_with("glTF") ? take_apart(written).json : written;
        const Json json = Json::parse(text);
        EXPECT_EQ(json["buffers"][0]["name"], "one");
        EXPECT_EQ(json["buffers"][0]["extras"], "\xC3\xA9");
        if (path.starts_with(elsewhere.path())) {
          EXPECT_EQ(text.find(".bin"), std::string::npos) << "a reference that leads nowhere";
        }
        if (bytes.starts_with("glTF") && written.starts_with("glTF")) {
          EXPECT_TRUE(take_apart(written).bin.starts_with(take_apart(bytes).bin));
        }
        const std::string before = bytes.starts_with("glTF") ? take_apart(bytes).json : bytes;
        EXPECT_EQ(
            fuzz::difference_beside(fuzz::JsonTokens(before.substr(0, before.rfind('}') + 1)),
                                    fuzz::JsonTokens(text.substr(0, text.rfind('}') + 1)), edit.pointers(path).value()),
            "");
      }
    }
  }
}

TEST(GltfEditFiles, compressed_views_move_and_their_fallback_stays) {
  GltfBuilder builder;
  builder.json["buffers"] = {{{"byteLength", 96}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}},
                             {{"byteLength", 5}, {"uri", as_data("12345")}},
                             {{"byteLength", 8}, {"uri", as_data("compress")}}};
  builder.add("bufferViews", {{"buffer", 0},
                              {"byteLength", 96},
                              {"extensions",
                               {{"EXT_meshopt_compression",
                                 {{"buffer", 2},
                                  {"byteOffset", 1},
                                  {"byteLength", 6},
                                  {"byteStride", 4},
                                  {"mode", "ATTRIBUTES"},
                                  {"count", 24}}},
                                {"VENDOR_other", {{"buffer", 77}}}}}});
  builder.add("bufferViews", {{"buffer", 1}, {"byteLength", 5}});
  const GltfFixture fixture(builder.gltf(), "/");
  ASSERT_TRUE(fixture.ok()) << fixture.error();
  const GltfEdit edit(*fixture);
  const std::string bytes = bytes_or_error(edit, "/tmp/x.glb");
  ASSERT_EQ(GltfFixture(bytes).error(), "");
  const auto [json, bin, rest] = take_apart(bytes);
  const Json result = Json::parse(json);
  EXPECT_EQ(result["buffers"], Json::parse(R"([{"byteLength":16},
      {"byteLength":96,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}])"));
  EXPECT_EQ(bin, std::string("12345\0\0\0compress", 16));
  const Json& view = result["bufferViews"][0];
  EXPECT_EQ(view["buffer"], 1);
  EXPECT_EQ(view["extensions"]["EXT_meshopt_compression"]["buffer"], 0);
  EXPECT_EQ(view["extensions"]["EXT_meshopt_compression"]["byteOffset"], 9);
  EXPECT_EQ(view["extensions"]["VENDOR_other"]["buffer"], 77);
  EXPECT_EQ(result["bufferViews"][1], Json::parse(R"({"buffer":0,"byteLength":5})"));
}

TEST(GltfEditFiles, images_beside_the_source_are_taken_along) {
  const TemporaryFolder folder, elsewhere;
  const std::string png = "\x89PNG\r\n\x1A\n...", jpeg = "\xFF\xD8\xFF\xE0", webp = "RIFF????WEBPVP8 ",
                    ktx = "\xABKTX 20\xBB\r\n\x1A\n!";
  folder.write("a b.png", png);
  folder.write("b.jpg", jpeg);
  folder.write("c.webp", webp);
  folder.write("d.ktx2", ktx);
  GltfBuilder builder = test::quad_document();
  builder.json["images"] = {{{"uri", "a%20b.png"}, {"name", "n"}, {"extras", {1, 2}}},
                            {{"uri", "b.jpg"}, {"mimeType", "image/jpeg"}},
                            {{"uri", "c.webp"}},
                            {{"uri", "data:image/png;base64," + base64(png)}},
                            {{"uri", "d.ktx2"}},
                            {{"uri", "missing.png"}},
                            {{"uri", "https://example.org/x.png"}}};
  const Result<GltfDocument> document = GltfDocument::open(folder.write("in.gltf", builder.gltf()));
  ASSERT_TRUE(document.ok()) << document.error().text();
  GltfEdit edit(document.value());
  (void)edit.add_vectors(kLift);

  const std::string bytes = bytes_or_error(edit, folder / "out.glb");
  ASSERT_EQ(GltfFixture(bytes).error(), "");
  const GlbParts parts = take_apart(bytes);
  const Json json = Json::parse(parts.json), before = builder.json["images"];
  EXPECT_EQ(json["images"][0], Json::parse(R"({"bufferView":5,"mimeType":"image/png","name":"n","extras":[1,2]})"));
  EXPECT_EQ(json["images"][1], Json::parse(R"({"bufferView":6,"mimeType":"image/jpeg"})"));
  EXPECT_EQ(json["images"][2], Json::parse(R"({"bufferView":7,"mimeType":"image/webp"})"));
  EXPECT_EQ(json["images"][4], Json::parse(R"({"bufferView":8,"mimeType":"image/ktx2"})"));
  for (const std::size_t i : {3U, 5U, 6U}) EXPECT_EQ(json["images"][i], before[i]);
  const std::vector<std::string> contents = {png, jpeg, webp, ktx};
  for (std::size_t i = 0; i < 4; ++i) {
    const Json& view = json["bufferViews"][5 + i];
    EXPECT_EQ(parts.bin.substr(view["byteOffset"], view["byteLength"]), contents[i]);
  }
  const std::vector<std::string> warnings = edit.warnings(folder / "out.glb");
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_TRUE(warnings[0].starts_with("in.gltf, /images/5/uri: this file is missing: ")) << warnings[0];
  EXPECT_TRUE(warnings[1].starts_with("in.gltf, /images/6/uri: ")) << warnings[1];

  const Json gltf = Json::parse(bytes_or_error(edit, elsewhere / "out.gltf"));
  EXPECT_EQ(gltf["images"][0]["uri"], "data:image/png;base64," + base64(png));
  EXPECT_EQ(gltf["images"][5], before[5]);
  EXPECT_EQ(Json::parse(bytes_or_error(edit, folder / "out.gltf"))["images"], before);

  folder.write("c.webp", "no image");
  EXPECT_EQ(bytes_or_error(edit, folder / "out.glb"),
            "in.gltf, /images/2/uri: the image is not PNG, JPEG, WebP or KTX2, so it cannot be embedded; write a .gltf "
            "file beside the input");
  EXPECT_EQ(bytes_or_error(edit, elsewhere / "out.gltf"),
            "in.gltf, /images/2/uri: the image is not PNG, JPEG, WebP or KTX2, so it cannot be embedded; write the "
            "result beside the input");
  EXPECT_TRUE(Json::parse(bytes_or_error(edit, folder / "out.gltf")).is_object()) << "beside the input it is not moved";
}

TEST(GltfEditFiles, an_image_that_a_change_took_away_is_not_taken_along) {
  const TemporaryFolder folder;
  folder.write("a.png", "\x89PNG\r\n\x1A\n...");
  GltfBuilder builder = test::quad_document();
  builder.json["images"] = {{{"uri", "a.png"}}};
  const Result<GltfDocument> document = GltfDocument::open(folder.write("in.gltf", builder.gltf()));
  ASSERT_TRUE(document.ok()) << document.error().text();
  GltfEdit edit(document.value());
  edit.set("/images", "[]");
  EXPECT_EQ(bytes_or_error(edit, folder / "out.glb"),
            "in.gltf, /images/0: the array has 0 items, and no item 0; point to an item that exists");
}

TEST(GltfEditFiles, path_that_names_no_gltf_file_is_refused) {
  const GltfFixture fixture(test::quad_document());
  const GltfEdit edit(*fixture);
  const TemporaryFolder folder;
  for (const char* const name : {"a.obj", "glb", "a.glb.bak"}) {
    const Status status = edit.write(folder / name, false);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().code, ErrorCode::kUsage);
    EXPECT_EQ(status.error().text(), folder / name + ": the name of a glTF file must end with .glb, .gltf or .vrm");
  }
  EXPECT_EQ(folder.entry_count(), 0U);
}

TEST(GltfEditFiles, stream_gets_the_container_of_the_source_with_all_that_belongs_to_it) {
  const TemporaryFolder folder;
  folder.write("a.bin", first_bytes());
  folder.write("b.bin", second_bytes());
  for (const bool glb : {false, true}) {
    const std::string json = two_buffers(glb ? "" : "a.bin", "b.bin").json.dump();
    const std::string source = glb ? test::glb_bytes(json, first_bytes()) : json;
    const GltfFixture fixture(source, folder.path());
    const std::string bytes = bytes_or_error(GltfEdit(*fixture), "-");
    EXPECT_EQ(bytes.starts_with("glTF"), glb);
    EXPECT_EQ(bytes.find(".bin"), std::string::npos);
    const TemporaryFolder elsewhere;
    expect_arrays(elsewhere.write("x", bytes), false);
    EXPECT_TRUE(GltfEdit(*fixture).write("/dev/null", false).ok());
  }
}

TEST(GltfEditFiles, buffer_outside_the_folder_is_not_taken_along_unless_allowed) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "in");
  folder.write("a.bin", first_bytes());
  folder.write("b.bin", second_bytes());
  const std::string path = folder.write("in/x.gltf", two_buffers("../a.bin", "../b.bin").json.dump());
  const Result<GltfDocument> refused = GltfDocument::open(path);
  ASSERT_TRUE(refused.ok());
  EXPECT_EQ(bytes_or_error(GltfEdit(refused.value()), folder / "in/y.glb"),
            "x.gltf, /buffers/0/uri: the uri leads out of the folder of the glTF file, which is refused for safety; if "
            "you trust the file, add --allow-external");
  GltfOptions options;
  options.allow_external = true;
  const Result<GltfDocument> allowed = GltfDocument::open(path, options);
  ASSERT_TRUE(allowed.ok());
  EXPECT_TRUE(GltfEdit(allowed.value()).write(folder / "in/y.glb", false).ok());
  expect_arrays(folder / "in/y.glb", false);
}

TEST(GltfEditFiles, more_than_a_glb_can_hold_is_refused) {
  const TemporaryFolder folder;
  constexpr std::uintmax_t kSize = 4294967296;
  folder.write("b.bin", std::string(static_cast<std::size_t>(kSize / 99), '\0'));
  std::error_code error;
  std::filesystem::resize_file(folder / "b.bin", kSize, error);  // extends the file by a hole
  if (error) GTEST_SKIP() << "the file system has no files of 4 GiB: " << error.message();
  GltfBuilder builder;
  builder.json["buffers"] = {{{"byteLength", kSize}, {"uri", "b.bin"}}};
  const Result<GltfDocument> document = GltfDocument::open(folder.write("a.gltf", builder.json.dump()));
  ASSERT_TRUE(document.ok()) << document.error().text();
  const Status status = GltfEdit(document.value()).write(folder / "a.glb", false);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidInput);
  EXPECT_TRUE(status.error().text().starts_with(folder / "a.glb: the result would have 4,294,967"))
      << status.error().text();
  EXPECT_EQ(folder.entry_count(), 2U);
}

TEST(GltfEditFiles, failed_write_leaves_the_old_file_and_no_temporary) {
  const TemporaryFolder folder;
  const std::string source = test::quad_document().glb(), path = folder.write("a.glb", source);
  const Result<GltfDocument> document = GltfDocument::open(path);
  ASSERT_TRUE(document.ok());
  GltfEdit edit(document.value());
  std::vector<float> many(300000);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<float>(i);
  (void)edit.add_vectors(many);

  EXPECT_EQ(edit.write(path, false).error().text(), path + ": the file exists already; add --force to overwrite it");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{100000, before.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status full = edit.write(path, true);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(full.error().text(), path + ": File too large");
  if (std::filesystem::exists("/dev/full")) {
    EXPECT_EQ(edit.write("/dev/full", false).error().text(), "/dev/full: No space left on device");
  }
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  if (::geteuid() != 0) {
    EXPECT_FALSE(edit.write(path, true).ok());
  }
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_FALSE(edit.write(folder / "none/b.glb", true).ok());
  EXPECT_TRUE(read_whole(path) == source);
  EXPECT_EQ(folder.entry_count(), 1U);

  // The program still has the source file mapped into memory while it replaces this file.
  const std::string expected = bytes_or_error(edit, path);
  ASSERT_TRUE(edit.write(path, true).ok());
  EXPECT_TRUE(read_whole(path) == expected);
  EXPECT_EQ(folder.entry_count(), 1U);
}

}  // namespace
}  // namespace chronormal::gltf_edit_files_test
