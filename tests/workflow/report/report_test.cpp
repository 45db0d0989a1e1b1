// Tests the content of a report as a page reads it. All data of a report are in its container.
// tests/support/report_file.h reads the container, and computes the error at each of the worst places from the
// container alone.

#include "workflow/report/report.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/output.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/authored_mesh.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/fixtures.h"
#include "tests/support/report_file.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::report_test {
namespace {

using test::ReportFile;

constexpr double kAgree = 1e-3;  // largest allowed difference of two errors, in degrees

// Opens an input and makes its report.
Result<Report> report_of(InputOptions input, const ReportOptions& options = {}) {
  input.shading = KeepShading::kAll;
  Result<Input> opened = open_input(input);
  if (!opened) return opened.error();
  return report(opened.value(), options);
}

// Returns the options for an input that is a GLB file in memory. The bytes must outlive the options.
InputOptions input_of_glb(const std::string& glb) {
  InputOptions input;
  input.files = {"a.glb"};
  input.resolve = [&glb](const std::string&) -> Result<std::string_view> { return std::string_view(glb); };
  return input;
}

Result<Report> report_of_glb(const std::string& glb, const ReportOptions& options = {}) {
  return report_of(input_of_glb(glb), options);
}

ReportOptions without_plan() {
  ReportOptions options;
  options.plan = false;
  return options;
}

// Checks that the container gives the errors at the worst places, and that the first of these errors is the worst error
// of the audit. Returns the parsed container.
ReportFile expect_numbers(const Report& found, std::size_t most_places = kMostWorstPlaces) {
  ReportFile file(found.container);
  EXPECT_FALSE(file.json.is_null());
  const nlohmann::json& worst = file.json["worst"];
  EXPECT_EQ(worst.size(), found.worst.size());
  EXPECT_GT(worst.size(), 0U);
  if (worst.empty()) return file;
  EXPECT_NEAR(worst[0]["degrees"].get<double>(), found.audit.error.worst, kAgree);
  double before = 181;
  for (std::size_t i = 0; i < std::min(most_places, worst.size()); ++i) {
    EXPECT_LE(worst[i]["degrees"].get<double>(), before);
    before = worst[i]["degrees"];
    EXPECT_NEAR(file.degrees_at(worst[i]), before, kAgree) << worst[i].dump();
  }
  return file;
}

// Makes a file of a mesh with three targets and an animation that activates them together.
test::GltfBuilder talking(const test::ShadedMesh& mesh) {
  test::GltfBuilder builder = mesh.file();
  const std::size_t animation = builder.add_animation("talk");
  builder.add_track(animation, 0, std::vector<float>{0, 1, 3},
                    std::vector<float>{0, 0, 0, 1, 0.5F, 0.25F, 0.5F, 1.5F, -0.5F});
  return builder;
}

test::GltfBuilder sheet_file(std::uint64_t seed, double tilt) { return talking(test::random_sheet(seed, 9, 3, tilt)); }

// Makes an OBJ file of a box. The six sides of the box are quads with separate normals, so each point has three
// vertices. The upper side turns, and one of its corners rises, so all vertices move differently.
std::string box(double twist, bool with_normals) {
  std::string text;
  for (int i = 0; i < 8; ++i) {
    const double x = (i & 1) - 0.5, y = (i >> 1 & 1) - 0.5, z = (i >> 2 & 1) - 0.5, a = z > 0 ? twist : 0;
    text += "v " + std::to_string(x * std::cos(a) - y * std::sin(a)) + ' ' +
            std::to_string(x * std::sin(a) + y * std::cos(a)) + ' ' + std::to_string(i == 7 ? z + 0.3 * a : z) + '\n';
  }
  for (const char* normal : {"0 0 -1", "0 0 1", "0 -1 0", "0 1 0", "-1 0 0", "1 0 0"})
    text += std::string("vn ") + normal + '\n';
  const std::array<std::array<int, 4>, 6> sides = {
      {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}};
  for (std::size_t s = 0; s < sides.size(); ++s) {
    text += 'f';
    for (const int v : sides[s])
      text += ' ' + std::to_string(v) + (with_normals ? "//" + std::to_string(s + 1) : std::string());
    text += '\n';
  }
  return text;
}

std::string decoded(std::string_view text) {
  std::string result;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) continue;  // base64 ends with padding
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    result += static_cast<char>(bits >> static_cast<unsigned>(count) & 0xFFU);
  }
  return result;
}

