#include "workflow/bake/judge/played_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "analysis/quality/kernels/shown_angles.h"
#include "core/blocks.h"
#include "core/portable_math.h"
#include "workflow/bake/judge/played_poses.h"
#include "workflow/bake/mesh_skins.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kPlayedBlock = 256, kPosesAtOnce = 8, kBetweenKeys = 3, kBetweenSeenKeys = 8, kSteps = 8;
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
  std::vector<std::vector<Vec3d>> normals;     // of elements
  std::vector<std::optional<MeshSkin>> skins;  // as their joints are in each pose

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
    for (std::size_t p = 0; p < poses.size(); ++p) {
      is_judged[p] = length(right[p]) > kLeastLength;
      if (skins[p]) is_judged[p] = carry(*skins[p], vertex, shown[p], right[p]) && is_judged[p];
    }
    std::array<double, kPosesAtOnce> degrees;
    angles_of_pairs(shown, right, degrees);
    for (std::size_t p = 0; p < poses.size(); ++p)
      if (is_judged[p]) visit(max_abs(shown[p]) > 0 ? degrees[p] : 180);
  }

  // Makes of two normals of a vertex what is seen of them; returns whether anything is of the right one.
  bool carry(const MeshSkin& skin, std::uint32_t vertex, Vec3d& shown, Vec3d& right) const {
    const AffineTransform matrix = skin.of_vertex(vertex);
    for (Vec3d* const normal : {&shown, &right}) {
      *normal = skin.carried(host.skins, vertex, matrix, *normal);
      if (!is_finite(*normal)) *normal = {};
    }
    return right != Vec3d{};
  }
};

// Calls body(batch) for all poses, one batch after the other.
template <class Body>
void for_batches(const RightNormals& rights, const Host& host, std::span<const SeenPose> poses, const Body& body) {
  for (std::size_t first = 0; first < poses.size(); first += kPosesAtOnce) {
    const std::size_t count = std::min(kPosesAtOnce, poses.size() - first);
    Batch batch{rights, host, poses.subspan(first, count), std::vector<std::vector<Vec3d>>(count), {}};
    batch.skins.resize(count);
    parallel_for(count, [&](std::size_t p) {
      const SeenPose& pose = batch.poses[p];
      batch.normals[p] = rights.of_elements(std::span(pose.weights).first(rights.targets()));
      if (pose.skin == nullptr) return;
      batch.skins[p] = *pose.skin;
      batch.skins[p]->pose(pose.time, false);
    });
    body(batch);
  }
}

// Gathers poses as they are seen.
class SeenPoses {
 public:
  // Leaves out what looks as the pose before.
  void add(std::vector<double> weights, const MeshSkin* skin, double time) {
    if (skin == nullptr || !skin->moves()) time = 0;
    const bool is_known =
        !all_.empty() && all_.back().weights == weights && all_.back().skin == skin && all_.back().time == time;
    if (!is_known) all_.push_back({std::move(weights), skin, time});
  }
  void append(const std::vector<double>& weights, const MeshSkin* skin) { all_.push_back({weights, skin, 0}); }
  [[nodiscard]] std::vector<SeenPose> take() { return std::move(all_); }

 private:
  std::vector<SeenPose> all_;
};

// Adds what is seen of a track through a skin: at the keys of both and at some instants between, but for those that are
// too many. Returns whether none are.
bool add_seen(const DrivingTrack& driving, const MeshSkin& skin, std::size_t most, SeenPoses& poses) {
  const std::vector<double> keys = keys_of_both(driving.track, skin);
  std::vector<double> times;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    times.push_back(keys[k]);
    for (std::size_t step = 0; k + 1 < keys.size() && step < kBetweenSeenKeys; ++step)
      times.push_back(keys[k] + (static_cast<double>(step) + kPhase) / kBetweenSeenKeys * (keys[k + 1] - keys[k]));
  }
  const WeightTrack& track = driving.track;
  const PlayedTrack played(Host{}, track.keys, track.interpolation, track.targets, driving.animation);
  const std::size_t count = std::min(most, times.size());
  for (std::size_t n = 0; n < count; ++n) {
    const double time = times[n * times.size() / count];
    std::vector<double> weights(track.targets);
    played.at(time, false, weights);
    poses.add(std::move(weights), &skin, time);
  }
  return count == times.size();
}

}  // namespace

std::vector<SeenPose> without_skins(PoseList poses) {
  std::vector<SeenPose> result;
  for (std::vector<double>& pose : poses) result.push_back({std::move(pose)});
  return result;
}

PoseList weights_of(std::span<const SeenPose> poses) {
  PoseList result;
  for (const SeenPose& pose : poses)
    if (result.empty() || pose.skin == nullptr || result.back() != pose.weights) result.push_back(pose.weights);
  return result;
}

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
  const std::vector<PlayedInstant> instants = played_instants(tracks, Host{}, kBetweenKeys, kPhase, most);
  const std::vector<std::optional<MeshSkin>> as_they_are(1);
  SeenPoses poses;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (const auto& skin : weights.skins.of_tracks.empty() ? as_they_are : weights.skins.of_tracks[t]) {
      const MeshSkin* const seen = skin ? &*skin : nullptr;
      if (skin && add_seen(tracks[t], *skin, std::max<std::size_t>(1, most / tracks.size()), poses)) continue;
      for (const PlayedInstant& instant : instants)
        if (instant.track == t) poses.add(instant.weights, seen, instant.time);
    }
  }
  const MeshSkin* const standing = weights.skins.standing ? &*weights.skins.standing : nullptr;
  const PoseList at_rest = drivers.standing(weights.poses);
  for (std::size_t n = 0; n < std::min(most, at_rest.size()); ++n) poses.append(at_rest[n], standing);
  if (weights.is_driven) return poses.take();
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < targets; ++i) all.push_back(i);
  PoseList alone = alone_poses(all, targets, drivers, kSteps, kPhase);
  const PoseList ends = alone_poses(all, targets, drivers, 1, 0);
  alone.insert(alone.end(), ends.begin(), ends.end());
  for (std::size_t n = 0; n < std::min(most, alone.size()); ++n)
    poses.append(alone[n * alone.size() / std::min(most, alone.size())], standing);
  if (!weights.rig) return poses.take();
  for (std::vector<double>& pose : weights.rig->sample(most, kRigSeed))
    poses.append(drivers.with_extras(std::move(pose)), standing);
  return poses.take();
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
