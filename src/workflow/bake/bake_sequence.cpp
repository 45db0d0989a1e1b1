// A host shows normalize(N + sum_k w_k D_k). With hat weights over the keys and t (1 - t) on one bubble for each
// segment that is eq. 41, so that the normals are exact (docs/theory.md, section 15).

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "analysis/end_delta.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/bake.h"
#include "core/blocks.h"
#include "io/gltf/glb_builder.h"
#include "workflow/bake/sequence_normals.h"

namespace chronormal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kNoElement = static_cast<std::uint32_t>(-1);
constexpr Vec3d kAnyNormal{0, 0, 1};  // of elements that have none
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

// Vertices of the file. Those of the motion come first, and behind them their copies, one for each further normal.
struct Outputs {
  std::vector<std::uint32_t> vertex, element;
  std::vector<std::uint32_t> of_corner;
};

Outputs make_outputs(const Topology& topology, const NormalGroups& groups) {
  const std::span<const std::uint32_t> corners = topology.corners();
  Outputs outputs;
  outputs.vertex.resize(topology.vertex_count());
  for (std::size_t v = 0; v < outputs.vertex.size(); ++v) outputs.vertex[v] = static_cast<std::uint32_t>(v);
  if (groups.outputs_are_vertices()) {
    outputs.element.assign(groups.element_of_output().begin(), groups.element_of_output().end());
    outputs.of_corner.assign(corners.begin(), corners.end());
    return outputs;
  }
  outputs.element.assign(topology.vertex_count(), kNoElement);
  std::vector<std::uint32_t> next_copy(topology.vertex_count(), kNoElement);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t element = groups.element_of_corner()[c];
    std::uint32_t at = corners[c];
    if (outputs.element[at] == kNoElement) outputs.element[at] = element;
    while (outputs.element[at] != element) {
      if (next_copy[at] == kNoElement) {
        next_copy[at] = static_cast<std::uint32_t>(outputs.vertex.size());
        outputs.vertex.push_back(corners[c]);
        outputs.element.push_back(element);
        next_copy.push_back(kNoElement);
      }
      at = next_copy[at];
    }
    outputs.of_corner.push_back(at);
  }
  return outputs;
}

// Polygons as fans. (Their normals are those of the polygons all the same.)
std::vector<std::uint32_t> make_triangles(const Topology& topology,
                                          const std::vector<std::uint32_t>& output_of_corner) {
  std::vector<std::uint32_t> triangles;
  std::size_t first = 0;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const std::size_t corners = topology.face(f).size();
    for (std::size_t c = 2; c < corners; ++c)
      triangles.insert(triangles.end(),
                       {output_of_corner[first], output_of_corner[first + c - 1], output_of_corner[first + c]});
    first += corners;
  }
  return triangles;
}

// How many polygons a fan does not fit: one of its triangles looks the other way.
std::size_t count_not_convex(const Topology& topology, const std::vector<float>& positions) {
  const auto at = [&](std::uint32_t v) {
    return to_double(VectorView<const float>::packed(positions.data(), topology.vertex_count())[v]);
  };
  std::size_t count = 0;
  for (std::size_t f = 0; f < topology.face_count() && !topology.all_triangles(); ++f) {
    const auto face = topology.face(f);
    std::vector<Vec3d> triangles;
    Vec3d normal;
    for (std::size_t c = 2; c < face.size(); ++c) {
      triangles.push_back(cross(at(face[c - 1]) - at(face[0]), at(face[c]) - at(face[0])));
      normal = normal + triangles.back();
    }
    const bool turns =
        std::any_of(triangles.begin(), triangles.end(), [&](const Vec3d& n) { return dot(n, normal) < 0; });
    count += turns ? 1 : 0;
  }
  return count;
}

// What the whole sequence says about one element.
struct Element {
  Vec3d normal;             // N: unit, float32
  double scale = 1;         // what its normals are divided by
  bool frees_base = false;  // N is not its normal at key 0: that takes a target of its own
  bool has_none = true;
};

Vec3d rounded(const Vec3d& v) { return to_double(to_float(v)); }

