#include "io/gltf/gltf_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "chronormal/motion/motion.h"
#include "core/blocks.h"
#include "core/portable_math.h"
#include "core/rounding.h"
#include "core/text.h"
#include "core/twofold.h"
#include "io/bytes/binary.h"
#include "io/bytes/expansion.h"
#include "io/gltf/gltf_skin.h"
#include "io/gltf/gltf_skinned_part.h"
#include "io/gltf/gltf_weights.h"
#include "io/gltf/model/gltf_model.h"
#include "motion/piece_bounds.h"

namespace chronormal::inline internal {
namespace {

using gltf::WeightCurve;

// The largest number of pieces into which an animation is cut. An animation of a human face that speaks for 15 minutes
// needs some 200,000 pieces at the default tolerance.
constexpr std::size_t kMostPieces = 250000;

// A collector of the primitives of a motion in order, with the targets and tracks that move them.
class Assembly {
 public:
  Assembly(const GltfDocument& document, const GltfMotionOptions& options,
           std::optional<std::size_t> animation = std::nullopt)
      : document_(document), world_(options.world), with_skins_(options.skins), animation_(animation) {}

  void add_mesh(std::optional<std::size_t> node, std::size_t mesh) {
    const std::vector<GltfPrimitive>& primitives = document_.meshes()[mesh].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      if (!primitives[p].has_faces()) continue;
      result_.parts.push_back({node, mesh, p, vertex_count_, primitives[p].vertex_count, 0, 0});
      vertex_count_ += primitives[p].vertex_count;
      const bool moves = world_ && node && !document_.nodes()[*node].has_skin;
      transforms_.push_back(moves ? document_.world_transform(*node) : AffineTransform());
    }
  }

  // Adds the meshes for which wanted() is true. If the motion is wanted in world coordinates, adds each mesh once for
  // every node that carries this mesh.
  template <class Wanted>
  void add_meshes(const Wanted& wanted) {
    if (world_) {
      for (std::size_t n = 0; n < document_.nodes().size(); ++n) {
        if (const auto mesh = document_.nodes()[n].mesh; mesh && wanted(*mesh)) add_mesh(n, *mesh);
      }
      return;
    }
    // A skin belongs to a node, so a mesh is added once for each node that carries it with a skin.
    std::vector<std::vector<std::size_t>> skinned(document_.meshes().size());
    for (std::size_t n = 0; n < document_.nodes().size(); ++n)
      if (is_skinned(n)) skinned[*document_.nodes()[n].mesh].push_back(n);
    for (std::size_t m = 0; m < document_.meshes().size(); ++m) {
      if (!wanted(m)) continue;
      if (skinned[m].empty()) add_mesh(std::nullopt, m);
      for (const std::size_t n : skinned[m]) add_mesh(n, m);
    }
  }

  // Returns true if a skin moves the mesh of a node, and skins are wanted.
  [[nodiscard]] bool is_skinned(std::size_t node) const {
    return with_skins_ && document_.nodes()[node].mesh && document_.nodes()[node].has_skin;
  }
  // Returns the skin of a node for which is_skinned() is true, or nullptr if the skin cannot be read. Each skin is read
  // once.
  [[nodiscard]] std::shared_ptr<const GltfSkin> skin_of(std::size_t node) {
    const auto [posed, is_new] = skins_.try_emplace(node);
    if (!is_new) return posed->second.skin;
    Result<GltfSkin> read = GltfSkin::read(document_, node, animation_);
    if (!read) {
      result_.unread_skins.push_back(read.error());
      return nullptr;
    }
    posed->second.skin = std::make_shared<const GltfSkin>(std::move(read).value());
    posed->second.pose = posed->second.skin->pose(0, false);
    return posed->second.skin;
  }
  // Returns the data of a part whose vertices a skin moves, or nullptr for other parts. Valid after read().
  [[nodiscard]] const GltfSkinnedPart* skinned(std::size_t part) const {
    return skinned_parts_[part] ? &*skinned_parts_[part] : nullptr;
  }
  [[nodiscard]] bool has_skins() const noexcept {
    return std::any_of(skinned_parts_.begin(), skinned_parts_.end(), [](const auto& part) { return part.has_value(); });
  }

  // Moves the joints of all skins to their pose at a time, or just before a jump at this time if just_before is true.
  // Returns true if any joint is not where it was before.
  bool pose(double time, bool just_before) {
    bool has_moved = false;
    for (auto& [node, posed] : skins_) {
      if (!posed.skin || !posed.skin->moves()) continue;
      std::vector<AffineTransform> pose = posed.skin->pose(time, just_before);
      has_moved |= !std::equal(pose.begin(), pose.end(), posed.pose.begin(), [](const auto& a, const auto& b) {
        return a.columns == b.columns && a.offset == b.offset;
      });
      posed.pose = std::move(pose);
    }
    return has_moved;
  }

