// Writes a sequence to a GLB file: its targets, the track of their weights, and the mark of the bake in extras.
#include "workflow/bake/sequence/sequence_file.h"
#include "motion/triangles.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <unordered_map>
#include <utility>

#include "chronormal/core/views.h"
#include "core/blocks.h"
#include "core/text.h"
#include "io/bytes/expansion.h"
#include "io/gltf/model/gltf_bake_mark.h"
#include "workflow/bake/sequence/harmless_sequence.h"

namespace chronormal::inline internal {
namespace {

using Json = nlohmann::ordered_json;

SequenceVertices split_vertices(const Topology& topology, const NormalGroups& groups) {
  const std::span<const std::uint32_t> corners = topology.corners();
  SequenceVertices result;
  result.vertex.resize(topology.vertex_count());
  for (std::size_t v = 0; v < result.vertex.size(); ++v) result.vertex[v] = static_cast<std::uint32_t>(v);
  if (groups.outputs_are_vertices()) {
    result.element.assign(groups.element_of_output().begin(), groups.element_of_output().end());
    result.of_corner.assign(corners.begin(), corners.end());
    return result;
  }
  result.element.assign(topology.vertex_count(), SequenceVertices::kNone);
  std::vector<std::uint32_t> next_copy(topology.vertex_count(), SequenceVertices::kNone);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t element = groups.element_of_corner()[c];
    std::uint32_t at = corners[c];
    if (result.element[at] == SequenceVertices::kNone) result.element[at] = element;
    while (result.element[at] != element) {
      if (next_copy[at] == SequenceVertices::kNone) {
        next_copy[at] = static_cast<std::uint32_t>(result.vertex.size());
        result.vertex.push_back(corners[c]);
        result.element.push_back(element);
        next_copy.push_back(SequenceVertices::kNone);
      }
      at = next_copy[at];
    }
    result.of_corner.push_back(at);
  }
  return result;
}

SequenceVertices make_vertices(const Topology& topology, const NormalGroups& groups) {
  SequenceVertices result = split_vertices(topology, groups);
  result.are_of_motion = result.size() == topology.vertex_count();
  std::uint32_t next = 0;
  result.are_elements = result.size() == groups.size() && std::all_of(result.element.begin(), result.element.end(),
                                                                      [&next](std::uint32_t e) { return e == next++; });
  return result;
}

// Computes a vector for each vertex of the file, stores the vectors in `room`, and returns them.
template <class VectorAt>
std::span<const float> fill_vectors(std::size_t count, std::vector<float>& room, const VectorAt& vector_at) {
  constexpr std::size_t kVectorBlock = 8192;
  room.resize(3 * count);
  const auto view = VectorView<float>::packed(room.data(), count);
  parallel_each(count, kVectorBlock, [&](std::size_t i) { view.set(i, vector_at(i)); });
  return room;
}

// Returns the index of segment s in bent_segments, or nothing if the segment has no bend.
std::optional<std::size_t> bend_of_segment(const SequenceTargets& targets, std::size_t s) {
  const auto found = std::lower_bound(targets.bent_segments.begin(), targets.bent_segments.end(), s);
  if (found == targets.bent_segments.end() || *found != s) return std::nullopt;
  return static_cast<std::size_t>(found - targets.bent_segments.begin());
}

// Returns the track for the encoding exact. The weight of each key is a hat: it is 1 at the key and falls to 0 at both
// neighbours. The weight of each bent segment is t (1 - t).
SequenceTrack spline_track(const SequenceTargets& targets, const std::vector<float>& times) {
  enum Row : std::size_t { kIn, kValue, kOut, kRows };
  const auto fill = [&targets, &times](std::size_t row, std::span<float> values) {
    const std::size_t key = row / kRows;
    const auto set_key = [&](std::size_t k, float value) {
      if (k > 0 || targets.has_key_0) values[targets.of_key(k)] = value;
    };
    if (row % kRows == kValue) return set_key(key, 1);
    const bool is_in = row % kRows == kIn;
    if (key == (is_in ? 0 : targets.keys - 1)) return;
    // Computes slopes per second. A viewer computes the length of a segment from the float32 times in the file, so
    // these times are used here too.
    const std::size_t s = is_in ? key - 1 : key;
    const auto slope = static_cast<float>(1 / (double{times[s + 1]} - double{times[s]}));
    set_key(s, -slope);
    set_key(s + 1, slope);
    if (const auto bend = bend_of_segment(targets, s)) values[targets.of_keys() + *bend] = is_in ? -slope : slope;
  };
  return {times, kRows * targets.keys, targets.count(), fill};
}

// Returns the LINEAR track, for all encodings except exact. The weight of each key is a hat: it is 1 at the key and
// falls to 0 at both neighbours. The weight of each bent segment is 4 t (1 - t), which needs more keys in the segment.
SequenceTrack linear_track(const SequenceTargets& targets, const std::vector<float>& times) {
  struct TrackKey {
    std::size_t key;
    double t;
  };
  SequenceTrack track;
  std::vector<TrackKey> rows;
  const auto add = [&](float time, const TrackKey& row) {
    track.times.push_back(time);
    rows.push_back(row);
  };
  for (std::size_t k = 0; k < targets.keys; ++k) {
    add(times[k], {k, 0});
    if (!bend_of_segment(targets, k)) continue;
    const double from = times[k], length = double{times[k + 1]} - from;
    for (std::size_t piece = 1; piece < kBendPieces; ++piece) {
      const auto time = static_cast<float>(from + length * static_cast<double>(piece) / kBendPieces);
      // Skips the key if its time in float32 does not lie between the times of its neighbours.
      if (!(time > track.times.back() && time < times[k + 1])) continue;
      add(time, {k, (double{time} - from) / length});
    }
  }
  track.rows = rows.size();
  track.width = targets.count();
  track.fill = [&targets, rows = std::move(rows)](std::size_t row, std::span<float> values) {
    const auto [key, t] = rows[row];
    const auto set_key = [&](std::size_t k, double weight) {
      if (k > 0 || targets.has_key_0) values[targets.of_key(k)] = static_cast<float>(weight);
    };
    set_key(key, 1 - t);
    if (t == 0) return;
    set_key(key + 1, t);
    values[targets.of_keys() + *bend_of_segment(targets, key)] = static_cast<float>(4 * t * (1 - t));
  };
  return track;
}

// Describes the weight of each bend, t (1 - t) or 4 t (1 - t), as a product of the weights of two keys. If key 0 has no
// target, its weight is 1 minus the sum of the weights of all other keys.
GltfBakeMark mark_of(const SequenceTargets& targets) {
  GltfBakeMark mark{targets.encoding, true, {}};
  mark.author = targets.follow_author;
  const double factor = targets.encoding == BakeEncoding::kHarmless ? 4 : 1;
  for (const std::size_t s : targets.bent_segments) {
    GltfExtraTarget& extra = mark.extras.emplace_back();
    extra.target = targets.of_keys() + mark.extras.size() - 1;
    const std::size_t next = targets.of_key(s + 1);
    if (s > 0 || targets.has_key_0) {
      extra.quadratic.push_back({targets.of_key(s), next, factor});
      continue;
    }
    extra.linear.push_back({next, factor});
    for (std::size_t i = 0; i < targets.of_keys(); ++i) extra.quadratic.push_back({i, next, -factor});
  }
  return mark;
}

}  // namespace