void over_elements(std::size_t count, const std::function<void(std::size_t)>& body) {
  constexpr std::size_t kBlock = 256;
  numbered_blocks(count, kBlock, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) body(e);
  });
}

// Looks at all segments. With N = n_0 / |n_0|, float32 keeps the directions at other keys only where the normals there
// are not much smaller; and where n_0 = 0 there is no such N.
std::vector<Element> examine(const SequenceNormals& normals) {
  constexpr double kMuchSmaller = 0x1p-10, kMuchLarger = 0x1p40, kWidest = 0x1p-60;
  struct Sizes {
    double at_key_0 = 0, smallest = std::numeric_limits<double>::infinity(), largest = 0;  // over the segments
  };
  std::vector<Element> elements(normals.elements());
  std::vector<Sizes> sizes(normals.elements());
  std::vector<Vec3d> from = normals.at_key(0), to;
  for (std::size_t s = 0; s + 1 < normals.keys(); ++s, from.swap(to)) {
    to = normals.at_key(s + 1);
    const std::vector<Vec3d> bends = normals.bends(s);
    over_elements(elements.size(), [&](std::size_t e) {
      const ControlNormals n = with_bend(from[e], to[e], bends[e]);
      if (elements[e].has_none) {
        elements[e].normal = rounded(unit_normal_at(n, 0).vector);
        elements[e].has_none = elements[e].normal == Vec3d{};
      }
      const double size = std::max({length(n.n0), length(n.m), length(n.n1)});
      if (s == 0) sizes[e].at_key_0 = length(n.n0);
      if (size > 0) sizes[e].smallest = std::min(sizes[e].smallest, size);
      sizes[e].largest = std::max(sizes[e].largest, size);
    });
  }
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto& [at_key_0, smallest, largest] = sizes[e];
    if (elements[e].has_none) {
      elements[e].normal = kAnyNormal;
      continue;
    }
    elements[e].frees_base = at_key_0 == 0 || smallest < kMuchSmaller * at_key_0 || largest > kMuchLarger * at_key_0;
    elements[e].scale = elements[e].frees_base ? std::max(smallest, kWidest * largest) : at_key_0;
  }
  return elements;
}

class SequenceWriter {
 public:
  SequenceWriter(const Motion& motion, const BakeOptions& options, const NormalGroups& groups,
                 const SequenceNormals& normals)
      : motion_(motion),
        options_(options),
        normals_(normals),
        outputs_(make_outputs(motion.topology, groups)),
        elements_(examine(normals)),
        exact_(options.encoding.value_or(BakeEncoding::kExact) == BakeEncoding::kExact),
        builder_(options.most_bytes) {}

  [[nodiscard]] Result<SequenceBake> write(std::string& glb) {
    if (const Status status = take_times(); !status) return status.error();
    count_elements();
    write_base();
    Status status = exact_ ? write_exact() : write_endpoint();
    if (!status) return status.error();
    write_document();
    Result<std::string> file = builder_.finish();
    if (!file) return file.error();
    glb = std::move(file).value();
    bake_.keyframes = normals_.keys();
    bake_.vertices = outputs_.vertex.size();
    bake_.targets = key_targets();
    bake_.extra_targets = bubbles_.size();
    bake_.bytes = glb.size();
    return std::move(bake_);
  }

 private:
  [[nodiscard]] std::size_t key_targets() const noexcept { return normals_.keys() - (has_key_0_ ? 0U : 1U); }
  // The target of a key. Precondition: it has one
  [[nodiscard]] std::size_t target_of(std::size_t key) const noexcept { return key - (has_key_0_ ? 0U : 1U); }

  [[nodiscard]] Status take_times() {
    // Times in the file must not be negative.
    const double first = motion_.keyframes[0].time, shift = std::max(-first, 0.0);
    if (shift > 0) bake_.warnings.push_back("time starts at 0 in the file, and not before it");
    for (std::size_t k = 0; k < normals_.keys(); ++k) {
      times_.push_back(static_cast<float>(motion_.keyframes[k].time + shift));
      const bool ascends = k == 0 || times_[k - 1] < times_[k];
      if (!ascends || !std::isfinite(times_[k]))
        return invalid_input("keyframe " + std::to_string(k),
                             "its time is not after that of the one before in float32");
    }
    return Success{};
  }