  // Writes the positions that some vertices of a part have before its skin moves them.
  void unskinned(std::size_t part, std::span<const std::uint32_t> vertices, std::span<const double> weights,
                 std::span<Vec3d> all) const {
    const GltfGeometry& geometry = geometries_[part];
    parallel_each(vertices.size(), kBlockOfCoordinates / 3, [&](std::size_t n) {
      const auto vector = [&](const std::vector<float>& from) {
        return to_double(VectorView<const float>::packed(std::span(from))[vertices[n]]);
      };
      Vec3d sum = vector(geometry.positions);
      for (std::size_t k = 0; k < geometry.targets.size(); ++k) {
        const std::vector<float>& deltas = geometry.targets[k].positions;
        if (weights[k] != 0 && !deltas.empty()) sum = sum + weights[k] * vector(deltas);
      }
      all[vertices[n]] = sum;
    });
  }

  [[nodiscard]] bool empty() const noexcept { return result_.parts.empty(); }
  [[nodiscard]] const std::vector<GltfPart>& parts() const noexcept { return result_.parts; }

  // Checks that the given number of keyframes fits into most_bytes bytes of memory, together with the data from which
  // the keyframes are computed: targets, corners, and other_bytes for weights.
  [[nodiscard]] Status check_memory(std::size_t keyframes, std::size_t most_bytes, std::size_t other_bytes = 0) const {
    constexpr std::size_t kBytesPerVertex = 3 * sizeof(float), kWithResiduals = 3 * (sizeof(float) + sizeof(double));
    const bool all_skinned = std::all_of(parts().begin(), parts().end(), [&](const GltfPart& part) {
      return part.node && is_skinned(*part.node);
    });  // such vertices are rounded to float32, and need no residuals
    constexpr std::size_t kBytesPerCorner = 2 * sizeof(std::uint32_t);
    // Each keyframe also takes memory for its segment and its place on the heap.
    constexpr std::size_t kBytesPerKeyframe = 128;
    std::size_t left = most_bytes;
    bool enough = true;
    const auto take = [&](std::size_t count, std::size_t size) {
      enough = enough && binary::fits(count, size, left);
      if (enough) left -= count * size;
    };
    take(other_bytes, 1);
    take(keyframes, kBytesPerKeyframe);
    for (const GltfPart& part : parts()) {
      const GltfPrimitive& primitive = document_.meshes()[part.mesh].primitives[part.primitive];
      // Neither factor overflows, because each is below 2^40. take() refuses products that are too large.
      take(primitive.targets.size() + 1, kBytesPerVertex * part.vertex_count);
      take(keyframes, (all_skinned ? kBytesPerVertex : kWithResiduals) * part.vertex_count);
      take(primitive.element_count, kBytesPerCorner * (primitive.mode == 4 ? 1 : 3));
    }
    if (!enough)
      return invalid_input(document_.name(), counted(keyframes, "keyframe", "keyframes") + " of " +
                                                 counted(vertex_count_, "vertex", "vertices") +
                                                 " would need more than " + counted(most_bytes, "byte", "bytes") +
                                                 " of memory; split the mesh, or use fewer targets or keys");
    if (Status status = document_.expansion().check(most_bytes - left, document_.name()); !status) return status;
    if (vertex_count_ >= std::numeric_limits<std::uint32_t>::max() / 3)
      return invalid_input(document_.name(),
                           "the mesh has more than " +
                               counted(std::numeric_limits<std::uint32_t>::max() / 3, "vertex", "vertices") +
                               ", which is the most that can be read; split the mesh");
    return Success{};
  }

