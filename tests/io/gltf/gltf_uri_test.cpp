// Tests from which places (URIs and paths) the reader loads the buffers of an untrusted model.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "tests/support/child_process.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::gltf_uri_test {
namespace {

namespace fs = std::filesystem;
using test::GltfBuilder, test::GltfFixture;

// A fixture that makes a folder outside/asset/ with the files of a model, links and a pipe, and a file
// outside/secret.bin, which must not be read.
class GltfUris : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(asset_ + "/inner");
    (void)folder_.write("secret.bin", builder_.buffer);
    (void)folder_.write("asset/own.bin", builder_.buffer);
    (void)folder_.write("asset/inner/own.bin", builder_.buffer);
    (void)folder_.write("asset/short.bin", "abc");
    (void)folder_.write("asset/empty.bin", "");
    fs::create_directories(folder_ / "asset_too");
    (void)folder_.write("asset_too/own.bin", builder_.buffer);
    fs::create_symlink("../secret.bin", asset_ + "/link.bin");
    fs::create_directory_symlink("..", asset_ + "/up");
    fs::create_symlink("own.bin", asset_ + "/good_link.bin");
    fs::create_symlink("loop.bin", asset_ + "/loop.bin");
    fs::create_symlink("/dev/zero", asset_ + "/zero.bin");
    ASSERT_EQ(mkfifo((asset_ + "/pipe.bin").c_str(), 0600), 0);
  }

  // Reads the geometry of a model whose buffer has the given URI. Returns the error, or "". Reads in a child process,
  // so that the test ends even if reading blocks.
  [[nodiscard]] std::string read(const std::string& uri, bool allow_external) const {
    const test::ChildRun run = test::run_in_child(20, [&]() -> std::string {
      GltfOptions options;
      options.allow_external = allow_external;
      const GltfFixture file(builder_.gltf_with_uri(uri), asset_, options);
      if (!file.ok()) return file.error();
      const Result<GltfGeometry> geometry = file->geometry(0, 0, {});
      if (!geometry) return geometry.error().text();
      return geometry.value().positions == test::kQuad ? "" : "other positions";
    });
    return run.finished ? run.text : "crash: " + run.text;
  }

  GltfBuilder builder_ = test::quad_document();
  test::TemporaryFolder folder_;
  std::string asset_ = folder_ / "asset";
};

TEST_F(GltfUris, inside_the_folder_are_read) {
  for (const char* const uri : {"own.bin", "./own.bin", "inner/own.bin", "inner/../own.bin", "inner//own.bin",
                                "good_link.bin", "%6fwn.bin", "up/asset/own.bin"}) {
    EXPECT_EQ(read(uri, false), "") << uri;
    EXPECT_EQ(read(uri, true), "") << uri;
  }
}

TEST_F(GltfUris, outside_the_folder_are_read_only_when_that_is_allowed) {
  std::string encoded = "%2e%2e%2fsecret.bin";
  for (const std::string& uri :
       {std::string("../secret.bin"), encoded, std::string("inner/../../secret.bin"), std::string("link.bin"),
        std::string("up/secret.bin"), std::string("../asset_too/own.bin"), std::string("%2E./secret.bin"),
        folder_ / "secret.bin"}) {
    const std::string error = read(uri, false);
    EXPECT_TRUE(error.starts_with("a.gltf, /buffers/0/uri: ")) << uri << ": " << error;
    EXPECT_NE(error.find("--allow-external"), std::string::npos) << uri << ": " << error;
    EXPECT_EQ(read(uri, true), "") << uri;
  }
}

TEST_F(GltfUris, absolute_path_into_the_folder_is_still_absolute) {
  EXPECT_NE(read(asset_ + "/own.bin", false), "");
  EXPECT_EQ(read(asset_ + "/own.bin", true), "");
}

TEST_F(GltfUris, that_are_no_regular_files_are_never_read) {
  for (const std::string& uri : {std::string(""),
                                 std::string("."),
                                 std::string(".."),
                                 std::string("inner"),
                                 std::string("inner/"),
                                 std::string("pipe.bin"),
                                 std::string("zero.bin"),
                                 std::string("/dev/zero"),
                                 std::string("/dev/stdin"),
                                 std::string("none.bin"),
                                 std::string("loop.bin"),
                                 std::string("own.bin/"),
                                 std::string("own.bin/x"),
                                 std::string("own%00.bin"),
                                 std::string("own%2"),
                                 std::string("own%zz.bin"),
                                 std::string("/"),
                                 std::string("file://") + asset_ + "/own.bin",
                                 std::string("file:own.bin"),
                                 std::string("http://localhost/own.bin"),
                                 std::string("https:own.bin"),
                                 std::string(":"),
                                 std::string("data:"),
                                 std::string("data:,abc"),
                                 std::string("\\\\server\\own.bin"),
                                 std::string(5000, 'x'),
                                 std::string(300000, '/')}) {
    for (const bool allow_external : {false, true}) {
      const std::string error = read(uri, allow_external);
      EXPECT_TRUE(error.starts_with("a.gltf, /buffers/0/uri: ")) << uri.substr(0, 100) << ": " << error.substr(0, 300);
    }
  }
}

TEST_F(GltfUris, of_files_that_are_too_short_are_refused) {
  for (const char* const uri : {"short.bin", "empty.bin"})
    EXPECT_TRUE(read(uri, false).starts_with("a.gltf, /buffers/0")) << uri;
}