  void count_elements() {
    std::size_t freed = 0;
    for (const Element& element : elements_) {
      freed += element.frees_base ? 1U : 0U;
      bake_.without_normals += element.has_none ? 1U : 0U;
    }
    has_key_0_ = exact_ && freed > 0;
    if (has_key_0_)
      bake_.warnings.push_back(std::to_string(freed) +
                               " normals cannot start from those of keyframe 0 (no area there, or much less later), so "
                               "that keyframe 0 has a target too, whose weight is 1 at rest");
    for (const std::vector<double>& bounds : normals_.bounds()) {
      for (const double bound : bounds) bake_.largest_error = std::max(bake_.largest_error, kDegreesPerRadian * bound);
    }
  }

  // ---- arrays

  [[nodiscard]] std::vector<float> positions_to_outputs(const std::vector<float>& xyz) const {
    std::vector<float> result(3 * outputs_.vertex.size());
    for (std::size_t i = 0; i < outputs_.vertex.size(); ++i)
      std::copy_n(xyz.begin() + 3 * static_cast<std::ptrdiff_t>(outputs_.vertex[i]), 3,
                  result.begin() + 3 * static_cast<std::ptrdiff_t>(i));
    return result;
  }

  [[nodiscard]] std::vector<float> normals_to_outputs(const std::vector<Vec3d>& of_elements, const Vec3d& none) const {
    std::vector<float> result(3 * outputs_.vertex.size());
    const auto view = VectorView<float>::packed(result.data(), outputs_.vertex.size());
    for (std::size_t i = 0; i < view.count; ++i)
      view.set(i, to_float(outputs_.element[i] == kNoElement ? none : of_elements[outputs_.element[i]]));
    return result;
  }

  void write_base() {
    if (const std::size_t bent = count_not_convex(motion_.topology, motion_.keyframes[0].positions); bent > 0)
      bake_.warnings.push_back(std::to_string(bent) + " polygons are not convex: their triangles overlap in the file");
    triangles_ = builder_.set_triangles(make_triangles(motion_.topology, outputs_.of_corner), outputs_.vertex.size());
    std::vector<Vec3d> base(elements_.size());
    for (std::size_t e = 0; e < base.size(); ++e) base[e] = elements_[e].normal;
    base_ = {{"POSITION", builder_.add_vectors(positions_to_outputs(motion_.keyframes[0].positions), {true, true})},
             {"NORMAL", builder_.add_vectors(normals_to_outputs(base, kAnyNormal), {false, true})}};
    // What targets that move nothing have, all of them.
    const std::vector<float> zeros(3 * outputs_.vertex.size());
    if (exact_) zero_positions_ = builder_.add_vectors(zeros, {true, options_.dense_zeros});
  }

  void add_target(std::size_t position, const std::vector<Vec3d>& deltas) {
    const GltfVectors as{false, options_.dense_zeros};
    targets_.push_back(
        {{"POSITION", position}, {"NORMAL", builder_.add_vectors(normals_to_outputs(deltas, Vec3d{}), as)}});
  }

  void add_key(std::size_t key, const std::vector<Vec3d>& deltas) {
    names_.push_back("key " + std::to_string(key));
    add_target(key == 0
                   ? zero_positions_
                   : builder_.add_vectors(positions_to_outputs(normals_.deltas(key)), {true, options_.dense_zeros}),
               deltas);
  }

  // Refuses as soon as it is too much, and tells how far things are.
  [[nodiscard]] Status step(std::size_t done, std::size_t total) const {
    if (options_.progress) options_.progress(done, total);
    if (builder_.fits()) return Success{};
    return invalid_input("", "the file would have more than " + std::to_string(builder_.most_bytes()) +
                                 " bytes, which is all that it may have");
  }

  // ---- the two encodings

