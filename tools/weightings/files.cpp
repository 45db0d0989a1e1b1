// Section 2: normals that other tools stored in files, and the weighting that reproduces them.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "io/bytes/file.h"
#include "io/mesh/obj.h"
#include "weightings/sections.h"

namespace chronormal::weightings {
namespace {

enum class Hard { kSmoothingGroups, kSplitNormals };

struct Golden {
  const char* path;  // in the folder of the data; the files of a folder are measured together
  const char* name;  // in the table
  const char* tool;
  const char* origin;  // repository@commit: path, licence
  Weighting weighting;
  Hard hard;
};

const std::vector<Golden>& all_golden() {
  using enum Hard;
  static const std::vector<Golden> all = {
      {"golden/maya_blend_inbetween", "`maya_blend_inbetween_*.obj`", "Maya",
       "ufbx/ufbx@fcc5d6ba: data; MIT or public domain", Weighting::kAreaAngle, kSmoothingGroups},
      {"golden/maya_cache_sine", "`maya_cache_sine_12.obj`", "Maya", "ufbx/ufbx@fcc5d6ba: data; MIT or public domain",
       Weighting::kAreaAngle, kSmoothingGroups},
      {"caches/max_cache_box/max_cache_box_44.obj", "`max_cache_box_44.obj`", "3ds Max",
       "ufbx/ufbx@fcc5d6ba: data; MIT or public domain", Weighting::kAngle, kSplitNormals},
      {"golden/static/textured_tetrahedron.obj", "`textured_tetrahedron.obj`", "not stated",
       "mikedh/trimesh@a513c0e2: models; MIT", Weighting::kAngle, kSplitNormals},
      {"golden/static/groups.obj", "`groups.obj`", "not stated", "mikedh/trimesh@a513c0e2: models; MIT",
       Weighting::kArea, kSplitNormals},
      {"golden/blender_flat", "`blender_279_sausage_*.obj`", "Blender, flat",
       "ufbx/ufbx@fcc5d6ba: data; MIT or public domain", Weighting::kArea, kSmoothingGroups},
      {"golden/static/spider.obj", "`spider.obj`", "not stated", "assimp/assimp: test/models/OBJ; BSD-3-Clause",
       Weighting::kUniform, kSmoothingGroups},
  };
  return all;
}

// A mesh with the normal of each corner, and the smoothing group of each face.
struct StoredNormals {
  Motion motion;  // the mesh, twice
  std::vector<float> of_corner;
  std::vector<std::uint32_t> group_of_face;