std::string unpacked(std::string packed, std::size_t size) {
  std::string result(size + 1, '\0');
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 16 + MAX_WBITS), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  result.resize(stream.total_out);
  inflateEnd(&stream);
  return result;
}

const std::string kTemplate = "<html><body><!--chronormal-data--></body></html>";
constexpr std::string_view kOpen = "<script type=\"application/octet-stream\" id=\"chronormal-data\">";

TEST(Report, numbers_of_a_gltf_file_follow_from_the_report_alone) {
  for (const double tilt : {0.0, 0.3}) {
    const Result<Report> found = report_of_glb(sheet_file(11, tilt).glb(), without_plan());
    ASSERT_TRUE(found) << found.error().text();
    const ReportFile file = expect_numbers(found.value());
    EXPECT_EQ(file.json["kind"], "gltf");
    ASSERT_EQ(file.part(0)["motions"].size(), 4U);
    const nlohmann::json& track = file.part(0)["motions"][3];
    EXPECT_EQ(track["name"], "talk");
    EXPECT_EQ(track["subject"], 3);
    const std::vector<double> at = file.numbers<double>(track["at"]);
    ASSERT_EQ(at.size(), 42U);
    EXPECT_EQ(at[20], 1);
    EXPECT_EQ(at[21], 1);
    const std::vector<float> weights = file.numbers<float>(track["weights"][0]["values"]),
                             worst = file.numbers<float>(track["worst"]);
    ASSERT_EQ(weights.size(), 126U);
    EXPECT_FLOAT_EQ(weights[123], 0.5F);
    EXPECT_FLOAT_EQ(weights[124], 1.5F);
    EXPECT_FLOAT_EQ(*std::max_element(worst.begin(), worst.end()),
                    static_cast<float>(found.value().audit.subjects[3].error.worst));
    EXPECT_TRUE(file.json["plan"].is_null());
    EXPECT_EQ(file.json["audit"]["viewers"].size(), kViewers.size());
  }
}

TEST(Report, numbers_of_another_weighting_follow_from_the_report_alone) {
  for (const WeightingInfo& weighting : kAllWeightings) {
    ReportOptions options = without_plan();
    options.weighting = weighting.weighting;
    const Result<Report> found = report_of_glb(sheet_file(12, 0.1).glb(), options);
    ASSERT_TRUE(found) << found.error().text();
    EXPECT_EQ(expect_numbers(found.value()).part(0)["weighting"], weighting.name);
  }
}