TEST_F(GltfUris, asset_without_a_folder_has_no_files) {
  const GltfFixture file(builder_.gltf_with_uri("own.bin"));
  ASSERT_TRUE(file.ok()) << file.error();
  const Result<GltfGeometry> geometry = file->geometry(0, 0, {});
  ASSERT_FALSE(geometry.ok());
  EXPECT_EQ(geometry.error().place, "a.gltf, /buffers/0/uri");
}

TEST_F(GltfUris, of_data_must_be_base64_of_a_buffer) {
  const std::string good = test::base64(builder_.buffer), octets = "data:application/octet-stream;base64,";
  EXPECT_EQ(read(octets + good, false), "");
  for (const std::string& uri :
       {octets, octets + good.substr(0, good.size() - 8), octets + "!" + good.substr(1), octets + good.substr(0, 9),
        octets + " " + good, octets + std::string(1, '=') + good.substr(1), "data:text/plain;base64," + good,
        "data:application/octet-stream," + good, "data:base64," + good, octets.substr(0, octets.size() - 1) + good}) {
    const std::string error = read(uri, false);
    EXPECT_TRUE(error.starts_with("a.gltf, /buffers/0")) << uri.substr(0, 60) << ": " << error;
  }
}

TEST_F(GltfUris, of_buffers_that_are_not_used_are_not_opened) {
  GltfBuilder builder = test::quad_document();
  builder.json["buffers"] = {nlohmann::json::object(), {{"byteLength", 4}, {"uri", "/dev/zero"}}};
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_TRUE(file->geometry(0, 0, {}).ok());
}

TEST_F(GltfUris, file_in_the_current_folder_finds_its_buffers) {
  (void)folder_.write("asset/quad.gltf", builder_.gltf_with_uri("own.bin"));
  const test::ChildRun run = test::run_in_child(20, [&]() -> std::string {
    fs::current_path(asset_);
    const Result<GltfDocument> document = GltfDocument::open("quad.gltf");
    if (!document) return document.error().text();
    const Result<GltfGeometry> geometry = document.value().geometry(0, 0, {});
    return geometry ? "" : geometry.error().text();
  });
  EXPECT_TRUE(run.finished);
  EXPECT_EQ(run.text, "");
}

TEST_F(GltfUris, errors_say_what_is_wrong_with_them) {
  const std::string size = std::to_string(builder_.buffer.size()), octets = "data:application/octet-stream;base64,",
                    good = test::base64(builder_.buffer);
  const auto expect_error = [this](const std::string& uri, const std::string& message) {
    EXPECT_EQ(read(uri, false), "a.gltf, /buffers/0/uri: " + message);
  };
  expect_error("", "the uri is empty or has a broken % code, so it names no file; export the file again");
  expect_error("own%zz.bin", "this file is missing: " + asset_ + "/own%zz.bin");
  expect_error("own%00.bin", "the uri is empty or has a broken % code, so it names no file; export the file again");
  expect_error(
      "http://localhost/own.bin",
      "the uri is a web address, not the name of a file; copy the file beside the glTF file and refer to it by name");
  expect_error(asset_ + "/own.bin",
               "the uri is an absolute path, which is refused for safety; if you trust the file, add --allow-external");
  expect_error("up/secret.bin",
               "the uri leads out of the folder of the glTF file, which is refused for safety; if you trust the file, "
               "add --allow-external");
  expect_error("none.bin", "this file is missing: " + asset_ + "/none.bin");
  expect_error("pipe.bin", asset_ + "/pipe.bin is not a regular file; put the file itself there");
  expect_error("short.bin", "the file has 3 bytes, but byteLength is " + size + "; export the file again");
  expect_error(octets + good.substr(0, 8),
               "the data URI has fewer than the " + size + " bytes of byteLength; export the file again");
  expect_error(octets + "!" + good.substr(1), "the data URI is not valid base64; export the file again");
  expect_error(octets + good.substr(0, good.size() - 1),
               "the data URI has " + std::to_string(builder_.buffer.size() - 1) + " bytes, but byteLength is " + size +
                   "; export the file again");
  expect_error("data:text/plain;base64," + good,
               "the data URI of a buffer has another type than glTF allows; export it with "
               "data:application/octet-stream;base64, or "
               "data:application/gltf-buffer;base64,");
}

TEST_F(GltfUris, names_that_a_person_would_call_the_same_are_found) {
  const auto write = [&](const std::string& name) {
    std::ofstream(asset_ + "/" + name, std::ios::binary) << builder_.buffer;
  };
  // A percent sign begins an escape only before two hexadecimal digits. A URI may also contain the characters of a file
  // name without escapes.
  write("example 10%.bin");
  EXPECT_EQ(read("example 10%.bin", false), "");
  write("fifty%20percent.bin");
  EXPECT_EQ(read("fifty%20percent.bin", false), "");
  // A letter with an accent may be one Unicode character in the URI and two in the file name, or the reverse.
  write("cafe\u0301.bin");
  EXPECT_EQ(read("caf\u00E9.bin", false), "");
  EXPECT_EQ(read("caf%C3%A9.bin", false), "");
  write("\u1EBF\uAC01.bin");
  EXPECT_EQ(read("e\u0302\u0301\u1100\u1161\u11A8.bin", false), "");
  EXPECT_NE(read("cafe.bin", false), "");
}

}  // namespace
}  // namespace chronormal::gltf_uri_test