std::span<const float> SequenceVertices::positions(std::span<const float> of_motion, std::vector<float>& room) const {
  if (are_of_motion) return of_motion;
  const auto view = VectorView<const float>::packed(of_motion.data(), of_motion.size() / 3);
  return fill_vectors(size(), room, [&](std::size_t i) { return view[vertex[i]]; });
}

std::span<const float> SequenceVertices::vectors(std::span<const float> of_elements, const Vec3f& none,
                                                 std::vector<float>& room) const {
  if (are_elements) return of_elements;
  const auto view = VectorView<const float>::packed(of_elements.data(), of_elements.size() / 3);
  return fill_vectors(size(), room, [&](std::size_t i) { return element[i] == kNone ? none : view[element[i]]; });
}

SequenceFile::SequenceFile(const Topology& topology, const NormalGroups& groups, std::span<const float> base,
                           std::span<const SequenceElement> elements, const BakeOptions& options, Spool spool)
    : vertices_(make_vertices(topology, groups)),
      topology_(&topology),
      most_bytes_(options.most_bytes),
      dense_zeros_(options.dense_zeros),
      expansion_(options.expansion != nullptr ? *options.expansion : Expansion::unlimited()),
      builder_(options.most_bytes, std::move(spool)) {
  begin(base, elements);
}

void SequenceFile::begin(std::span<const float> base, std::span<const SequenceElement> elements) {
  triangles_ = builder_.set_triangles(cut_polygons(*topology_, base, vertices_.of_corner), vertices_.size());
  base_positions_ = builder_.add_vectors(vertices_.positions(base, room_), {true, true});
  const std::span<const float> normals =
      fill_vectors(elements.size(), rounded_, [elements](std::size_t e) { return to_float(elements[e].normal); });
  base_normals_ = builder_.add_vectors(vertices_.vectors(normals, to_float(kAnyNormal), room_), {false, true});
}

void SequenceFile::restart(std::span<const float> base, std::span<const SequenceElement> elements) {
  Spool spool = std::move(builder_).take_spool();
  spool.clear();
  builder_ = GlbBuilder(most_bytes_, std::move(spool));
  zero_positions_.reset();
  targets_.clear();
  bends_.clear();
  begin(base, elements);
}

std::size_t SequenceFile::zero_positions() {
  if (!zero_positions_)
    zero_positions_ = builder_.add_vectors(std::vector<float>(3 * vertices_.size()), {true, dense_zeros_});
  return *zero_positions_;
}

std::size_t SequenceFile::add_positions(std::span<const float> of_motion) {
  return builder_.add_vectors(vertices_.positions(of_motion, room_), {true, dense_zeros_});
}