  // Reads the geometry and the faces of all parts.
  [[nodiscard]] Status read(bool with_targets) {
    std::vector<std::uint32_t> corners;
    // The index of the current body; each mesh of each node is a body.
    std::uint32_t body = 0;
    for (std::size_t p = 0; p < parts().size(); ++p) {
      GltfPart& part = result_.parts[p];
      Result<GltfGeometry> geometry = document_.geometry(part.mesh, part.primitive, {false, with_targets});
      if (!geometry) return geometry.error();
      const bool new_body = p > 0 && (part.mesh != parts()[p - 1].mesh || part.node != parts()[p - 1].node);
      body += new_body ? 1 : 0;
      result_.motion.body_of_vertex.insert(result_.motion.body_of_vertex.end(), part.vertex_count, body);
      part.first_face = corners.size() / 3;
      part.face_count = geometry.value().corners.size() / 3;
      if (normal_matrix(transforms_[p]).mirrored) {
        for (std::size_t c = 0; c + 2 < geometry.value().corners.size(); c += 3)
          std::swap(geometry.value().corners[c + 1], geometry.value().corners[c + 2]);
      }
      for (const std::uint32_t vertex : geometry.value().corners)
        corners.push_back(static_cast<std::uint32_t>(part.first_vertex + vertex));
      geometry.value().corners = {};
      geometries_.push_back(std::move(geometry).value());
      skinned_parts_.emplace_back();
      std::shared_ptr<const GltfSkin> skin = part.node && is_skinned(*part.node) ? skin_of(*part.node) : nullptr;
      if (!skin) continue;
      Result<GltfSkinnedPart> read = GltfSkinnedPart::read(document_, part, std::move(skin));
      if (read)
        skinned_parts_.back() = std::move(read).value();
      else
        result_.unread_skins.push_back(read.error());
    }
    if (corners.empty())
      return invalid_input(document_.name(),
                           "the meshes have no faces, so they have no normals; export meshes with faces");
    Result<Topology> topology = Topology::triangles(vertex_count_, std::move(corners));
    if (!topology) return invalid_input(document_.name(), topology.error().text());
    result_.motion.topology = std::move(topology).value();
    return Success{};
  }

  [[nodiscard]] const GltfGeometry& geometry(std::size_t part) const { return geometries_[part]; }
  [[nodiscard]] const AffineTransform& transform(std::size_t part) const { return transforms_[part]; }

  // Adds a keyframe. weights(part) returns the weights of the targets of a part, as a span of double.
  template <class Weights>
  [[nodiscard]] Status add_keyframe(double time, std::string name, const Weights& weights) {
    std::vector<double> high(3 * vertex_count_), low(3 * vertex_count_);
    for (std::size_t p = 0; p < parts().size(); ++p) {
      const std::size_t first = 3 * parts()[p].first_vertex;
      const std::span<const double> part_weights = weights(p);
      parallel_blocks(3 * parts()[p].vertex_count, kBlockOfCoordinates, [&](IndexRange some) {
        const LongSums sums = coordinates(p, some, part_weights);
        const auto place = static_cast<std::ptrdiff_t>(first + some.first);
        std::copy(sums.high().begin(), sums.high().end(), high.begin() + place);
        std::copy(sums.low().begin(), sums.low().end(), low.begin() + place);
      });
      for (std::size_t i = 0; i < 3 * parts()[p].vertex_count; ++i) {
        if (const char* const fault = binary::coordinate_fault(high[first + i]))
          return invalid_input(document_.name() + ", " + gltf::primitive_pointer(parts()[p].mesh, parts()[p].primitive),
                               std::string("at keyframe ") + std::to_string(result_.motion.keyframes.size()) +
                                   ", vertex " + std::to_string(i / 3) + ": " + fault);
      }
    }
    Motion::Keyframe& keyframe = result_.motion.keyframes.emplace_back();
    keyframe.time = time;
    keyframe.name = std::move(name);
    keyframe.set_positions(high, low);
    if (has_skins()) {
      const auto largest =
          std::max_element(high.begin(), high.end(), [](double a, double b) { return std::fabs(a) < std::fabs(b); });
      largest_ = std::max(largest_, std::fabs(*largest));
    }
    return Success{};
  }

  [[nodiscard]] Motion& motion() noexcept { return result_.motion; }
  void set_curve_error(double error) noexcept { result_.curve_error = error; }

  // Finishes the motion. `beyond` is the number of faces whose normals exceed the tolerance because skins move the
  // faces. key_times has the ends of the intervals that were cut into pieces, and is empty if no interval was cut.
  [[nodiscard]] Result<GltfMotion> finish(std::size_t beyond = 0, std::vector<double> key_times = {}) {
    if (has_skins()) {
      CutPath& cut = result_.cut.emplace();
      cut.skins = true;
      cut.pieces = result_.motion.segments.size();
      cut.segments = key_times.empty() ? cut.pieces : key_times.size() - 1;
      cut.beyond = beyond;
      cut.rounding = kFloatUnitRoundoff * largest_;
    }
    result_.key_times = std::move(key_times);
    if (Status status = validate(result_.motion); !status)
      return invalid_input(std::string(document_.name()).append(", ").append(status.error().place),
                           status.error().message);
    return std::move(result_);
  }
  [[nodiscard]] GltfMotion finish_without_motion() { return std::move(result_); }

