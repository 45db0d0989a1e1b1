#include "workflow/bake/judge/played_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/quality/kernels/shown_angles.h"
#include "core/blocks.h"
#include "core/portable_math.h"
#include "workflow/bake/judge/played_poses.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kPlayedBlock = 256, kPosesAtOnce = 8, kBetweenKeys = 3, kSteps = 8;
constexpr unsigned kRigSeed = 3;
constexpr double kPhase = 0.61, kLeastLength = 1e-3;
// Errors are counted in bins of a tenth of themselves.
constexpr std::size_t kPlayedBins = 400;
constexpr double kLeast = 1e-12, kBinsPerUnit = 10;

struct Found {
  std::size_t count = 0;
  double sum = 0, worst = 0;
  std::array<std::uint32_t, kPlayedBins> bins{};
};

// Some poses at once, and the right normals there.
struct Batch {
  const RightNormals& rights;
  const Host& host;
  std::span<const SeenPose> poses;
  std::vector<std::vector<Vec3d>> normals;  // of elements
  SkinsInPoses skins;

  // Calls visit(error) for the poses in which the normal of a vertex is judged.
  template <class Visit>
  void visit(std::uint32_t vertex, std::uint32_t element, std::span<const VertexColumns::Entry> entries,
             const Visit& visit) const {
    std::array<Vec3d, kPosesAtOnce> shown;
    const Vec3d base = rights.stored(vertex);
    shown.fill(host.normals == NormalRule::kClamped ? to_double(kept_normal(host, to_float(base))) : base);
    for (const auto& [column, delta] : entries)
      for (std::size_t p = 0; p < poses.size(); ++p) shown[p] = shown[p] + poses[p].weights[column] * to_double(delta);
    std::array<Vec3d, kPosesAtOnce> right;
    for (std::size_t p = 0; p < poses.size(); ++p) right[p] = rights.of_vertex(vertex, normals[p][element]);
    std::array<bool, kPosesAtOnce> is_judged{};
    for (std::size_t p = 0; p < poses.size(); ++p) is_judged[p] = length(right[p]) > kLeastLength;
    if (skins.any()) {
      const SkinsInPoses::Vertex carrying(skins, vertex, 0, poses.size());
      for (std::size_t p = 0; p < poses.size(); ++p) {
        shown[p] = carrying.seen(host.skins, p, shown[p]);
        right[p] = carrying.seen(host.skins, p, right[p]);
        is_judged[p] = is_judged[p] && right[p] != Vec3d{};
      }
    }
    std::array<double, kPosesAtOnce> degrees;
    angles_of_pairs(shown, right, degrees);
    for (std::size_t p = 0; p < poses.size(); ++p)
      if (is_judged[p]) visit(max_abs(shown[p]) > 0 ? degrees[p] : 180);
  }
};

// Calls body(batch) for all poses, one batch after the other.
template <class Body>
void for_batches(const RightNormals& rights, const Host& host, std::span<const SeenPose> poses, const Body& body) {
  for (std::size_t first = 0; first < poses.size(); first += kPosesAtOnce) {
    const std::size_t count = std::min(kPosesAtOnce, poses.size() - first);
    const std::span<const SeenPose> some = poses.subspan(first, count);
    Batch batch{rights, host, some, std::vector<std::vector<Vec3d>>(count), SkinsInPoses(some)};
    parallel_for(count, [&](std::size_t p) {
      batch.normals[p] = rights.of_elements(std::span(some[p].weights).first(rights.targets()));
    });
    body(batch);
  }
}

}  // namespace