std::span<const float> SequenceFile::rounded(std::span<const Vec3d> of_elements) {
  return fill_vectors(of_elements.size(), rounded_, [of_elements](std::size_t e) { return to_float(of_elements[e]); });
}

void SequenceFile::add_key(std::size_t key, std::span<const float> positions, std::span<const float> normals) {
  targets_.push_back(
      target("key " + std::to_string(key), positions.empty() ? zero_positions() : add_positions(positions), normals));
}

void SequenceFile::add_key(std::size_t key, std::span<const float> positions, std::span<const Vec3d> normals) {
  add_key(key, positions, rounded(normals));
}

void SequenceFile::add_bend(std::size_t segment, std::span<const float> normals) {
  bends_.push_back(target("bend " + std::to_string(segment), zero_positions(), normals));
}

void SequenceFile::add_bend(std::size_t segment, std::span<const Vec3d> normals) {
  add_bend(segment, rounded(normals));
}

SequenceFile::Target SequenceFile::target(std::string name, std::size_t positions, std::span<const float> normals) {
  return {std::move(name), positions,
          builder_.add_vectors(vertices_.vectors(normals, Vec3f{}, room_), {false, dense_zeros_})};
}

Status SequenceFile::check(std::uint64_t more) const {
  if (!builder_.status()) return builder_.status();
  if (Status status = expansion_.check(builder_.byte_count() + more, ""); !status) return status;
  if (builder_.byte_count() + more <= builder_.most_bytes()) return Success{};
  return invalid_input("", "the result would have more than " + counted(builder_.most_bytes(), "byte", "bytes") +
                               ", the largest size that is allowed; bake fewer keyframes");
}

Result<std::size_t> SequenceFile::finish(const SequenceTargets& targets, const std::vector<float>& times,
                                         const GlbBuilder::Take& take) {
  const bool exact = targets.encoding == BakeEncoding::kExact;
  const std::uint64_t keys = targets.keys + std::uint64_t{targets.bent_segments.size()} * (exact ? 0 : kBendPieces - 1),
                      weights = keys * targets.count() * (exact ? 3 : 1);
  if (Status status = check(sizeof(float) * (keys + weights)); !status) return status.error();
  std::vector<int> rest(targets_.size() + bends_.size(), 0);
  if (targets.has_key_0) rest[0] = 1;
  return exact ? finish(spline_track(targets, times), "CUBICSPLINE", mark_of(targets), rest, take)
               : finish(linear_track(targets, times), "LINEAR", mark_of(targets), rest, take);
}

Result<std::size_t> SequenceFile::finish(const SequenceTrack& track, std::string_view interpolation,
                                         const GltfBakeMark& bake_mark, const std::vector<int>& rest,
                                         const GlbBuilder::Take& take) {
  const std::size_t input = builder_.add_scalars(track.times, {true, true}),
                    output = builder_.add_table(track.rows, track.width, track.fill);
  std::move(bends_.begin(), bends_.end(), std::back_inserter(targets_));
  // Numbers accessors in the order in which the JSON refers to them.
  std::vector<std::size_t> order;
  std::unordered_map<std::size_t, std::size_t> number_of;
  const auto number = [&](std::size_t accessor) {
    const auto [entry, is_new] = number_of.try_emplace(accessor, order.size() + 1);
    if (is_new) order.push_back(accessor);
    return entry->second;
  };
  const Json attributes = {{"POSITION", number(base_positions_)}, {"NORMAL", number(base_normals_)}};
  Json targets = Json::array(), names = Json::array();
  for (const Target& each : targets_) {
    const std::size_t positions = number(each.positions), normals = number(each.normals);
    targets.push_back({{"POSITION", positions}, {"NORMAL", normals}});
    names.push_back(each.name);
  }
  const Json sampler = {{"input", number(input)}, {"interpolation", interpolation}, {"output", number(output)}};
  builder_.put_in_order(order);
  Json& document = builder_.document();
  document["scene"] = 0;
  document["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
  const Json mark = gltf::bake_mark_json(bake_mark);
  Json node = {{"mesh", 0}};
  if (origin_ != std::array<double, 3>{}) node["translation"] = origin_;
  if (!bake_mark.extras.empty()) node["extras"] = {{"chronormal", mark}};
  document["nodes"] = Json::array({std::move(node)});
  Json primitive = {{"attributes", attributes}, {"indices", triangles_}, {"targets", std::move(targets)}};
  Json mesh = {{"primitives", Json::array({std::move(primitive)})},
               {"weights", rest},
               {"extras", {{"targetNames", std::move(names)}, {"chronormal", mark}}}};
  document["meshes"] = Json::array({std::move(mesh)});
  const Json channel = {{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}};
  document["animations"] =
      Json::array({{{"name", "motion"}, {"samplers", Json::array({sampler})}, {"channels", Json::array({channel})}}});
  return builder_.finish(take);
}

}  // namespace chronormal::inline internal
