#include "workflow/truth/author_rule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/blocks.h"
#include "workflow/truth/offset_frame.h"
#include "workflow/truth/stored_keys.h"

namespace chronormal::inline internal {
namespace {

// Limits for accepting a rule (see author_rule.h). kTells and kFollowsRule are angles in degrees. kClear is the largest
// ratio of the distance of a candidate to the distance of the candidate that adds up triangle normals by area.
constexpr double kTells = 0.1, kFollowsRule = 1, kClear = 2.0 / 3;
constexpr double kOff = 0.001;        // degrees: a normal that is farther from its sum does not follow the rule
constexpr double kNothingLeft = 180;  // degrees: the distance if both sides of a sheet add up to zero
constexpr std::size_t kMostKeys = 48, kMostAsked = 5000, kMostFollowers = 20000, kAskedAtOnce = 64;
constexpr std::uint32_t kNoVertex = GltfShading::kNoElement;
// The number of candidates for the author's rule. A candidate adds up the normals of triangles or of quads, over the
// element's own corners or over all corners at its point, with one of the weightings.
constexpr std::size_t kKinds = 4, kCandidates = kKinds * kWeightings.size();

double degrees_between(const Vec3d& a, const Vec3d& b) { return angle_between(a, b) * kDegreesPerRadian; }

// Lists the keys to examine: the base (nullopt), and at most `most` - 1 of the targets that store normals, evenly
// spaced in the order of targets.
std::vector<std::optional<std::size_t>> keys_to_ask(const GltfShading& shading, std::size_t most) {
  const std::vector<std::size_t> targets = targets_with_normals(shading);
  std::vector<std::optional<std::size_t>> keys = {std::nullopt};
  const std::size_t count = std::min(targets.size(), most - 1);
  for (std::size_t i = 0; i < count; ++i) keys.emplace_back(targets[i * targets.size() / count]);
  return keys;
}

StoredKey key_of(const GltfShading& shading, std::optional<std::size_t> target) {
  return target ? StoredKey(shading, *target) : StoredKey(shading);
}

// The side of the surface that the author's normals show at each element: the side of the stored base normal.
class Sides {
 public:
  Sides(const GltfShading& shading, std::span<const std::uint32_t> vertex_of) : other_(vertex_of.size()) {
    const StoredKey base(shading);
    const Topology& topology = shading.set.topology;
    parallel_each(vertex_of.size(), kAskedAtOnce, [&](std::size_t e) {
      if (vertex_of[e] == kNoVertex) return;
      Vec3d sum;
      for (const std::uint32_t f : shading.groups.faces(e))
        sum = sum + twice_vector_area(3, [&](std::size_t c) { return base.position(topology.face(f)[c]); });
      other_[e] = dot(sum, base.normal(vertex_of[e])) < 0 ? 1 : 0;
    });
  }
  [[nodiscard]] Vec3d operator()(std::uint32_t element, const Vec3d& normal) const {
    return other_[element] != 0 ? -normal : normal;
  }

 private:
  std::vector<char> other_;
};

// Returns the edges that leave the point of an element, one edge to each neighbouring point. for_edges(visit) must call
// visit(from, to) for the edges of the element, and may repeat edges.
template <class ForEdges>
std::vector<OffsetEdge> edges_around(const GltfShading& shading, const ForEdges& for_edges) {
  std::vector<OffsetEdge> edges;
  for_edges([&](std::uint32_t from, std::uint32_t to) {
    const std::uint32_t point = shading.point_of_vertex[to];
    const auto is_same = [&](const OffsetEdge& edge) { return shading.point_of_vertex[edge.to] == point; };
    if (std::find_if(edges.begin(), edges.end(), is_same) == edges.end()) edges.push_back({from, to});
  });
  return edges;
}

// Angles in degrees at the stored normals that tell candidates apart: `told` has the angle between each candidate and
// the stored normal, and `spread` the largest angle between a candidate and the sum of triangle normals by area.
struct Distances {
  std::array<std::vector<float>, kCandidates> told;
  std::vector<float> spread;
  // `silent` is the number of stored normals at which all candidates are nearly equal, so that the normals tell
  // nothing. `silent_off` is the number of such normals that are more than kTells degrees from the sum of triangle
  // normals by area.
  std::size_t silent = 0, silent_off = 0;
  std::vector<float> of_silent;  // the angles in degrees between such normals and the sums of triangle normals by area