TEST(Report, numbers_of_a_file_with_an_author_follow_from_the_report_alone) {
  for (const std::uint64_t seed : {20U, 21U, 22U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Result<Report> found = report_of_glb(talking(test::AuthoredMesh(seed, 12).mesh()).glb(), without_plan());
    ASSERT_TRUE(found) << found.error().text();
    const ReportFile file = expect_numbers(found.value());
    const nlohmann::json& part = file.part(0);
    EXPECT_EQ(part["weighting"], "angle");
    EXPECT_TRUE(part["faces"].is_null());
    ASSERT_TRUE(part.contains("truth"));
    const nlohmann::json &truth = part["truth"], &offsets = truth["offsets"];
    std::map<std::size_t, std::size_t> polygons;  // number of polygons with each number of corners
    const std::vector<std::uint32_t> first = file.numbers<std::uint32_t>(truth["polygons"]["first"]);
    for (std::size_t p = 0; p + 1 < first.size(); ++p) ++polygons[first[p + 1] - first[p]];
    EXPECT_EQ(polygons.size(), 2U);
    EXPECT_GT(polygons[4], 60U);
    EXPECT_GT(polygons[6], 0U);
    EXPECT_GT(file.numbers<std::uint32_t>(truth["terms"]).size(), 2 * first.back());
    const std::vector<float> sides = file.numbers<float>(offsets["sides"]);
    EXPECT_GT(std::count(sides.begin(), sides.end(), 1.0F), 0);
    EXPECT_GT(std::count(sides.begin(), sides.end(), -1.0F), 0);
    EXPECT_EQ(offsets["turned"]["count"], 6);
    ASSERT_EQ(offsets["targets"].size(), 3U);
    for (const nlohmann::json& target : offsets["targets"]) EXPECT_GT(target["indices"]["count"], 0);
  }
}

TEST(Report, numbers_of_a_file_with_an_author_and_no_hard_edge_need_no_terms) {
  const Result<Report> found = report_of_glb(talking(test::AuthoredMesh(24, 12, 0).mesh()).glb(), without_plan());
  ASSERT_TRUE(found) << found.error().text();
  const nlohmann::json truth = expect_numbers(found.value()).part(0)["truth"];
  EXPECT_TRUE(truth["terms"].is_null());
  EXPECT_FALSE(truth["polygons"].is_null());
  EXPECT_FALSE(truth["offsets"].is_null());
}

TEST(Report, numbers_of_what_follows_no_author_need_no_truth) {
  for (const std::optional<Weighting> asked : {std::optional<Weighting>(), std::optional(Weighting::kMax)}) {
    ReportOptions options = without_plan();
    options.weighting = asked;
    const test::ShadedMesh mesh = asked ? test::AuthoredMesh(20, 12).mesh() : test::random_sheet(11, 9, 3, 0.3);
    const Result<Report> found = report_of_glb(talking(mesh).glb(), options);
    ASSERT_TRUE(found) << found.error().text();
    EXPECT_FALSE(expect_numbers(found.value()).part(0).contains("truth"));
  }
}

TEST(Report, numbers_of_a_baked_file_follow_from_its_extra_targets) {
  BakeOptions how;
  how.encoding = BakeEncoding::kExact;
  const test::Baked baked = test::bake_bytes(sheet_file(13, 0.2).glb(), how);
  ASSERT_TRUE(baked.ok()) << baked.error;
  // An audit with the weighting of the bake must find no error.
  ReportOptions by_angle = without_plan();
  by_angle.weighting = Weighting::kAngle;
  const Result<Report> found = report_of_glb(baked.bytes, by_angle);
  ASSERT_TRUE(found) << found.error().text();
  const Result<Report> right = report_of_glb(baked.bytes, without_plan());
  ASSERT_TRUE(right) << right.error().text();
  EXPECT_TRUE(right.value().worst.empty());
  const ReportFile file = expect_numbers(found.value());
  const nlohmann::json& part = file.part(0);
  EXPECT_EQ(part["mark"], baked.mesh()["extras"]["chronormal"]);
  std::size_t extra = 0;
  for (const nlohmann::json& target : part["targets"]) {
    if (!target["extra"]) continue;
    ++extra;
    EXPECT_EQ(target["positions"]["count"], 0);
  }
  EXPECT_EQ(extra, part["mark"]["extras"].size());
  EXPECT_GT(extra, 0U);
}

TEST(Report, numbers_of_a_sequence_with_hard_edges_follow_from_the_report_alone) {
  for (const bool with_normals : {false, true}) {
    const test::TemporaryFolder folder;
    for (int k = 0; k < 3; ++k) folder.write("box_" + std::to_string(k) + ".obj", box(0.6 * k, with_normals));
    InputOptions input;
    input.files = {folder.path()};
    const Result<Report> found = report_of(input);
    ASSERT_TRUE(found) << found.error().text();
    const ReportFile file = expect_numbers(found.value());
    EXPECT_EQ(file.json["kind"], "sequence");
    const nlohmann::json& part = file.part(0);
    EXPECT_EQ(part["vertices"], with_normals ? 24 : 8);
    EXPECT_EQ(file.numbers<std::uint32_t>(part["faces"]).size(), 12U);
    EXPECT_EQ(part["keyframes"]["normals"].is_null(), !with_normals);
    for (std::size_t v = 0; v < 24 && with_normals; ++v) EXPECT_EQ(file.label(part, v), v / 3);
    ASSERT_EQ(part["motions"].size(), 1U);
    const nlohmann::json& schemes = part["motions"][0]["schemes"];
    EXPECT_EQ(schemes[0]["name"], "linear");
    const std::vector<float> worst = file.numbers<float>(schemes[0]["worst"]);
    EXPECT_EQ(worst.size(), 42U);
    EXPECT_NEAR(*std::max_element(worst.begin(), worst.end()),
                file.json["compare"]["schemes"][0]["max_degrees"].get<double>(), kAgree);
  }
}

TEST(Report, numbers_of_targets_over_a_base_follow_from_the_report_alone) {
  const test::TemporaryFolder folder;
  folder.write("base.obj", box(0, true));
  folder.write("left.obj", box(0.5, true));
  folder.write("right.obj", box(-0.9, true));
  InputOptions input;
  input.base = folder.path() + "/base.obj";
  input.files = {folder.path() + "/left.obj", folder.path() + "/right.obj"};
  const Result<Report> found = report_of(input);
  ASSERT_TRUE(found) << found.error().text();
  const ReportFile file = expect_numbers(found.value());
  EXPECT_EQ(file.json["kind"], "targets");
  ASSERT_EQ(file.part(0)["motions"].size(), 2U);
  EXPECT_EQ(file.part(0)["motions"][1]["target"], 1);
  EXPECT_EQ(file.part(0)["motions"][1]["seconds"], false);
  // Half of the vertices do not move, so the container stores only the vertices that move.
  EXPECT_EQ(file.part(0)["keyframes"]["positions"][1]["indices"]["count"], 12);
}

TEST(Report, what_viewers_show_is_what_they_keep) {
  ReportOptions options = without_plan();
  options.viewers = {kViewers[3], kViewers[6]};  // godot and gltfpack
  const test::GltfBuilder builder = sheet_file(14, 0.2);
  const Result<Report> found = report_of_glb(builder.glb(), options);
  ASSERT_TRUE(found) << found.error().text();
  const ReportFile file = expect_numbers(found.value());
  const nlohmann::json &shown = file.part(0)["shown"], &weights = file.part(0)["motions"][3]["weights"];
  ASSERT_EQ(shown.size(), 3U);
  EXPECT_EQ(shown[0]["viewers"], nlohmann::json({"specification", "three", "babylon", "bevy"}));
  EXPECT_EQ(shown[1]["viewers"], nlohmann::json({"godot"}));
  EXPECT_EQ(shown[1]["least_weight"], 1e-4);
  EXPECT_EQ(shown[2]["viewers"], nlohmann::json({"gltfpack"}));
  // gltfpack rounds to 8 bits, so every component of a delta is an integer multiple of 1/127.
  for (const float component : file.numbers<float>(shown[2]["targets"][0]["deltas"]))
    EXPECT_NEAR(component * 127, std::round(component * 127), 1e-4);
  ASSERT_EQ(weights.size(), 2U);
  EXPECT_EQ(weights[1]["viewers"], nlohmann::json({"gltfpack"}));
  EXPECT_NE(file.numbers<float>(weights[1]["values"]), file.numbers<float>(weights[0]["values"]));
}

// Each target is a separate motion, in which the other targets rest.
TEST(Report, bytes_are_linear_in_targets) {
  const auto peak = [](std::size_t targets) {
    test::GltfBuilder builder;
    const std::size_t base = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0}),
                      lift = builder.add_positions({0, 0, 0, 0, 0, 0.5F, 0, 0, 0.25F}),
                      normals = builder.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1}),
                      corners = builder.add_indices<std::uint8_t>({0, 1, 2});
    nlohmann::json primitive =
        test::GltfBuilder::primitive(base, corners, std::vector<nlohmann::json>(targets, {{"POSITION", lift}}));
    primitive["attributes"]["NORMAL"] = normals;
    builder.add_node(builder.add_mesh(std::move(primitive)));
    const std::string glb = builder.glb();
    const test::AllocationCounter counter;
    const Result<Report> found = report_of_glb(glb, without_plan());
    EXPECT_TRUE(found) << found.error().text();
    const ReportFile file = expect_numbers(found.value());
    const nlohmann::json& motion = file.part(0)["motions"][targets - 1];
    EXPECT_EQ(file.numbers<std::uint32_t>(motion["weights"][0]["targets"]),
              std::vector<std::uint32_t>{static_cast<std::uint32_t>(targets - 1)});
    return std::pair{found.value().container.size(), counter.peak_bytes()};
  };
  const auto [few_bytes, few_peak] = peak(100);
  const auto [many_bytes, many_peak] = peak(800);
  EXPECT_LT(many_bytes, 10 * few_bytes);
  if (test::AllocationCounter::works()) {
    EXPECT_LT(many_peak, 12 * few_peak);
  }
}