 private:
  static constexpr std::size_t kBlockOfCoordinates = 3 * 2048;
  struct PosedSkin {
    std::shared_ptr<const GltfSkin> skin;
    std::vector<AffineTransform> pose;
  };

  // Returns the coordinates of some vertices of a part at the given weights. The coordinates are in the space of the
  // mesh, in the world, or where the skin of the part moves the vertices in its current pose.
  [[nodiscard]] LongSums coordinates(std::size_t part, IndexRange some, std::span<const double> weights) const {
    const GltfGeometry& geometry = geometries_[part];
    LongSums sums(some.count);
    sums.add(1, std::span(geometry.positions).subspan(some.first, some.count));
    for (std::size_t k = 0; k < geometry.targets.size(); ++k) {
      const std::vector<float>& deltas = geometry.targets[k].positions;
      if (weights[k] != 0 && !deltas.empty()) sums.add(weights[k], std::span(deltas).subspan(some.first, some.count));
    }
    sums.settle();
    if (const GltfSkinnedPart* const behind = skinned(part)) {
      const std::vector<AffineTransform>& pose = skins_.at(*parts()[part].node).pose;
      for (std::size_t i = 0; i < some.count; i += 3) {
        const Vec3d before{sums[i].high, sums[i + 1].high, sums[i + 2].high};
        const Vec3f place = to_float(behind->place(pose, (some.first + i) / 3, before));
        sums.set(i, {double{place.x}, 0});
        sums.set(i + 1, {double{place.y}, 0});
        sums.set(i + 2, {double{place.z}, 0});
      }
      return sums;
    }
    const AffineTransform& transform = transforms_[part];
    for (std::size_t i = 0; world_ && i < some.count; i += 3) {
      const Twofold x = sums[i], y = sums[i + 1], z = sums[i + 2];
      const auto placed = [&](double Vec3d::*axis) {
        return Twofold{transform.columns[0].*axis, 0} * x + Twofold{transform.columns[1].*axis, 0} * y +
               Twofold{transform.columns[2].*axis, 0} * z + Twofold{transform.offset.*axis, 0};
      };
      sums.set(i, placed(&Vec3d::x));
      sums.set(i + 1, placed(&Vec3d::y));
      sums.set(i + 2, placed(&Vec3d::z));
    }
    return sums;
  }

  const GltfDocument& document_;
  bool world_, with_skins_;
  std::optional<std::size_t> animation_;
  std::map<std::size_t, PosedSkin> skins_;                     // the key is the node
  std::vector<std::optional<GltfSkinnedPart>> skinned_parts_;  // one for each part
  double largest_ = 0;                                         // largest absolute coordinate, if there are skins
  GltfMotion result_;
  std::size_t vertex_count_ = 0;
  std::vector<GltfGeometry> geometries_;     // one for each part
  std::vector<AffineTransform> transforms_;  // one for each part
};

std::string target_name(const GltfDocument& document, std::size_t target) {
  for (const GltfMesh& mesh : document.meshes()) {
    if (target < mesh.target_names.size()) return mesh.target_names[target];
  }
  return "target " + std::to_string(target);
}

Result<GltfMotion> read_targets(const GltfDocument& document, const GltfMotionOptions& options) {
  Assembly assembly(document, options);
  assembly.add_meshes([&](std::size_t mesh) { return document.meshes()[mesh].target_count > 0; });
  std::size_t target_count = 0;
  for (const GltfPart& part : assembly.parts())
    target_count = std::max(target_count, document.meshes()[part.mesh].target_count);
  if (assembly.empty() || !has_moving_targets(document))
    return invalid_input(
        document.name(),
        options.skins && !document.animations().empty()
            ? "nothing in this file moves by morph targets; choose an animation with --animation"
            : "nothing in this file moves by morph targets; export the shape keys of the mesh as morph targets");
  if (Status status = assembly.check_memory(target_count + 1, options.most_bytes); !status) return status.error();
  if (Status status = assembly.read(true); !status) return status.error();

  std::vector<double> weights(target_count, 0.0);
  const auto same_for_all = [&](std::size_t) { return std::span<const double>(weights); };
  if (Status status = assembly.add_keyframe(0, "base", same_for_all); !status) return status.error();
  for (std::size_t k = 0; k < target_count; ++k) {
    weights[k] = 1;
    if (Status status = assembly.add_keyframe(1, target_name(document, k), same_for_all); !status)
      return status.error();
    weights[k] = 0;
  }
  assembly.motion().connect_as_targets();
  return assembly.finish();
}

// A reader of one animation, with the weight curves of the nodes that it drives and the intervals of time between their
// keys.
class AnimationReader {
 public:
  AnimationReader(const GltfDocument& document, std::size_t animation, const GltfMotionOptions& options)
      : document_(document), animation_(animation), options_(options), assembly_(document, options, animation) {}