  [[nodiscard]] Status write_exact() {
    const std::size_t segments = normals_.keys() - 1, total = normals_.keys() + segments;
    std::vector<Vec3d> deltas(elements_.size());
    for (std::size_t k = has_key_0_ ? 0 : 1; k < normals_.keys(); ++k) {
      const std::vector<Vec3d> n = normals_.at_key(k);
      over_elements(elements_.size(), [&](std::size_t e) {
        // What is left of rounding N would only fill the file.
        constexpr double kNothing = 0x1p-23;
        const Vec3d delta = (1 / elements_[e].scale) * n[e] - elements_[e].normal;
        deltas[e] = elements_[e].has_none || max_abs(delta) < kNothing ? Vec3d{} : delta;
      });
      add_key(k, deltas);
      if (Status status = step(k + 1, total); !status) return status;
    }
    std::vector<Vec3d> from = normals_.at_key(0), to;
    for (std::size_t s = 0; s < segments; ++s, from.swap(to)) {
      to = normals_.at_key(s + 1);
      const std::vector<Vec3d> bends = normals_.bends(s);
      over_elements(elements_.size(), [&](std::size_t e) {
        // A bend that turns nothing by more than 1e-8 rad is none (degree() has the same limit).
        constexpr double kNothing = 0x1p-28;
        const bool straight = max_abs(bends[e]) <= kNothing * std::max(max_abs(from[e]), max_abs(to[e]));
        deltas[e] = straight ? Vec3d{} : (-1 / elements_[e].scale) * bends[e];
      });
      const bool bent = std::any_of(deltas.begin(), deltas.end(), [](const Vec3d& d) { return d != Vec3d{}; });
      if (bent) {
        bubbles_.push_back(s);
        names_.push_back("bend " + std::to_string(s));
        add_target(zero_positions_, deltas);
      }
      if (Status status = step(normals_.keys() + s + 1, total); !status) return status;
    }
    return Success{};
  }

  // The direction in a segment depends on the ratio of the lengths at its two keys alone, so that every segment can
  // have its own best one: they multiply up.
  [[nodiscard]] Status write_endpoint() {
    constexpr double kShortest = 0x1p-10, kLongest = 0x1p16;  // beyond, float32 sums lose digits
    std::vector<Vec3d> ends(elements_.size()), deltas(elements_.size());
    std::vector<double> errors(elements_.size(), 0.0);
    for (std::size_t e = 0; e < ends.size(); ++e) ends[e] = elements_[e].normal;
    std::vector<Vec3d> from = normals_.at_key(0), to;
    for (std::size_t s = 0; s + 1 < normals_.keys(); ++s, from.swap(to)) {
      to = normals_.at_key(s + 1);
      const std::vector<Vec3d> bends = normals_.bends(s);
      over_elements(elements_.size(), [&](std::size_t e) {
        const ControlNormals n = with_bend(from[e], to[e], bends[e]);
        const Vec3d direction = unit_normal_at(n, 1).vector;
        const Vec3d start = ends[e];
        if (direction != Vec3d{}) {
          const double size = std::clamp(length(start) * best_end_delta(n).scale, kShortest, kLongest);
          deltas[e] = rounded(size * direction - elements_[e].normal);
          ends[e] = elements_[e].normal + deltas[e];
        }
        const double bound = normals_.bounds().empty() ? 0 : normals_.bounds()[s][e];
        errors[e] = std::max(errors[e], largest_line_error(n, start, ends[e]) + bound);
      });
      add_key(s + 1, deltas);
      if (Status status = step(s + 1, normals_.keys() - 1); !status) return status;
    }
    for (const double error : errors)
      bake_.largest_error = std::max(bake_.largest_error, kDegreesPerRadian * std::min(error, std::numbers::pi));
    return Success{};
  }

  // ---- the document