std::vector<SeenPose> played_poses(const MeshWeights& weights, const ExtraDrivers& drivers, std::size_t targets,
                                   std::size_t most) {
  std::vector<DrivingTrack> tracks;
  for (std::size_t t = 0; t < weights.tracks.size(); ++t) {
    const WeightTrack& track = weights.tracks[t];
    const ExtendedTrack extended = drivers.extended(weights.names[t], track, std::numeric_limits<double>::infinity());
    // As many instants of the file's own gaps, whatever they were cut into.
    WeightTrack written = as_track(track, extended, drivers.size());
    const double cuts =
        static_cast<double>(written.size()) / static_cast<double>(std::max<std::size_t>(1, track.size()));
    tracks.push_back({std::move(written), weights.ranges[t], cuts});
  }
  std::vector<SeenPose> poses = seen_tracks(tracks, weights.skins, Host{}, kBetweenKeys, kPhase, most);
  const auto append = [&, skin = weights.skins.as_standing()](PoseList list) {
    for (SeenPose& pose : seen_through(std::move(list), skin)) poses.push_back(std::move(pose));
  };
  PoseList standing = drivers.standing(weights.poses);
  standing.resize(std::min(most, standing.size()));
  append(std::move(standing));
  if (weights.is_driven) return poses;
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < targets; ++i) all.push_back(i);
  PoseList alone = alone_poses(all, targets, drivers, kSteps, kPhase);
  const PoseList ends = alone_poses(all, targets, drivers, 1, 0);
  alone.insert(alone.end(), ends.begin(), ends.end());
  PoseList some;
  for (std::size_t n = 0; n < std::min(most, alone.size()); ++n)
    some.push_back(alone[n * alone.size() / std::min(most, alone.size())]);
  append(std::move(some));
  if (!weights.rig) return poses;
  PoseList of_rig = weights.rig->sample(most, kRigSeed);
  for (std::vector<double>& pose : of_rig) pose = drivers.with_extras(std::move(pose));
  append(std::move(of_rig));
  return poses;
}

ShownErrors played_errors(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                          std::span<const std::uint32_t> element_of_vertex, const VertexColumns& form,
                          std::span<const SeenPose> poses, const Host& host) {
  const auto add = [](Found& to, const Found& each) {
    to.count += each.count;
    to.sum += each.sum;
    to.worst = std::fmax(to.worst, each.worst);
    for (std::size_t b = 0; b < kPlayedBins; ++b) to.bins[b] += each.bins[b];
  };
  Found all;
  for_batches(rights, host, poses, [&](const Batch& batch) {
    const auto look = [&](std::size_t n, Found& found) {
      batch.visit(vertices[n], element_of_vertex[vertices[n]], form.of(n), [&](double error) {
        ++found.count;
        found.sum += error;
        found.worst = std::fmax(found.worst, error);
        const double bin = kBinsPerUnit * portable::log(std::fmax(error, kLeast) / kLeast);
        ++found.bins[std::min(kPlayedBins - 1, static_cast<std::size_t>(bin))];
      });
    };
    add(all, parallel_fold<Found>(vertices.size(), kPlayedBlock, look, add));
  });
  ShownErrors result{all.count, all.count > 0 ? all.sum / static_cast<double>(all.count) : 0, 0, all.worst};
  std::size_t beyond = all.count / 1000, b = kPlayedBins - 1;
  while (b > 0 && all.bins[b] <= beyond) beyond -= all.bins[b--];
  if (b > 0) result.most = std::fmin(kLeast * portable::exp(static_cast<double>(b + 1) / kBinsPerUnit), all.worst);
  return result;
}

double least_worst(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                   std::span<const std::uint32_t> element_of_vertex, std::span<const VertexColumns> forms,
                   std::span<const SeenPose> poses) {
  std::vector<double> worst(vertices.size() * forms.size(), 0.0);
  for_batches(rights, Host{}, poses, [&](const Batch& batch) {
    parallel_each(vertices.size(), kPlayedBlock, [&](std::size_t n) {
      for (std::size_t f = 0; f < forms.size(); ++f) {
        double& most = worst[n * forms.size() + f];
        batch.visit(vertices[n], element_of_vertex[vertices[n]], forms[f].of(n),
                    [&](double error) { most = std::fmax(most, error); });
      }
    });
  });
  double result = 0;
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    const auto of_vertex = worst.begin() + static_cast<std::ptrdiff_t>(n * forms.size());
    result = std::fmax(result, *std::min_element(of_vertex, of_vertex + static_cast<std::ptrdiff_t>(forms.size())));
  }
  return result;
}

}  // namespace chronormal::inline internal