  Result<GltfMotion> read() {
    if (Status status = read_curves(); !status) return status.error();
    if (Status status = find_times(); !status) return status.error();
    if (Status status = assembly_.check_memory(keyframes_of(keys_.size()), options_.most_bytes, weight_bytes_); !status)
      return status.error();
    if (Status status = assembly_.read(true); !status) return status.error();
    measure();
    if (Status status = cut(); !status) return status.error();
    for (std::size_t piece = 0; piece + 1 < pieces_.size(); ++piece) {
      if (Status status = add_piece(pieces_[piece], pieces_[piece + 1]); !status) return status.error();
    }
    assembly_.motion().connect(MotionKind::kAnimation);
    return assembly_.finish(beyond_, std::move(keys_));
  }

 private:
  Status read_curves() {
    const std::vector<GltfTrack>& tracks = document_.animations()[animation_].tracks;
    std::map<std::size_t, std::optional<std::size_t>> of_nodes;  // the track that drives the weights of each node
    for (std::size_t t = 0; t < tracks.size(); ++t) of_nodes[tracks[t].node] = t;
    for (std::size_t n = 0; n < document_.nodes().size(); ++n) {
      if (!assembly_.is_skinned(n)) continue;
      const std::shared_ptr<const GltfSkin> skin = assembly_.skin_of(n);
      if (!skin || !skin->moves()) continue;
      of_nodes.try_emplace(n);
      const std::vector<double> times = skin->key_times();
      keys_.insert(keys_.end(), times.begin(), times.end());
      jumps_ |= skin->jumps();
    }
    for (const auto& [node, t] : of_nodes) {
      const std::size_t mesh = document_.nodes()[node].mesh.value();
      const std::size_t first_part = assembly_.parts().size();
      assembly_.add_mesh(node, mesh);
      if (assembly_.parts().size() == first_part) continue;
      if (!t) {
        const std::vector<double>& own = document_.nodes()[node].weights;
        const std::vector<double>& weights = own.empty() ? document_.meshes()[mesh].weights : own;
        curve_of_part_.resize(assembly_.parts().size(), curves_.size());
        curves_.emplace_back(GltfKeys{{}, weights}, GltfInterpolation::kLinear, weights.size());
        continue;
      }
      const GltfTrack& track = tracks[*t];
      const auto known = curve_of_track_.find(track.same_keys_as);
      if (known == curve_of_track_.end()) {
        const std::size_t target_count = document_.meshes()[mesh].target_count;
        const std::size_t per_key = target_count * (track.interpolation == GltfInterpolation::kCubicSpline ? 3 : 1);
        const std::size_t bytes_per_key = (1 + per_key) * (sizeof(double) + sizeof(float));
        const bool enough = binary::fits(track.key_count, bytes_per_key, options_.most_bytes);
        weight_bytes_ = enough ? weight_bytes_ + track.key_count * bytes_per_key : options_.most_bytes + 1;
        if (Status status = assembly_.check_memory(0, options_.most_bytes, weight_bytes_); !status) return status;
        Result<GltfKeys> keys = document_.keys(animation_, *t);
        if (!keys) return keys.error();
        curve_of_track_.emplace(track.same_keys_as, curves_.size());
        curves_.emplace_back(std::move(keys).value(), track.interpolation, target_count);
      }
      curve_of_part_.resize(assembly_.parts().size(), curve_of_track_.at(track.same_keys_as));
    }
    if (assembly_.empty())
      return invalid_input(document_.name() + ", /animations/" + std::to_string(animation_),
                           std::string("the animation drives no morph targets") +
                               (options_.skins ? " and no skin; choose another with --animation"
                                               : "; choose another with --animation, or leave --animation out"));
    return Success{};
  }

  Status find_times() {
    for (const WeightCurve& curve : curves_) keys_.insert(keys_.end(), curve.times().begin(), curve.times().end());
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    if (keys_.size() < 2)
      return invalid_input(document_.name() + ", /animations/" + std::to_string(animation_),
                           "nothing moves in the animation, since its weights have only one key; choose another "
                           "animation with --animation");
    return Success{};
  }