TEST(Report, no_two_worst_places_are_neighbours) {
  InputOptions input;
  input.samples = {"twist"};
  const Result<Report> found = report_of(input);
  ASSERT_TRUE(found) << found.error().text();
  const ReportFile file = expect_numbers(found.value());
  EXPECT_EQ(found.value().worst.size(), kMostWorstPlaces);
  const std::vector<float> positions = file.numbers<float>(file.part(0)["positions"]);
  std::array<float, 3> low = {1e9F, 1e9F, 1e9F}, high = {-1e9F, -1e9F, -1e9F};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    low[i % 3] = std::fmin(low[i % 3], positions[i]);
    high[i % 3] = std::fmax(high[i % 3], positions[i]);
  }
  const double diagonal = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  for (const ReportPlace& a : found.value().worst) {
    for (const ReportPlace& b : found.value().worst) {
      if (a.vertex == b.vertex) continue;
      const float *p = &positions[3 * a.vertex], *q = &positions[3 * b.vertex];
      EXPECT_GT(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), 0.04 * diagonal);
    }
  }
}

TEST(Report, plan_is_that_of_bake_or_says_why_there_is_none) {
  const Result<Report> planned = report_of_glb(sheet_file(15, 0).glb());
  ASSERT_TRUE(planned) << planned.error().text();
  const ReportFile file(planned.value().container);
  ASSERT_TRUE(file.json["plan"].is_object());
  EXPECT_EQ(file.json["plan"]["command"], "bake");
  EXPECT_TRUE(file.json["plan_message"].is_null());

  // If the extras of a mesh are not an object, a bake cannot store its data there.
  test::GltfBuilder builder = sheet_file(15, 0);
  builder.json["meshes"][0]["extras"] = "mine";
  const Result<Report> refused = report_of_glb(builder.glb());
  ASSERT_TRUE(refused) << refused.error().text();
  const ReportFile without(refused.value().container);
  EXPECT_TRUE(without.json["plan"].is_null());
  EXPECT_NE(without.json["plan_message"].get<std::string>().find("extras"), std::string::npos);
}