  // What a sampler gives the weights: for each key the weights, or in-tangents, weights and out-tangents.
  [[nodiscard]] std::vector<float> track() const {
    const std::size_t keys = normals_.keys(), n = targets_.size(), rows = exact_ ? 3 : 1;
    std::vector<float> values(keys * rows * n, 0.0F);
    enum Row : std::size_t { kIn, kValue, kOut };
    const auto at = [&](std::size_t key, Row row, std::size_t target) -> float& {
      return values[(key * rows + (exact_ ? std::size_t{row} : 0U)) * n + target];
    };
    for (std::size_t k = has_key_0_ ? 0 : 1; k < keys; ++k) at(k, kValue, target_of(k)) = 1;
    if (!exact_) return values;
    // Per second, with the length of the segment as a reader computes it from the times in the file.
    const auto slope = [&](std::size_t s) {
      return static_cast<float>(1 / (double{times_[s + 1]} - double{times_[s]}));
    };
    for (std::size_t s = 0; s + 1 < keys; ++s) {
      for (const auto& [key, sign] : {std::pair{s, -1.0F}, std::pair{s + 1, 1.0F}}) {
        if (key == 0 && !has_key_0_) continue;
        at(s, kOut, target_of(key)) = sign * slope(s);
        at(s + 1, kIn, target_of(key)) = sign * slope(s);
      }
    }
    for (std::size_t b = 0; b < bubbles_.size(); ++b) {
      const std::size_t s = bubbles_[b], target = key_targets() + b;
      at(s, kOut, target) = slope(s);
      at(s + 1, kIn, target) = -slope(s);
    }
    return values;
  }

  [[nodiscard]] Json mark() const {
    const auto factor = [this](std::size_t key) {
      return key == 0 && !has_key_0_ ? Json("base") : Json(target_of(key));
    };
    Json extras = Json::array();
    for (std::size_t b = 0; b < bubbles_.size(); ++b)
      extras.push_back(
          {{"target", key_targets() + b}, {"factors", Json::array({factor(bubbles_[b]), factor(bubbles_[b] + 1)})}});
    return {{"version", 1}, {"encode", exact_ ? "exact" : "endpoint"}, {"sequence", true}, {"extras", extras}};
  }

  void write_document() {
    const std::size_t input = builder_.add_scalars(times_, {true, true}),
                      output = builder_.add_scalars(track(), {false, true});
    std::vector<int> rest(targets_.size(), 0);
    if (has_key_0_) rest[0] = 1;
    Json& document = builder_.document();
    document["scene"] = 0;
    document["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
    document["nodes"] = Json::array({{{"mesh", 0}}});
    const Json primitive = {{"attributes", base_}, {"indices", triangles_}, {"targets", targets_}};
    const Json mesh = {{"primitives", Json::array({primitive})},
                       {"weights", rest},
                       {"extras", {{"targetNames", names_}, {"chronormal", mark()}}}};
    document["meshes"] = Json::array({mesh});
    const Json sampler = {{"input", input}, {"interpolation", exact_ ? "CUBICSPLINE" : "LINEAR"}, {"output", output}};
    const Json channel = {{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}};
    document["animations"] =
        Json::array({{{"name", "motion"}, {"samplers", Json::array({sampler})}, {"channels", Json::array({channel})}}});
  }

  const Motion& motion_;
  const BakeOptions& options_;
  const SequenceNormals& normals_;
  const Outputs outputs_;
  const std::vector<Element> elements_;
  const bool exact_;
  bool has_key_0_ = false;
  GlbBuilder builder_;
  SequenceBake bake_;
  std::vector<float> times_;
  std::size_t triangles_ = 0, zero_positions_ = 0;  // accessors
  Json base_, targets_ = Json::array();
  std::vector<std::string> names_;
  std::vector<std::size_t> bubbles_;  // segments that have one
};

}  // namespace

Result<SequenceBake> bake_sequence(const Motion& motion, const BakeOptions& options, std::string& glb) {
  const Points points = weld_coincident(motion);
  const Result<NormalGroups> groups =
      options.normal_of_corner.count > 0
          ? NormalGroups::by_split_normals(motion.topology, points, options.normal_of_corner)
      : options.crease_angle == 180 ? NormalGroups::of_vertices(motion.topology, points)
                                    : NormalGroups::by_crease_angle(motion, points, options.crease_angle);
  if (!groups) return groups.error();
  const Result<SequenceNormals> normals = SequenceNormals::make(motion, groups.value(), options.weighting);
  if (!normals) return normals.error();
  return SequenceWriter(motion, options, groups.value(), normals.value()).write(glb);
}

}  // namespace chronormal