  // Returns an upper bound of the number of keyframes for a number of intervals of time: one keyframe at each end of an
  // interval, or two where weights jump.
  [[nodiscard]] std::size_t keyframes_of(std::size_t pieces) const {
    const bool jump =
        jumps_ || std::any_of(curves_.begin(), curves_.end(), [](const WeightCurve& c) { return c.jumps(); });
    return jump ? 2 * pieces : pieces + 1;
  }

  // Finds reach_ and size_. reach_ is the largest distance by which a weight of 1 moves a vertex, for each target of
  // each part. size_ is the diagonal of the bounding box of all parts.
  void measure() {
    double low[3], high[3];
    std::fill_n(low, 3, std::numeric_limits<double>::infinity());
    std::fill_n(high, 3, -std::numeric_limits<double>::infinity());
    for (std::size_t p = 0; p < assembly_.parts().size(); ++p) {
      const GltfGeometry& geometry = assembly_.geometry(p);
      const AffineTransform& transform = assembly_.transform(p);
      const auto vector = [](const std::vector<float>& values, std::size_t at) {
        return Vec3d{double{values[at]}, double{values[at + 1]}, double{values[at + 2]}};
      };
      for (std::size_t at = 0; at + 2 < geometry.positions.size(); at += 3) {
        const Vec3d position = transform(vector(geometry.positions, at));
        const double coordinates[] = {position.x, position.y, position.z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], coordinates[axis]);
          high[axis] = std::max(high[axis], coordinates[axis]);
        }
      }
      std::vector<double>& reach = reach_.emplace_back();
      for (const GltfGeometry::Target& target : geometry.targets) {
        double longest = 0;
        for (std::size_t at = 0; at + 2 < target.positions.size(); at += 3) {
          const Vec3d way = transform(vector(target.positions, at)) - transform.offset;
          longest = std::max(longest, portable::hypot(way.x, way.y, way.z));
        }
        reach.push_back(longest);
        size_ = std::max(size_, longest);
      }
    }
    // If the base is a single point, the diagonal is 0, so the size of the targets counts instead.
    size_ = std::max(portable::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]), 1e-3 * size_);
  }

  // Returns a bound of the acceleration of any vertex without a skin between two neighbouring keys, in units of the
  // file per second squared.
  [[nodiscard]] double acceleration(double from, double to) const {
    double largest = 0;
    std::vector<double> bounds;
    for (std::size_t p = 0; p < assembly_.parts().size(); ++p) {
      if (assembly_.skinned(p) != nullptr) continue;
      bounds.resize(reach_[p].size());
      curves_[curve_of_part_[p]].curvature(from, to, bounds);
      double sum = 0;
      for (std::size_t k = 0; k < bounds.size(); ++k) sum += bounds[k] * reach_[p][k];
      largest = std::max(largest, sum);
    }
    return largest;
  }

  [[nodiscard]] Error too_many_pieces() const {
    return invalid_input(document_.name() + ", /animations/" + std::to_string(animation_),
                         "the animation bends too much between its keys, so it would need more than " +
                             std::to_string(kMostPieces) + " straight pieces; add keys to the animation");
  }

  // Returns the number of pieces, from `fewest` to `most`, into which an interval between two keys is cut, so that the
  // normals of faces that skins move stay within the tolerance. Also returns the number of faces whose normals exceed
  // the tolerance.
  [[nodiscard]] Pieces pieces_behind_skins(double from, double to, std::size_t fewest, std::size_t most) {
    struct OfParts {
      std::vector<GltfSkinPieces> parts;

      [[nodiscard]] std::vector<std::uint32_t> not_within(const std::vector<std::uint32_t>* faces,
                                                          std::size_t pieces) const {
        std::vector<std::uint32_t> all;
        for (const GltfSkinPieces& part : parts) {
          const std::vector<std::uint32_t> some = part.not_within(faces, pieces);
          all.insert(all.end(), some.begin(), some.end());
        }
        return all;
      }
    } of_parts;
    const double sine = portable::sin(kPathTolerance / kDegreesPerRadian);
    for (std::size_t p = 0; p < assembly_.parts().size(); ++p) {
      const GltfSkinnedPart* const skinned = assembly_.skinned(p);
      if (skinned == nullptr) continue;
      const WeightCurve& curve = curves_[curve_of_part_[p]];
      const GltfGeometry& geometry = assembly_.geometry(p);
      GltfUnskinned before{from, to, {}, {}};
      before.at = [this, p](std::span<const std::uint32_t> vertices, double time, bool just_before,
                            std::span<Vec3d> all) {
        assembly_.unskinned(p, vertices, weights_of(p, time, just_before), all);
      };
      std::vector<double> bends(reach_[p].size());
      curve.curvature(from, to, bends);
      for (std::size_t k = 0; k < bends.size(); ++k) {
        const auto deltas = VectorView<const float>::packed(std::span(geometry.targets[k].positions));
        if (bends[k] == 0 || deltas.count == 0) continue;
        before.bend.resize(deltas.count);
        for (std::size_t v = 0; v < deltas.count; ++v) before.bend[v] += bends[k] * length(to_double(deltas[v]));
      }
      of_parts.parts.emplace_back(*skinned, assembly_.motion().topology, assembly_.parts()[p], std::move(before), sine);
    }
    const Pieces pieces = pieces_for(of_parts, std::max(most, fewest));
    // If joints move so fast that most faces need more pieces than are allowed, the interval gets the largest allowed
    // number.
    const bool is_fast = 2 * pieces.beyond > assembly_.motion().topology.face_count();
    const std::size_t count = std::max({pieces.count, fewest, is_fast ? most : 1});
    return {count, count > pieces.count ? of_parts.not_within(nullptr, count).size() : pieces.beyond};
  }

  // Sets the number of pieces into which each interval between two keys is cut, so that the normals of faces that skins
  // move stay within the tolerance. An interval gets at most options_.most_pieces pieces, or fewer if all keyframes
  // would need more memory than is allowed, but never fewer than its cubic splines need. Counts the faces that stay
  // beyond the tolerance.
  void set_pieces_behind_skins(std::vector<std::size_t>& counts) {
    const std::vector<std::size_t> fewest = counts;
    std::vector<Pieces> pieces(counts.size());
    const auto set = [&](std::size_t most) {
      for (std::size_t k = 0; k < counts.size(); ++k) {
        if (pieces[k].count > most || counts[k] == 0)
          pieces[k] = pieces_behind_skins(keys_[k], keys_[k + 1], fewest[k], most);
        counts[k] = pieces[k].count;
      }
    };
    const auto fits = [&](std::size_t most) {
      std::size_t all = 0;
      for (std::size_t k = 0; k < counts.size(); ++k) all += std::min(counts[k], std::max(most, fewest[k]));
      return assembly_.check_memory(keyframes_of(all), options_.most_bytes, weight_bytes_).ok();
    };
    std::size_t most = std::max<std::size_t>(options_.most_pieces, 1);
    std::fill(counts.begin(), counts.end(), 0);
    set(most);
    if (!fits(most)) {
      while (most > 1 && !fits(most)) --most;
      set(most);
    }
    for (const Pieces& of_interval : pieces) beyond_ += of_interval.beyond;
  }

  // Cuts curves into chords that stay within the tolerance. The distance between a curve and a chord is at most h^2 / 8
  // times the largest acceleration, where h is the duration of the chord.
  Status cut() {
    const double tolerance = options_.curve_tolerance * size_;
    const std::size_t intervals = keys_.size() - 1;
    std::vector<double> accelerations(intervals);
    std::vector<std::size_t> counts(intervals);
    double all = 0;
    for (std::size_t k = 0; k < intervals; ++k) {
      accelerations[k] = acceleration(keys_[k], keys_[k + 1]);
      const double wanted = std::ceil((keys_[k + 1] - keys_[k]) * std::sqrt(accelerations[k] / (8 * tolerance)));
      all += wanted;
      if (!(all <= static_cast<double>(kMostPieces))) return too_many_pieces();
      counts[k] = static_cast<std::size_t>(std::max(wanted, 1.0));
      const std::size_t keyframes = keyframes_of(static_cast<std::size_t>(all));
      if (Status status = assembly_.check_memory(keyframes, options_.most_bytes, weight_bytes_); !status) return status;
    }
    if (assembly_.has_skins()) set_pieces_behind_skins(counts);
    const std::size_t keyframes = keyframes_of(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    if (Status status = assembly_.check_memory(keyframes, options_.most_bytes, weight_bytes_); !status) return status;
    double curve_error = 0;
    for (std::size_t k = 0; k < intervals; ++k) {
      const std::size_t count = counts[k];
      if (count > kMostPieces - std::min(pieces_.size(), kMostPieces)) return too_many_pieces();
      const double from = keys_[k], duration = keys_[k + 1] - from, h = duration / static_cast<double>(count);
      for (std::size_t i = 0; i < count; ++i)
        pieces_.push_back(from + duration * (static_cast<double>(i) / static_cast<double>(count)));
      curve_error = std::max(curve_error, h * h * accelerations[k] / 8);
    }
    pieces_.push_back(keys_.back());
    assembly_.set_curve_error(curve_error);
    return Success{};
  }

  [[nodiscard]] std::vector<double> weights_of(std::size_t part, double time, bool just_before) const {
    std::vector<double> weights(reach_[part].size());
    curves_[curve_of_part_[part]].at(time, just_before, weights);
    return weights;
  }

  [[nodiscard]] std::vector<std::vector<double>> weights_at(double time, bool just_before) const {
    std::vector<std::vector<double>> weights;
    for (std::size_t p = 0; p < assembly_.parts().size(); ++p) weights.push_back(weights_of(p, time, just_before));
    return weights;
  }

  // Adds the keyframes at both ends of an interval of time. The keyframe at the first end exists already, because the
  // previous interval ends there, unless weights or joints jump at this time.
  Status add_piece(double from, double to) {
    const Motion& motion = assembly_.motion();
    for (const auto& [time, just_before] : {std::pair(from, false), std::pair(to, true)}) {
      std::vector<std::vector<double>> weights = weights_at(time, just_before);
      const bool has_moved = assembly_.pose(time, just_before);
      if (!just_before && !motion.keyframes.empty() && weights == last_weights_ && !has_moved) continue;
      last_weights_ = std::move(weights);
      const auto of_part = [&](std::size_t p) { return std::span<const double>(last_weights_[p]); };
      if (Status status = assembly_.add_keyframe(time, "", of_part); !status) return status;
    }
    return Success{};
  }

  const GltfDocument& document_;
  std::size_t animation_;
  const GltfMotionOptions& options_;
  Assembly assembly_;
  std::vector<WeightCurve> curves_;
  // Maps GltfTrack::same_keys_as, which tracks with equal keys share, to the index of their curve in curves_.
  std::map<std::size_t, std::size_t> curve_of_track_;
  std::vector<std::size_t> curve_of_part_;
  std::size_t weight_bytes_ = 0, beyond_ = 0;
  bool jumps_ = false;  // true if joints jump
  // times of the keys, and times at which the intervals begin or end, in seconds
  std::vector<double> keys_, pieces_;
  std::vector<std::vector<double>> reach_;  // one list for each part, with a number for each target
  double size_ = 0;                         // diagonal of the bounding box, in units of the file
  std::vector<std::vector<double>> last_weights_;
};

}  // namespace