TEST(Report, an_input_in_which_nothing_moves_is_refused) {
  test::ShadedMesh mesh = test::hinge();
  mesh.targets.clear();
  const Result<Report> found = report_of_glb(mesh.file().glb());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(found.error().message.find("no morph target"), std::string::npos);
}

TEST(Report, page_holds_the_container_in_place_of_the_mark) {
  const Result<Report> found = report_of_glb(sheet_file(16, 0).glb(), without_plan());
  ASSERT_TRUE(found) << found.error().text();
  const Result<std::string> page = report_page(found.value(), kTemplate);
  ASSERT_TRUE(page) << page.error().text();
  const std::size_t begin = page.value().find(kOpen), end = page.value().find("</script>");
  ASSERT_EQ(begin, std::string_view("<html><body>").size());
  const std::string inside = page.value().substr(begin + kOpen.size(), end - begin - kOpen.size());
  EXPECT_EQ(unpacked(decoded(inside), found.value().container.size()), found.value().container);
  EXPECT_EQ(page.value().substr(end), "</script></body></html>");
}

TEST(Report, template_without_exactly_one_mark_is_refused) {
  for (const std::string& broken : {std::string("<html></html>"), std::string(), kTemplate + kTemplate}) {
    const Result<std::string> page = report_page(Report(), broken);
    ASSERT_FALSE(page);
    EXPECT_EQ(page.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(page.error().message.find("./run report"), std::string::npos);
  }
}

TEST(Report, names_in_files_cannot_leave_the_script_element) {
  const std::string evil = "</script><script>alert(1)</script><!--chronormal-data-->";
  test::GltfBuilder builder = sheet_file(17, 0);
  builder.json["meshes"][0]["name"] = evil;
  builder.json["animations"][0]["name"] = evil;
  const Result<Report> found = report_of_glb(builder.glb(), without_plan());
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(ReportFile(found.value().container).part(0)["name"], evil);
  const Result<std::string> page = report_page(found.value(), kTemplate);
  ASSERT_TRUE(page) << page.error().text();
  EXPECT_EQ(page.value().find("alert"), std::string::npos);
  EXPECT_EQ(page.value().find("</script>"), page.value().rfind("</script>"));
}

// Checks the page for a mesh that exceeds the limit of bytes. Returns the report.
Report expect_thinned(const InputOptions& input, ReportOptions options) {
  options.plan = false;
  const Result<Report> found = report_of(input, options);
  EXPECT_TRUE(found) << found.error().text();
  const Result<std::string> page = report_page(found.value(), kTemplate);
  EXPECT_TRUE(page) << page.error().text();
  EXPECT_LE(page.value().size(), options.most_bytes);
  EXPECT_GT(page.value().size(), options.most_bytes / 2);
  EXPECT_FALSE(found.value().thinned.empty());
  (void)expect_numbers(found.value());
  return found.value();
}

// Returns two reports of a file. In the first, vertices are left out to keep the limit most_bytes. The second has the
// whole file.
std::pair<Report, Report> thinned_and_whole(const std::string& glb, std::size_t most_bytes) {
  ReportOptions options;
  options.template_bytes = kTemplate.size();
  options.samples = 3;
  options.most_bytes = most_bytes;
  const Report thinned = expect_thinned(input_of_glb(glb), options);
  options.most_bytes = kMostReportBytes;
  options.plan = false;
  const Result<Report> whole = report_of_glb(glb, options);
  EXPECT_TRUE(whole) << whole.error().text();
  return {thinned, whole.value()};
}

// Returns the number of judged triangles around each vertex of part 0.
std::vector<std::size_t> corners_of_vertices(const ReportFile& file) {
  std::vector<std::size_t> result(file.part(0)["vertices"].get<std::size_t>());
  for (const std::uint32_t v : file.numbers<std::uint32_t>(file.part(0)["triangles"])) ++result[v];
  return result;
}

TEST(Report, worst_places_of_a_large_mesh_stay_whole) {
  const auto [found, whole] = thinned_and_whole(test::random_sheet(18, 80, 2, 0.2).file().glb(), 250000);
  ASSERT_EQ(found.thinned.size(), 1U);
  EXPECT_NE(found.thinned[0].find("of 12,482 triangles"), std::string::npos) << found.thinned[0];
  const ReportFile file(found.container);
  const nlohmann::json& part = file.part(0);
  EXPECT_GT(part["coarse"]["count"], 0);
  EXPECT_LT(part["vertices"], 80 * 80);
  // Labels must give the vertices the same numbers as the file does, although vertices were left out.
  for (std::size_t i = 0; i < found.worst.size(); ++i)
    EXPECT_EQ("mesh 0, primitive 0, vertex " + std::to_string(file.label(part, found.worst[i].vertex)),
              found.worst[i].label);
  // The report of the whole file must have the same worst places with the same errors.
  EXPECT_TRUE(whole.thinned.empty());
  ASSERT_EQ(whole.worst.size(), found.worst.size());
  for (std::size_t i = 0; i < found.worst.size(); ++i) EXPECT_EQ(whole.worst[i].label, found.worst[i].label);
  // Every vertex that the shortened report judges must have all of its triangles. In this sheet, each vertex is a
  // separate element.
  const ReportFile all(whole.container);
  const std::vector<std::size_t> had = corners_of_vertices(all), has = corners_of_vertices(file);
  const std::vector<std::uint32_t> elements = file.numbers<std::uint32_t>(part["element"]);
  std::size_t judged = 0;
  for (std::size_t v = 0; v < elements.size(); ++v) {
    if (elements[v] == ReportFile::kNone) continue;
    ++judged;
    EXPECT_EQ(has[v], had[file.label(part, v)]) << v;
  }
  EXPECT_EQ(part["elements"], judged);
  EXPECT_GT(judged, 200U);
}

// Returns, for each judged vertex of part 0, the vertices on which its true normal depends: the vertices of the
// polygons around it, and the ends of its edges. All vertices are numbered as in the file. Throws if one of these
// vertices is missing.
std::map<std::size_t, std::vector<std::size_t>> seen_by_truths(const ReportFile& file) {
  const nlohmann::json &part = file.part(0), &truth = part["truth"], &offsets = truth["offsets"];
  const std::vector<std::uint32_t> elements = file.numbers<std::uint32_t>(part["element"]),
                                   first = file.numbers<std::uint32_t>(truth["polygons"]["first"]),
                                   corners = file.numbers<std::uint32_t>(truth["polygons"]["corners"]),
                                   terms = file.numbers<std::uint32_t>(truth["terms"]),
                                   bent = file.numbers<std::uint32_t>(offsets["elements"]),
                                   first_edge = file.numbers<std::uint32_t>(offsets["first"]),
                                   edges = file.numbers<std::uint32_t>(offsets["edges"]);
  std::vector<std::size_t> labels;
  for (std::size_t v = 0; v < elements.size(); ++v) labels.push_back(file.label(part, v));
  std::map<std::uint32_t, std::vector<std::size_t>> of_element;
  for (std::size_t i = 0; i < terms.size(); i += 2) {
    const auto end = std::upper_bound(first.begin(), first.end(), terms[i]);
    for (std::uint32_t c = *(end - 1); c < *end; ++c) of_element[terms[i + 1]].push_back(labels.at(corners[c]));
  }
  for (std::size_t f = 0; f < bent.size(); ++f)
    for (std::size_t i = 2 * first_edge[f]; i < 2 * first_edge[f + 1]; ++i)
      of_element[bent[f]].push_back(labels.at(edges[i]));
  std::map<std::size_t, std::vector<std::size_t>> result;
  for (std::size_t v = 0; v < elements.size(); ++v)
    if (elements[v] != ReportFile::kNone) result[labels[v]] = of_element[elements[v]];
  return result;
}

TEST(Report, what_an_author_would_see_at_worst_places_stays_whole) {
  const auto [found, whole] = thinned_and_whole(talking(test::AuthoredMesh(23, 50).mesh()).glb(), 120000);
  const ReportFile file(found.container);
  const nlohmann::json& part = file.part(0);
  EXPECT_GT(part["coarse"]["count"], 0);
  EXPECT_GT(part["truth"]["offsets"]["elements"]["count"], 0);
  EXPECT_FALSE(part["truth"]["terms"].is_null());
  std::map<std::size_t, std::vector<std::size_t>> all = seen_by_truths(ReportFile(whole.container)),
                                                  some = seen_by_truths(file);
  EXPECT_LT(some.size(), all.size());
  for (const auto& [label, seen] : some) EXPECT_EQ(seen, all[label]) << label;
}

TEST(Report, worst_segments_of_a_long_sequence_stay_with_their_neighbours) {
  Motion motion = fixtures::smooth_morph(16);
  const std::vector<float> from = motion.keyframes[0].positions, to = motion.keyframes[1].positions;
  motion.keyframes.resize(1);
  fixtures::Random random(19);
  for (std::size_t k = 1; k < 200; ++k) {
    Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
    const double share = random.uniform(0, 1);
    for (std::size_t i = 0; i < from.size(); ++i)
      keyframe.positions.push_back(static_cast<float>((1 - share) * from[i] + share * to[i]));
    keyframe.time = static_cast<double>(k);
  }
  motion.connect_as_sequence();
  const test::TemporaryFolder folder;
  InputOptions input;
  input.files = {folder.path() + "/long.npz"};
  ASSERT_TRUE(write_motion(motion, input.files[0], false));
  ReportOptions options;
  options.samples = 5;
  options.most_bytes = 400000;
  const Report found = expect_thinned(input, options);
  EXPECT_NE(found.thinned[0].find("of 200 keyframes"), std::string::npos) << found.thinned[0];
  const ReportFile file(found.container);
  const nlohmann::json &keys = file.part(0)["keyframes"], &track = file.part(0)["motions"][0];
  const std::vector<std::size_t> numbers = keys["numbers"];
  const std::vector<std::uint32_t> segments = file.numbers<std::uint32_t>(keys["segments"]),
                                   of_sample = file.numbers<std::uint32_t>(track["segment"]);
  std::set<std::size_t> known;  // the segments that the container includes
  for (std::size_t s = 0; 2 * s < segments.size(); ++s) {
    EXPECT_EQ(numbers[segments[2 * s]] + 1, numbers[segments[2 * s + 1]]);
    known.insert(numbers[segments[2 * s]]);
  }
  EXPECT_LT(known.size(), 199U);
  EXPECT_EQ(of_sample.size(), 199U * 5);  // the plot shows the errors of all samples
  for (const ReportPlace& place : found.worst) {
    const std::size_t segment = place.sample / 5;
    for (const std::size_t s : {segment == 0 ? 0 : segment - 1, segment, std::min<std::size_t>(segment + 1, 198)})
      EXPECT_TRUE(known.count(s)) << s;
  }
}

class ReportOfRealMeshes : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    folder_ = folder;
  }
  std::string folder_;
};

TEST_F(ReportOfRealMeshes, numbers_of_a_head_with_two_keys_follow_from_the_report_alone) {
  InputOptions input;
  input.files = {folder_ + "/rigs/blender_suzanne_two_keys.glb"};
  ReportOptions options = without_plan();
  options.samples = 2;
  const Result<Report> found = report_of(input, options);
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(expect_numbers(found.value(), 4).part(0)["weighting"], "angle");
}

TEST_F(ReportOfRealMeshes, numbers_of_a_dance_follow_from_the_report_alone) {
  InputOptions input;
  input.files = {folder_ + "/sequences/rumba_13"};
  ReportOptions options;
  options.samples = 3;
  const Result<Report> found = report_of(input, options);
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(expect_numbers(found.value(), 4).part(0)["vertices"], 12811);
}

}  // namespace
}  // namespace chronormal::report_test
