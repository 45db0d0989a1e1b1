#include "workflow/bake/judge/played_errors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/blocks.h"
#include "workflow/bake/judge/played_poses.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 256, kBetweenKeys = 3, kSteps = 8;
constexpr unsigned kRigSeed = 3;
constexpr double kPhase = 0.61, kLeastLength = 1e-3;
// Errors are counted in bins of a tenth of themselves.
constexpr std::size_t kBins = 400;
constexpr double kLeast = 1e-12, kBinsPerUnit = 10;

struct Found {
  std::size_t count = 0;
  double sum = 0, worst = 0;
  std::array<std::uint32_t, kBins> bins{};
};

}  // namespace

PoseList played_poses(const MeshWeights& weights, const ExtraDrivers& drivers, std::size_t targets, std::size_t most) {
  PoseList poses;
  for (std::size_t t = 0; t < weights.tracks.size(); ++t) {
    const ExtendedTrack extended =
        drivers.extended(weights.names[t], weights.tracks[t], std::numeric_limits<double>::infinity());
    // As many instants of the file's own gaps, whatever they were cut into.
    const WeightTrack written = as_track(weights.tracks[t], extended, drivers.size());
    const std::size_t between =
        std::max<std::size_t>(1, kBetweenKeys * weights.tracks[t].size() / std::max<std::size_t>(1, written.size()));
    add_played_poses({written, weights.ranges[t]}, Host{}, between, kPhase, most / weights.tracks.size(), poses);
  }
  const PoseList standing = drivers.standing(weights.poses);
  poses.insert(poses.end(), standing.begin(),
               standing.begin() + static_cast<std::ptrdiff_t>(std::min(most, standing.size())));
  if (weights.is_driven) return poses;
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < targets; ++i) all.push_back(i);
  const PoseList alone = alone_poses(all, targets, drivers, kSteps, kPhase);
  for (std::size_t n = 0; n < std::min(most, alone.size()); ++n)
    poses.push_back(alone[n * alone.size() / std::min(most, alone.size())]);
  if (!weights.rig) return poses;
  for (std::vector<double>& pose : weights.rig->sample(most, kRigSeed))
    poses.push_back(drivers.with_extras(std::move(pose)));
  return poses;
}

ShownErrors played_errors(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                          std::span<const std::uint32_t> element_of_vertex, const VertexColumns& form,
                          const PoseList& poses) {
  Found all;
  for (const std::vector<double>& pose : poses) {
    const std::vector<Vec3d> normals = rights.of_elements(std::span(pose).first(rights.targets()));
    const auto look = [&](std::size_t n, Found& found) {
      const Vec3d right = rights.of_vertex(vertices[n], normals[element_of_vertex[vertices[n]]]);
      if (!(length(right) > kLeastLength)) return;
      Vec3d shown = rights.stored(vertices[n]);
      for (const auto& [column, delta] : form.of(n)) shown = shown + pose[column] * to_double(delta);
      const double error = max_abs(shown) > 0 ? kDegreesPerRadian * angle_between(shown, right) : 180;
      ++found.count;
      found.sum += error;
      found.worst = std::fmax(found.worst, error);
      const double bin = kBinsPerUnit * std::log(std::fmax(error, kLeast) / kLeast);
      ++found.bins[std::min(kBins - 1, static_cast<std::size_t>(bin))];
    };
    const Found of_pose = parallel_fold<Found>(vertices.size(), kBlock, look, [](Found& to, const Found& each) {
      to.count += each.count;
      to.sum += each.sum;
      to.worst = std::fmax(to.worst, each.worst);
      for (std::size_t b = 0; b < kBins; ++b) to.bins[b] += each.bins[b];
    });
    all.count += of_pose.count;
    all.sum += of_pose.sum;
    all.worst = std::fmax(all.worst, of_pose.worst);
    for (std::size_t b = 0; b < kBins; ++b) all.bins[b] += of_pose.bins[b];
  }
  ShownErrors result{all.count, all.count > 0 ? all.sum / static_cast<double>(all.count) : 0, 0, all.worst};
  std::size_t beyond = all.count / 1000, b = kBins - 1;
  while (b > 0 && all.bins[b] <= beyond) beyond -= all.bins[b--];
  if (b > 0) result.most = std::fmin(kLeast * std::exp(static_cast<double>(b + 1) / kBinsPerUnit), all.worst);
  return result;
}

}  // namespace chronormal::inline internal