Result<std::vector<float>> read_gltf_corner_normals(const GltfDocument& document, const Motion& motion,
                                                    std::span<const GltfPart> parts) {
  const auto corners = motion.topology.corners();
  std::vector<float> result;
  for (const GltfPart& part : parts) {
    const Result<GltfGeometry> geometry = document.geometry(part.mesh, part.primitive, {true, false});
    if (!geometry) return geometry.error();
    const std::vector<float>& normals = geometry.value().normals;
    if (normals.empty()) continue;
    result.resize(3 * corners.size(), 0.0F);
    for (std::size_t c = 3 * part.first_face; c < 3 * (part.first_face + part.face_count); ++c) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        result[3 * c + axis] = normals[3 * (corners[c] - part.first_vertex) + axis];
    }
  }
  return result;
}

bool has_moving_targets(const GltfDocument& document) noexcept {
  for (const GltfMesh& mesh : document.meshes()) {
    for (const GltfPrimitive& primitive : mesh.primitives) {
      const auto& targets = primitive.targets;
      if (primitive.has_faces() &&
          std::any_of(targets.begin(), targets.end(), [](const auto& t) { return t.positions; }))
        return true;
    }
  }
  return false;
}

Result<GltfMotion> read_gltf_motion(const GltfDocument& document, const GltfMotionOptions& options) {
  if (options.animation.empty()) return read_targets(document, options);
  const Result<std::size_t> animation = document.find_animation(options.animation);
  if (!animation) return animation.error();
  return AnimationReader(document, animation.value(), options).read();
}

Result<GltfMotion> read_gltf_mesh(const GltfDocument& document, const GltfMotionOptions& options) {
  Assembly assembly(document, options);
  assembly.add_meshes([](std::size_t) { return true; });
  if (assembly.empty())
    return invalid_input(document.name(),
                         "the file has no mesh with faces, so it has no normals; export a mesh with faces");
  if (Status status = assembly.check_memory(1, options.most_bytes); !status) return status.error();
  if (Status status = assembly.read(true); !status) return status.error();
  const auto default_weights = [&](std::size_t p) {
    return std::span<const double>(document.meshes()[assembly.parts()[p].mesh].weights);
  };
  if (Status status = assembly.add_keyframe(0, document.name(), default_weights); !status) return status.error();
  return assembly.finish_without_motion();
}

}  // namespace chronormal::inline internal