  void add(const Distances& other) {
    for (std::size_t c = 0; c < kCandidates; ++c)
      told[c].insert(told[c].end(), other.told[c].begin(), other.told[c].end());
    spread.insert(spread.end(), other.spread.begin(), other.spread.end());
    silent += other.silent;
    silent_off += other.silent_off;
    of_silent.insert(of_silent.end(), other.of_silent.begin(), other.of_silent.end());
  }
};

// Returns the value below which the share `share` of the values lies. Changes the order of the values.
double quantile(std::vector<float>& values, double share) {
  if (values.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return static_cast<double>(values[static_cast<std::size_t>(place)]);
}

// Changes a rule around stored normals that do not follow the rule. A change is made only if these normals then follow
// the changed rule.
class Mending {
 public:
  Mending(const GltfShading& shading, Polygons& polygons, Weighting weighting, std::span<const std::uint32_t> vertex_of)
      : shading_(shading),
        polygons_(polygons),
        weighting_(weighting),
        vertex_of_(vertex_of),
        base_(shading),
        whole_(vertex_of.size()),
        off_(vertex_of.size()) {
    constexpr std::size_t kBytes = std::size_t{64} << 20;
    const std::size_t of_key = 12 * shading.element_of_vertex.size() + 1;
    const std::size_t most = std::clamp<std::size_t>(kBytes / of_key, 2, 16);
    for (const std::optional<std::size_t> target : keys_to_ask(shading, most))
      if (target) keys_.emplace_back(shading, *target);
    list_points();
    parallel_each(off_.size(), kAskedAtOnce,
                  [&](std::size_t e) { off_[e] = off(static_cast<std::uint32_t>(e), false); });
  }

  // Makes an element add up all corners at its point, if its stored normals follow that sum but not the sum of its own
  // corners.
  void choose_whole_points() {
    parallel_each(off_.size(), kAskedAtOnce, [&](std::size_t i) {
      if (whole_[i] != 0 || !(off_[i] > kOff)) return;
      const double of_whole = off(static_cast<std::uint32_t>(i), true);
      if (!(of_whole < kFollowsRule && of_whole < 0.25 * off_[i])) return;
      whole_[i] = 1;
      off_[i] = of_whole;
    });
  }

  // Joins triangles to polygons, and splits polygons, if more stored normals then follow the sums of their elements.
  void mend_polygons() {
    constexpr std::size_t kSweeps = 8;
    bool any = true;
    for (std::size_t sweep = 0; sweep < kSweeps && any; ++sweep) {
      any = false;
      for (const GltfPart& part : shading_.parts)
        for (std::size_t t = part.first_face, end = part.first_face + part.face_count; t < end && budget_ > 0; ++t)
          if (is_off(t)) any = mend_at(t, end) || any;
    }
  }

  [[nodiscard]] std::vector<bool> whole_points() const { return {whole_.begin(), whole_.end()}; }

  // Returns the median over all elements of the angle between the stored normal and the sum of face normals, in
  // degrees.
  [[nodiscard]] double distance() const {
    std::vector<float> all;
    for (std::size_t e = 0; e < off_.size(); ++e)
      if (vertex_of_[e] != kNoVertex) all.push_back(static_cast<float>(off_[e]));
    return quantile(all, 0.5);
  }

 private:
  void list_points() {
    const auto corners = shading_.set.topology.corners();
    point_offsets_.assign(shading_.point_of_vertex.size() + 1, 0);
    const auto each = [&](const auto& visit) {
      for (std::uint32_t c = 0; c < corners.size(); ++c)
        if (shading_.at_the_back.empty() || !shading_.at_the_back[c]) visit(shading_.place_of(corners[c]), c);
    };
    each([&](std::uint32_t p, std::uint32_t) { ++point_offsets_[p + 1]; });
    for (std::size_t p = 1; p < point_offsets_.size(); ++p) point_offsets_[p] += point_offsets_[p - 1];
    corners_at_.resize(point_offsets_.back());
    std::vector<std::uint32_t> next(point_offsets_.begin(), point_offsets_.end() - 1);
    each([&](std::uint32_t p, std::uint32_t c) { corners_at_[next[p]++] = c; });
  }

  [[nodiscard]] std::span<const std::uint32_t> corners_of(std::uint32_t element, bool whole) const {
    if (!whole) return shading_.groups.corners(element);
    const std::uint32_t p = shading_.place_of(vertex_of_[element]);
    return {corners_at_.data() + point_offsets_[p], corners_at_.data() + point_offsets_[p + 1]};
  }

  struct Part {
    std::uint32_t polygon = 0;
    std::size_t corner = 0;
    friend bool operator==(const Part&, const Part&) = default;
  };

  [[nodiscard]] Vec3d unit_sum(const std::vector<Part>& parts, const StoredKey& key) const {
    Vec3d sum;
    for (const Part& part : parts) {
      const auto loop = polygons_.corners(part.polygon);
      const Vec3d n = twice_vector_area(loop.size(), [&](std::size_t c) { return key.position(loop[c]); });
      if (n == Vec3d{}) continue;
      const Vec3d here = key.position(loop[part.corner]);
      sum = sum + corner_term(weighting_, n, key.position(loop[(part.corner + 1) % loop.size()]) - here,
                              key.position(loop[(part.corner + loop.size() - 1) % loop.size()]) - here);
    }
    return unit(sum);
  }

  // Returns the largest angle between the stored normals of an element and its sums of face normals, over all keys that
  // turn the element, in degrees. The offset that the stored normal has in the base is applied at each key first. If no
  // key turns the element, returns the angle in the base.
  [[nodiscard]] double off(std::uint32_t element, bool whole) const {
    if (vertex_of_[element] == kNoVertex) return 0;
    // Counts each corner of a polygon once, even if several triangles of the polygon meet there.
    std::vector<Part> parts;
    const auto corners = shading_.set.topology.corners();
    for (const std::uint32_t c : corners_of(element, whole)) {
      const std::uint32_t polygon = polygons_.of_triangle(c / 3);
      const auto loop = polygons_.corners(polygon);
      const Part part{polygon,
                      static_cast<std::size_t>(std::find(loop.begin(), loop.end(), corners[c]) - loop.begin())};
      if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
    }
    const std::uint32_t shown = vertex_of_[element];
    const Vec3d s0 = base_.normal(shown);
    Vec3d z0 = unit_sum(parts, base_);
    if (z0 == Vec3d{} && whole) return kNothingLeft;
    if (z0 == Vec3d{} || s0 == Vec3d{}) return 0;
    const double side = dot(z0, s0) < 0 ? -1 : 1;  // the side of the surface that the author shows
    z0 = side * z0;
    double worst = 0;
    bool any = false;
    std::vector<OffsetEdge> edges;
    for (const StoredKey& key : keys_) {
      if (!key.turns(shown)) continue;
      const Vec3d z = side * unit_sum(parts, key), s = key.normal(shown);
      if (z == Vec3d{} || s == Vec3d{}) continue;
      if (!any) {
        any = true;
        edges = edges_around(shading_, [&](const auto& visit) {
          for (const Part& part : parts) {
            const auto loop = polygons_.corners(part.polygon);
            visit(loop[part.corner], loop[(part.corner + 1) % loop.size()]);
            visit(loop[part.corner], loop[(part.corner + loop.size() - 1) % loop.size()]);
          }
        });
      }
      worst = std::fmax(worst, carried_error(
                                   edges, z0, s0, [&](std::uint32_t v) { return base_.position(v); }, z, s,
                                   [&](std::uint32_t v) { return key.position(v); }));
    }
    return (any ? worst : angle_between(z0, s0)) * kDegreesPerRadian;
  }

  [[nodiscard]] bool is_off(std::size_t triangle) const {
    for (const std::uint32_t v : shading_.set.topology.face(triangle)) {
      const std::uint32_t e = shading_.element_of_vertex[v];
      if (e != kNoVertex && off_[e] > kOff) return true;
    }
    return false;
  }

  // Makes the best polygon whose first triangle is t. Changes nothing and returns false if no such polygon is better
  // than the present polygons.
  bool mend_at(std::size_t t, std::size_t end) {
    constexpr std::size_t kLongest = 130;
    std::size_t best = 0, most = 0;
    std::vector<std::uint32_t> vertices;
    for (std::size_t count = 1; count <= std::min(kLongest, end - t) && budget_ > 0; ++count) {
      for (const std::uint32_t v : shading_.set.topology.face(t + count - 1))
        if (std::find(vertices.begin(), vertices.end(), v) == vertices.end()) vertices.push_back(v);
      if (vertices.size() > 2 * kLongest) break;
      if (vertices.size() != count + 2) continue;
      if (polygons_.of_triangle(t) == t && polygons_.triangle_count(t) == count) continue;
      const std::size_t found = try_run(t, count, false);
      if (found <= most) continue;
      most = found;
      best = count;
    }
    if (best > 0) (void)try_run(t, best, true);
    return best > 0;
  }

  // Returns how many more elements would have stored normals that follow their sums of face normals if `count`
  // triangles from `first` on were one polygon. Elements whose stored normals only come nearer to the sums do not
  // count, since that may be chance.
  std::size_t try_run(std::size_t first, std::size_t count, bool keep) {
    // The first triangle and the number of triangles of each polygon that the run takes apart.
    std::vector<std::pair<std::size_t, std::size_t>> before;
    for (std::size_t t = first; t < first + count; t = before.back().first + before.back().second)
      before.emplace_back(polygons_.of_triangle(t), polygons_.triangle_count(polygons_.of_triangle(t)));
    if (!polygons_.join(first, count)) return 0;
    std::vector<std::uint32_t> elements;
    const auto add = [&](std::uint32_t e) {
      if (e != kNoVertex && std::find(elements.begin(), elements.end(), e) == elements.end()) elements.push_back(e);
    };
    for (std::size_t t = before.front().first; t < before.back().first + before.back().second; ++t)
      for (const std::uint32_t v : shading_.set.topology.face(t)) add(shading_.element_of_vertex[v]);
    std::size_t mended = 0, harmed = 0;
    for (const std::uint32_t e : elements) {
      const double now = off(e, whole_[e] != 0);
      mended += off_[e] > kOff && now <= kOff ? 1U : 0U;
      harmed += off_[e] <= kOff && now > kOff ? 1U : 0U;
      if (keep) off_[e] = now;
    }
    budget_ -= std::min(budget_, elements.size());
    if (!keep) {
      for (const auto& [polygon, triangles] : before) (void)polygons_.join(polygon, triangles);
    }
    return mended - std::min(mended, harmed);
  }

  const GltfShading& shading_;
  Polygons& polygons_;
  Weighting weighting_;
  std::span<const std::uint32_t> vertex_of_;
  StoredKey base_;
  std::vector<StoredKey> keys_;
  std::vector<char> whole_;  // for each element, 1 if it adds up its whole point
  std::vector<double> off_;
  std::vector<std::uint32_t> point_offsets_, corners_at_;
  // The number of elements that may still be tried. This number limits the time that is spent on normals that no
  // polygon corrects.
  std::size_t budget_ = 400000;
};

// The rules by which the author may have computed the normals of a mesh, each compared with the stored normals.
class Candidates {
 public:
  Candidates(const GltfShading& shading, const Polygons& plain, const Polygons& quads,
             std::span<const std::uint32_t> vertex_of)
      : shading_(shading), vertex_of_(vertex_of), base_(shading) {
    const Weighting weighting = Weighting::kArea;
    const std::vector<bool> none(shading.groups.size());
    const bool any_quads = quads.any_joined();
    asked_keys_ = keys_to_ask(shading, kMostKeys);
    std::vector<bool> wanted(shading.groups.size());
    for (const std::optional<std::size_t> target : asked_keys_) {
      followers_.push_back(elements_to_ask(target, kMostFollowers / asked_keys_.size()));
      for (const std::uint32_t e : followers_.back()) wanted[e] = true;
    }
    const bool any_shared = is_any_point_shared();
    const std::vector<bool> has_sides = places_with_sides();
    for (const Polygons* polygons : {&plain, &quads}) {
      if (polygons == &quads && !any_quads) continue;
      of_kinds_.emplace_back(shading, *polygons, weighting, none, wanted);
      sums_of_kind_.push_back(of_kinds_.size() - 1);
      std::vector<bool> several(shading.groups.size());
      for (std::uint32_t e = 0; any_shared && e < several.size(); ++e)
        for (const std::uint32_t f : shading.groups.faces(e))
          if (polygons->of_triangle(f) != polygons->of_triangle(shading.groups.faces(e)[0]))
            several[e] = vertex_of[e] == kNoVertex || has_sides.empty() || !has_sides[shading.place_of(vertex_of[e])];
      if (any_shared) of_kinds_.emplace_back(shading, *polygons, weighting, several, wanted);
      sums_of_kind_.push_back(of_kinds_.size() - 1);
    }
    sides_.emplace(shading, vertex_of);
    for (std::size_t k = 0; k < asked_keys_.size(); ++k)
      ask(asked_keys_[k], elements_to_ask(asked_keys_[k], kMostAsked / asked_keys_.size()));
    std::size_t paired = 0;
    for (std::size_t t = 0; t < shading.set.topology.face_count(); t += quads.triangle_count(t))
      paired += quads.triangle_count(t) == 2 ? 2U : 0U;
    // If more than this share of the triangles is in quads, the mesh was cut from quads. The other triangles are caps
    // and poles, where quads are rare.
    constexpr double kMostly = 0.75;
    is_of_quads_ = static_cast<double>(paired) > kMostly * static_cast<double>(shading.set.topology.face_count());
  }

  [[nodiscard]] std::size_t count() const { return sums_of_kind_.size() * kWeightings.size(); }
  static constexpr std::size_t area() { return 0; }
  [[nodiscard]] static Weighting weighting_of(std::size_t c) { return kWeightings[c % kWeightings.size()].weighting; }
  [[nodiscard]] static bool is_of_polygons(std::size_t c) { return c / kWeightings.size() >= 2; }

  // Returns the candidate with the smallest distance. Compares distances at keys first and, if no candidate is accepted
  // there, distances in the base. The distance of a candidate is the angle in degrees that the share `share` of the
  // normals does not exceed. If the smallest distance is above `clear` times the distance of weighting by area, no
  // candidate is accepted, except weighting by area if or_area is true. Returns nothing if no candidate with a distance
  // of at most `follows` is accepted.
  [[nodiscard]] std::optional<std::size_t> closest(double share, double follows, double clear, bool or_area) {
    for (Distances* of : {&keys_, &of_base_}) {
      if (of->told[0].empty()) continue;
      std::array<double, kCandidates> distance{};
      std::size_t best = area();
      for (std::size_t c = 0; c < count(); ++c) {
        distance[c] = quantile(of->told[c], share);
        if (distance[c] < distance[best]) best = c;
      }
      if (!(distance[best] <= clear * distance[area()])) {
        if (!or_area) continue;
        best = area();
      }
      if (!(distance[best] <= follows)) continue;
      // If several candidates are equally near, the candidate that most normals follow exactly is chosen. If this
      // number is equal too, quads are preferred if the file was cut from quads and has keys. Otherwise triangles and
      // sums over own corners are preferred.
      constexpr double kAlike = 0.003, kAsMany = 0.005, kMostOfAll = 0.75;
      std::size_t found = best;
      double most = -1;
      for (std::size_t c = 0; c < count(); ++c) {
        if (distance[c] > distance[best] + kAlike) continue;
        const auto near = std::count_if(of->told[c].begin(), of->told[c].end(), [](float d) { return d <= kAlike; });
        const double following = static_cast<double>(near) / static_cast<double>(of->told[c].size());
        if (weighting_of(c) != weighting_of(best) && following < kMostOfAll) continue;
        const bool is_cut = of == &keys_ && is_of_quads_ && is_of_polygons(c) && !is_of_polygons(found);
        if (following < most + (is_cut ? -kAsMany : kAsMany)) continue;
        most = std::fmax(most, following);
        found = c;
      }
      distance_ = distance[found];
      telling_ = of->told[0].size();
      spread_ = quantile(of->spread, 0.5);
      return found;
    }
    return std::nullopt;
  }

  // Returns true if most normals at keys do not tell candidates apart, and the others are no farther from the quads from
  // which the file was cut than from the candidate `than`, which adds up triangles.
  [[nodiscard]] bool are_quads_as_good(std::size_t than) {
    if (!is_of_quads_ || keys_.silent <= keys_.told[0].size() || 2 * keys_.silent_off >= keys_.silent) return false;
    return keys_.told[0].empty() || quantile(keys_.told[as_quads(than)], 0.5) <= quantile(keys_.told[than], 0.5);
  }
  // Returns the candidate that differs from a candidate with triangles only in its quads.
  [[nodiscard]] static std::size_t as_quads(std::size_t candidate) { return candidate + 2 * kWeightings.size(); }

  // Returns true if the stored normals were rounded, for example to 12 bits: most of them are near the sums of a
  // candidate, but not equal to them. Some of them then equal other sums by chance.
  [[nodiscard]] bool are_rounded(std::size_t c) const {
    constexpr double kNear = 1;  // degrees
    std::vector<float> all;
    for (const Distances* of : {&keys_, &of_base_})
      for (const std::vector<float>* some : {&of->told[c], &of->of_silent})
        all.insert(all.end(), some->begin(), some->end());
    const double middle = quantile(all, 0.5);
    return middle > 2 * kOff && middle <= kNear;
  }

  // Returns true if all examined elements follow a candidate exactly. Then the rule needs no changes.
  [[nodiscard]] bool do_all_follow(std::size_t c) const {
    if (keys_.silent_off > 0 || of_base_.silent_off > 0) return false;
    const AuthorSums& sums = of_kinds_[sums_of_kind_[c / kWeightings.size()]];
    for (std::size_t k = 0; k < asked_keys_.size(); ++k) {
      const StoredKey key = key_of(shading_, asked_keys_[k]);
      const auto check = [&](std::size_t i, int& off) {
        const std::uint32_t e = followers_[k][i];
        if (!(distance_of(e, asked_keys_[k] ? &key : nullptr, sums, weighting_of(c)) <= kOff)) ++off;
      };
      if (parallel_fold<int>(followers_[k].size(), kAskedAtOnce, check, [](int& all, int each) { all += each; }) > 0)
        return false;
    }
    return true;
  }

  [[nodiscard]] double distance() const { return distance_; }
  [[nodiscard]] std::size_t telling() const { return telling_; }
  [[nodiscard]] double spread() const { return spread_; }

 private:
  // Returns true if some point has several elements, which divide the faces around the point among them.
  [[nodiscard]] bool is_any_point_shared() const {
    std::vector<std::uint32_t> element(shading_.point_of_vertex.size(), kNoVertex);
    for (const std::uint32_t v : shading_.set.topology.corners()) {
      const std::uint32_t e = shading_.element_of_vertex[v];
      std::uint32_t& at_point = element[shading_.point_of_vertex[v]];
      if (at_point != kNoVertex && e != at_point) return true;
      at_point = e;
    }
    return false;
  }

  // Returns true for each place at which the two sides of a sheet meet, because their normals would cancel in a sum
  // over the place. Returns an empty list if there is no such place.
  [[nodiscard]] std::vector<bool> places_with_sides() const {
    std::vector<bool> result;
    if (shading_.place_of_vertex.empty()) return result;
    result.resize(shading_.place_of_vertex.size());
    std::vector<std::uint32_t> point(result.size(), kNoVertex);
    for (std::uint32_t v = 0; v < result.size(); ++v) {
      std::uint32_t& first = point[shading_.place_of(v)];
      if (first == kNoVertex) first = shading_.point_of_vertex[v];
      if (first != shading_.point_of_vertex[v]) result[shading_.place_of(v)] = true;
    }
    return result;
  }

  // Lists about `most` elements whose normals a key turns, evenly spaced among all of these elements.
  [[nodiscard]] std::vector<std::uint32_t> elements_to_ask(std::optional<std::size_t> target, std::size_t most) const {
    const StoredKey key = key_of(shading_, target);
    std::vector<std::uint32_t> elements;
    for (std::uint32_t e = 0; e < vertex_of_.size(); ++e) {
      const std::uint32_t v = vertex_of_[e];
      if (v != kNoVertex && (!target || key.turns(v))) elements.push_back(e);
    }
    const std::size_t step = elements.size() / most + 1;
    std::vector<std::uint32_t> some;
    for (std::size_t i = 0; i < elements.size(); i += step) some.push_back(elements[i]);
    return some;
  }

  void ask(std::optional<std::size_t> target, const std::vector<std::uint32_t>& elements) {
    const StoredKey key = key_of(shading_, target);
    const auto ask_one = [&](std::size_t i, Distances& found) {
      ask_element(elements[i], target ? &key : nullptr, found);
    };
    Distances& all = target ? keys_ : of_base_;
    all.add(parallel_fold<Distances>(elements.size(), kAskedAtOnce, ask_one,
                                     [](Distances& sum, const Distances& each) { sum.add(each); }));
  }

  // Returns the angle in degrees between the stored normal of an element and its normal by one candidate. Returns 0 if
  // the stored normal or the computed normal does not exist.
  [[nodiscard]] double distance_of(std::uint32_t e, const StoredKey* key, const AuthorSums& of,
                                   Weighting weighting) const {
    const auto of_base = [&](std::uint32_t v) { return base_.position(v); };
    const Vec3d s0 = base_.normal(vertex_of_[e]), s = key == nullptr ? s0 : key->normal(vertex_of_[e]);
    const Vec3d z0 = (*sides_)(e, unit(of.at(e, of_base, weighting).normal));
    if (s0 == Vec3d{} || s == Vec3d{} || z0 == Vec3d{}) return 0;
    if (key == nullptr) return degrees_between(s, z0);
    const auto of_key = [&](std::uint32_t v) { return key->position(v); };
    const Vec3d z = (*sides_)(e, unit(of.at(e, of_key, weighting).normal));
    if (z == Vec3d{}) return 0;
    const auto edges = edges_around(shading_, [&](const auto& visit) { of.for_edges(e, visit); });
    return carried_error(edges, z0, s0, of_base, z, s, of_key) * kDegreesPerRadian;
  }

  void ask_element(std::uint32_t e, const StoredKey* key, Distances& found) const {
    const auto of_base = [&](std::uint32_t v) { return base_.position(v); };
    const auto of_key = [&](std::uint32_t v) { return key->position(v); };
    const Vec3d s0 = base_.normal(vertex_of_[e]), s = key == nullptr ? s0 : key->normal(vertex_of_[e]);
    if (s0 == Vec3d{} || s == Vec3d{}) return;
    std::array<Vec3d, kCandidates> sums, base_sums;
    double apart = 0;
    for (std::size_t c = 0; c < count(); ++c) {
      const AuthorSums& of = of_kinds_[sums_of_kind_[c / kWeightings.size()]];
      base_sums[c] = (*sides_)(e, unit(of.at(e, of_base, weighting_of(c)).normal));
      sums[c] = key == nullptr ? base_sums[c] : (*sides_)(e, unit(of.at(e, of_key, weighting_of(c)).normal));
      if (sums[c] == Vec3d{} || base_sums[c] == Vec3d{}) return;
      apart = std::fmax(apart, degrees_between(sums[c], sums[area()]));
    }
    const bool tells = apart > kTells;
    for (std::size_t kind = 0; kind < sums_of_kind_.size(); ++kind) {
      std::vector<OffsetEdge> edges;
      if (key != nullptr)
        edges = edges_around(shading_, [&](const auto& visit) { of_kinds_[sums_of_kind_[kind]].for_edges(e, visit); });
      for (std::size_t w = 0; w < kWeightings.size(); ++w) {
        const std::size_t c = kind * kWeightings.size() + w;
        const double off = key == nullptr ? angle_between(s, sums[c])
                                          : carried_error(edges, base_sums[c], s0, of_base, sums[c], s, of_key);
        if (tells) {
          found.told[c].push_back(static_cast<float>(off * kDegreesPerRadian));
        } else if (c == area()) {
          ++found.silent;
          found.of_silent.push_back(static_cast<float>(off * kDegreesPerRadian));
          found.silent_off += off * kDegreesPerRadian > kTells ? 1U : 0U;
        }
      }
    }
    if (tells) found.spread.push_back(static_cast<float>(apart));
  }

  const GltfShading& shading_;
  std::span<const std::uint32_t> vertex_of_;
  StoredKey base_;
  std::vector<AuthorSums> of_kinds_;
  // For each kind of sum, the index of its sums in of_kinds_. If every point has a single element, the sums over whole
  // points and over own corners are the same object.
  std::vector<std::size_t> sums_of_kind_;
  std::optional<Sides> sides_;
  std::vector<std::optional<std::size_t>> asked_keys_;
  // For each key, the elements that are examined to see if all of them follow a rule.
  std::vector<std::vector<std::uint32_t>> followers_;
  Distances of_base_, keys_;
  bool is_of_quads_ = false;
  double distance_ = 0, spread_ = 0;
  std::size_t telling_ = 0;
};

}  // namespace

FoundRule find_author_rule(const GltfShading& shading) {
  const std::vector<std::uint32_t> vertex_of = vertices_of_elements(shading);
  Polygons plain(shading.set.topology), quads(shading.set.topology);
  FoundRule result;
  AuthorRule& rule = result.rule;
  std::vector<bool> whole(shading.groups.size());
  const bool any_stored = std::any_of(vertex_of.begin(), vertex_of.end(), [&](std::uint32_t v) {
    return v != kNoVertex &&
           (shading.normals[3 * v] != 0 || shading.normals[3 * v + 1] != 0 || shading.normals[3 * v + 2] != 0);
  });
  const Polygons* polygons = &plain;
  if (any_stored) {
    (void)quads.join_quads(shading.parts);
    Candidates candidates(shading, plain, quads, vertex_of);
    const auto accept = [&](std::size_t found, bool is_sure) {
      Polygons& tried = Candidates::is_of_polygons(found) ? quads : plain;
      polygons = &tried;
      rule.weighting = Candidates::weighting_of(found);
      rule.is_followed = true;
      if (candidates.do_all_follow(found) || (is_sure && candidates.are_rounded(found))) return true;
      Mending mending(shading, tried, Candidates::weighting_of(found), vertex_of);
      mending.choose_whole_points();
      mending.mend_polygons();
      mending.choose_whole_points();
      if (is_sure || mending.distance() <= kFollowsRule) {
        whole = mending.whole_points();
        return true;
      }
      polygons = &plain;
      rule.is_followed = false;
      return false;
    };
    // A rule that a tenth of the normals follow exactly is the rule of the mesh, even if most of the mesh was cut or
    // bent later.
    constexpr double kTenth = 0.1, kExactly = 0.003, kMuchClearer = 1.0 / 3;
    std::optional<std::size_t> found = candidates.closest(kTenth, kExactly, kMuchClearer, false);
    if (!found || !accept(*found, false)) {
      found = candidates.closest(0.5, kFollowsRule, kClear, true);
      const std::size_t of_triangles = found.value_or(candidates.area());
      if (!Candidates::is_of_polygons(of_triangles) && candidates.are_quads_as_good(of_triangles))
        found = Candidates::as_quads(of_triangles);
      if (found) (void)accept(*found, true);
    }
    rule.distance = candidates.distance();
    rule.spread = candidates.spread();
    rule.telling = candidates.telling();
  }
  rule.any_polygons = polygons->any_joined();
  rule.any_whole_point = std::find(whole.begin(), whole.end(), true) != whole.end();
  if (!rule.is_plain() || !targets_with_normals(shading).empty())
    result.sums = AuthorSums(shading, *polygons, rule.weighting, whole);
  return result;
}

}  // namespace chronormal::inline internal