  [[nodiscard]] VectorView<const float> normals() const {
    return VectorView<const float>::packed(of_corner.data(), of_corner.size() / 3);
  }
};

StoredNormals read_stored(const std::filesystem::path& path) {
  StoredNormals stored;
  const auto file = FileBytes::open(path.string());
  if (!file) throw std::runtime_error(file.error().text());
  auto mesh = read_obj_shading(file.value().bytes(), path.filename().string());
  if (!mesh) throw std::runtime_error(mesh.error().text());
  stored.motion.topology = std::move(mesh.value().topology);
  for (const double time : {0.0, 1.0}) stored.motion.keyframes.push_back({mesh.value().positions, time, {}});
  stored.motion.connect_as_sequence();
  stored.of_corner = std::move(mesh.value().normal_of_corner);
  stored.group_of_face = std::move(mesh.value().group_of_face);
  stored.group_of_face.resize(stored.motion.topology.face_count(), 0);  // in no group where the file has none
  return stored;
}

NormalGroups groups_of(const StoredNormals& stored, Hard hard) {
  const Topology& topology = stored.motion.topology;
  const Points points = separate_points(topology.vertex_count());
  return hard == Hard::kSmoothingGroups
             ? NormalGroups::by_smoothing_group(topology, points, stored.group_of_face).value()
             : NormalGroups::by_split_normals(topology, points, stored.normals()).value();
}

double largest_difference(const StoredNormals& stored, const NormalGroups& groups, Weighting weighting) {
  const auto normals = all_weighted_normals_at(stored.motion.segment(0), groups, weighting, 0);
  double worst = 0;
  for (std::size_t c = 0; c < stored.motion.topology.corner_count(); ++c)
    worst = std::max(worst, angle_between(normals[groups.element_of_corner()[c]], to_double(stored.normals()[c])));
  return worst * kDegreesPerRadian;
}

std::vector<std::filesystem::path> files_of(const Golden& golden, const std::filesystem::path& data) {
  if (!std::filesystem::is_directory(data / golden.path)) return {data / golden.path};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(data / golden.path)) {
    if (entry.path().extension() == ".obj") files.push_back(entry.path());
  }
  return files;
}

using Differences = std::array<double, kWeightings.size()>;

std::vector<std::string> row_of(const char* name, const char* tool, Weighting rule, const Differences& worst) {
  std::vector<std::string> row = {name, tool, fmt::format("`{}`", weighting_name(rule))};
  for (std::size_t w = 0; w < kWeightings.size(); ++w) {
    const bool matches = kWeightings[w].weighting == rule;
    if (matches) require(worst[w] < 0.01, name);
    row.push_back(matches ? fmt::format("**{:.4f}**", worst[w]) : fmt::format("{:.2f}", worst[w]));
  }
  return row;
}

// The two cases of PyTorch3D's own test, as a file of ours could not hold them: vertices, faces, expected normals.
std::vector<std::string> pytorch3d_row(const std::filesystem::path& path) {
  std::ifstream file(path);
  const auto cases = nlohmann::json::parse(file).at("cases");
  Differences worst{};
  for (const auto& one : cases) {
    Motion motion;
    std::vector<std::uint32_t> corners;
    for (const auto& face : one.at("faces")) {
      for (const auto& vertex : face) corners.push_back(vertex.get<std::uint32_t>());
    }
    motion.keyframes.resize(2);
    for (const auto& vertex : one.at("verts")) {
      for (const auto& coordinate : vertex) motion.keyframes[0].positions.push_back(coordinate.get<float>());
    }
    motion.keyframes[1] = {motion.keyframes[0].positions, 1, {}};
    const std::size_t count = motion.keyframes[0].positions.size() / 3;
    motion.topology = Topology::triangles(count, std::move(corners)).value();
    motion.connect_as_sequence();
    const NormalGroups groups = NormalGroups::of_vertices(motion.topology, separate_points(count));
    const auto expected = one.at("verts_normals").get<std::vector<std::array<double, 3>>>();
    for (std::size_t w = 0; w < kWeightings.size(); ++w) {
      const auto normals = all_weighted_normals_at(motion.segment(0), groups, kWeightings[w].weighting, 0);
      for (std::size_t v = 0; v < count; ++v) {
        const Vec3d n{expected[v][0], expected[v][1], expected[v][2]};
        worst[w] = std::max(worst[w], angle_between(normals[v], n) * kDegreesPerRadian);
      }
    }
  }
  return row_of("`test_meshes.py`, 2 cases", "PyTorch3D", Weighting::kArea, worst);
}

}  // namespace

std::string golden_part(const std::string& folder, const std::filesystem::path& data) {
  Cells header = {"file", "written by", "rule"};
  for (const WeightingInfo& info : kWeightings) header.push_back(fmt::format("`{}`", info.name));
  std::vector<Cells> rows;
  std::size_t file_count = 0;
  std::string origins;
  for (const Golden& golden : all_golden()) {
    Differences worst{};
    for (const auto& path : files_of(golden, data)) {
      const StoredNormals stored = read_stored(path);
      const NormalGroups groups = groups_of(stored, golden.hard);
      for (std::size_t w = 0; w < kWeightings.size(); ++w)
        worst[w] = std::max(worst[w], largest_difference(stored, groups, kWeightings[w].weighting));
      ++file_count;
    }
    rows.push_back(row_of(golden.name, golden.tool, golden.weighting, worst));
    origins += fmt::format("* {}: {}\n", golden.name, golden.origin);
  }
  rows.push_back(pytorch3d_row(data / "golden/pytorch3d_test_compute_normals.json"));
  Page part("weightings/golden.md.in", folder);
  part.table("files", header, rows);
  part.set({{"file_count", grouped(static_cast<double>(file_count))}, {"origins", origins}});
  return part.markdown();
}

}  // namespace chronormal::weightings
