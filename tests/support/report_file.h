/// Reads the data of a report (the container of docs/formats.md) as the page of a report does. Splits the container
/// into JSON and arrays, and computes the error that the page shows for a vertex at a sample, in double and from the
/// container alone. This file includes no code of src/.
#ifndef CHRONORMAL_TESTS_SUPPORT_REPORT_FILE_H_
#define CHRONORMAL_TESTS_SUPPORT_REPORT_FILE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chronormal::test {

class ReportFile {
 public:
  using Json = nlohmann::json;
  using Point = std::array<double, 3>;

  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  explicit ReportFile(std::string bytes) : bytes_(std::move(bytes)) {
    if (bytes_.substr(0, 8) != "CHRONRPT" || word(8) != 1) return;
    const std::size_t length = word(12);
    arrays_ = (16 + length + 7) / 8 * 8;
    json = Json::parse(bytes_.substr(16, length));
  }

  Json json;  ///< null if the bytes are not a report

  template <class T>
  [[nodiscard]] std::vector<T> numbers(const Json& array) const {
    constexpr std::string_view kType = sizeof(T) == 8 ? "f64" : std::is_same_v<T, float> ? "f32" : "u32";
    if (array.is_null()) return {};
    if (array.at("type") != kType) throw std::logic_error("an array has another type");
    const auto offset = array.at("offset").get<std::size_t>(), count = array.at("count").get<std::size_t>();
    if (offset % 8 != 0 || arrays_ + offset + count * sizeof(T) > bytes_.size())
      throw std::logic_error("an array does not lie inside");
    std::vector<T> result(count);
    if (count > 0) std::memcpy(result.data(), bytes_.data() + arrays_ + offset, count * sizeof(T));
    return result;
  }

  [[nodiscard]] const Json& part(std::size_t p) const { return json["parts"][p]; }

  /// Returns the angle, in degrees, between the rendered and the true normal at an entry of json["worst"].
  [[nodiscard]] double degrees_at(const Json& place) const {
    const Json& of = part(place["part"]);
    const Json& motion = of["motions"][place["motion"].get<std::size_t>()];
    return of.contains("shown") ? gltf_degrees(of, motion, place["sample"], place["vertex"])
                                : keyframe_degrees(of, motion, place["sample"], place["vertex"]);
  }

  /// Returns the number that the page shows for a vertex: a label if the part has labels, otherwise the index of the
  /// vertex in its primitive.
  [[nodiscard]] std::size_t label(const Json& of, std::size_t vertex) const {
    if (!of["labels"].is_null()) return numbers<std::uint32_t>(of["labels"])[vertex];
    for (const Json& primitive : of["primitives"])
      if (vertex < primitive["first"].get<std::size_t>() + primitive["count"].get<std::size_t>())
        return vertex - primitive["first"].get<std::size_t>();
    return kNone;
  }

 private:
  [[nodiscard]] std::uint32_t word(std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }

  static Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static Point sum(const Point& a, const Point& b, double s = 1) {
    return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
  }
  static Point scaled(const Point& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
  static double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static double length(const Point& a) { return std::sqrt(dot(a, a)); }
  static Point unit(const Point& a) { return length(a) > 0 ? scaled(a, 1 / length(a)) : a; }
  static double angle(const Point& a, const Point& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }
  // Turns v by an angle in radians about an axis. The axis must have length 1.
  static Point turned(const Point& axis, double by, const Point& v) {
    return sum(sum(scaled(v, std::cos(by)), cross(axis, v), std::sin(by)), axis, dot(axis, v) * (1 - std::cos(by)));
  }
  // Turns v by the rotation from the direction of `from` to the direction of `to`, but by at most `most` radians.
  static Point turned(const Point& from, const Point& to, const Point& v, double most = 10) {
    const Point axis = cross(from, to);
    if (length(axis) < 1e-12) return v;
    return turned(unit(axis), std::min(most, angle(from, to)), v);
  }
  static Point at(const std::vector<float>& values, std::size_t i) {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }

  // Returns the normal of an element at these positions, by the weighting of the part. The normal is not scaled to
  // length 1.
  [[nodiscard]] Point normal(const Json& of, const std::vector<Point>& positions, std::uint32_t element) const {
    const std::vector<std::uint32_t> triangles = numbers<std::uint32_t>(of["triangles"]),
                                     elements = numbers<std::uint32_t>(of["element"]),
                                     faces = numbers<std::uint32_t>(of["faces"]),
                                     backs = numbers<std::uint32_t>(of.value("backs", Json()));
    const std::string weighting = of["weighting"];
    Point result = {};
    for (std::size_t t = 0; 3 * t < triangles.size();) {
      // Rebuilds a polygon from the triangles of the fan into which the polygon was cut.
      const std::size_t first = 3 * t;
      std::vector<std::uint32_t> polygon(triangles.begin() + static_cast<std::ptrdiff_t>(3 * t),
                                         triangles.begin() + static_cast<std::ptrdiff_t>(3 * t + 3));
      for (++t; !faces.empty() && 3 * t < triangles.size() && faces[t] == faces[t - 1]; ++t)
        polygon.push_back(triangles[3 * t + 2]);
      for (std::size_t i = 0; i < polygon.size(); ++i)
        if (elements[polygon[i]] == element && std::find(backs.begin(), backs.end(), first + i) == backs.end())
          result = sum(result, term(weighting, positions, polygon, i));
    }
    return result;
  }

  // Returns what a corner of a polygon adds to the normal of its element.
  static Point term(const std::string& weighting, const std::vector<Point>& positions,
                    const std::vector<std::uint32_t>& polygon, std::size_t corner) {
    const auto place = [&](std::size_t i) { return positions[polygon[i % polygon.size()]]; };
    Point area = {};
    for (std::size_t i = 2; i < polygon.size(); ++i)
      area = sum(area, cross(minus(place(i - 1), place(0)), minus(place(i), place(0))));
    const Point e = minus(place(corner + 1), place(corner)),
                f = minus(place(corner + polygon.size() - 1), place(corner));
    if (weighting == "area") return area;
    if (weighting == "uniform") return unit(area);
    if (weighting == "angle") return scaled(unit(area), angle(e, f));
    if (weighting == "area-angle") return scaled(area, angle(e, f));
    if (weighting == "inverse-edges") return scaled(unit(area), 1 / std::sqrt(dot(e, e) * dot(f, f)));
    if (weighting == "inverse-roots") return scaled(unit(area), std::pow(dot(e, e) * dot(f, f), -0.25));
    if (weighting == "max") return scaled(cross(e, f), 1 / (dot(e, e) * dot(f, f)));
    throw std::logic_error("a weighting of no name");
  }

  // Returns the normal that the author of a glTF mesh saw for an element, at these positions and weights.
  [[nodiscard]] Point truth(const Json& of, const std::vector<Point>& positions, const std::vector<double>& weights,
                            std::uint32_t element) const {
    const Point triangles = normal(of, positions, element);
    if (!of.contains("truth")) return triangles;
    const Json &polygons = of["truth"]["polygons"], &offsets = of["truth"]["offsets"];
    Point result = polygons.is_null() ? triangles : polygon_sum(of, positions, element);
    if (!offsets.is_null()) result = with_offset(offsets, positions, weights, element, result);
    return length(result) > 0 ? result : triangles;
  }

  [[nodiscard]] Point polygon_sum(const Json& of, const std::vector<Point>& positions, std::uint32_t element) const {
    const Json& sums = of["truth"];
    const std::vector<std::uint32_t> first = numbers<std::uint32_t>(sums["polygons"]["first"]),
                                     corners = numbers<std::uint32_t>(sums["polygons"]["corners"]),
                                     terms = numbers<std::uint32_t>(sums["terms"]),
                                     elements = numbers<std::uint32_t>(of["element"]);
    std::set<std::size_t> counted;  // the corners that add to the normal, each once
    for (std::size_t i = 0; i < terms.size(); i += 2)
      if (terms[i + 1] == element) counted.insert(terms[i]);
    for (std::size_t c = 0; sums["terms"].is_null() && c < corners.size(); ++c)
      if (elements[corners[c]] == element) counted.insert(c);
    Point result = {};
    for (const std::size_t c : counted) {
      const auto end = std::upper_bound(first.begin(), first.end(), c);
      const std::vector<std::uint32_t> polygon(corners.begin() + *(end - 1), corners.begin() + *end);
      result = sum(result, term(of["weighting"], positions, polygon, c - *(end - 1)));
    }
    return result;
  }

  // Turns a normal n by the author's offset. The offset consists of the angle between n and the result, and of the
  // azimuth (the direction around n) in which to turn.
  [[nodiscard]] Point with_offset(const Json& offsets, const std::vector<Point>& positions,
                                  const std::vector<double>& weights, std::uint32_t element, const Point& n) const {
    const std::vector<std::uint32_t> elements = numbers<std::uint32_t>(offsets["elements"]),
                                     first = numbers<std::uint32_t>(offsets["first"]),
                                     edges = numbers<std::uint32_t>(offsets["edges"]),
                                     references = numbers<std::uint32_t>(offsets["references"]);
    const auto found = std::find(elements.begin(), elements.end(), element);
    if (found == elements.end() || length(n) == 0) return n;
    const auto number = static_cast<std::size_t>(found - elements.begin());
    const Point z = scaled(unit(n), static_cast<double>(numbers<float>(offsets["sides"])[number]));
    double angles = 0, count = 0;
    Point zero = {};  // the direction of azimuth 0
    for (std::size_t i = first[number]; i < first[number + 1]; ++i) {
      const Point edge = minus(positions[edges[2 * i + 1]], positions[edges[2 * i]]);
      if (length(edge) == 0) continue;
      angles += angle(edge, z);
      ++count;
      if (i == first[number] + references[number]) zero = unit(sum(edge, z, -dot(edge, z)));
    }
    if (references[number] == kNone) {
      const auto without = static_cast<std::size_t>(
          std::count(references.begin(), references.begin() + static_cast<std::ptrdiff_t>(number), kNone));
      const std::vector<double> turns = numbers<double>(offsets["turned"]);
      const double* const base = turns.data() + 6 * without;
      zero = turned({base[0], base[1], base[2]}, z, {base[3], base[4], base[5]});
    }
    const std::vector<float> base = numbers<float>(offsets["base"]);
    double x = base[2 * number], y = base[2 * number + 1];
    for (std::size_t k = 0; k < offsets["targets"].size(); ++k) {
      const std::vector<std::uint32_t> indices = numbers<std::uint32_t>(offsets["targets"][k]["indices"]);
      const std::vector<float> changes = numbers<float>(offsets["targets"][k]["changes"]);
      for (std::size_t i = 0; i < indices.size(); ++i) {
        if (indices[i] != number) continue;
        x += weights[k] * static_cast<double>(changes[2 * i]);
        y += weights[k] * static_cast<double>(changes[2 * i + 1]);
      }
    }
    const double alpha = std::min(std::hypot(x, y) * (angles > 0 ? angles / count : 1), std::numbers::pi / 2);
    if (length(zero) == 0) return scaled(z, length(n));
    const Point direction = turned(z, std::atan2(y, x), zero);
    return scaled(turned(unit(cross(z, direction)), alpha, z), length(n));
  }

  static std::vector<Point> points(const std::vector<float>& values) {
    std::vector<Point> result;
    for (std::size_t i = 0; 3 * i < values.size(); ++i) result.push_back(at(values, i));
    return result;
  }

  // Returns the weights of all targets at a sample of a track.
  [[nodiscard]] std::vector<double> weights_at(const Json& track, std::size_t sample, std::size_t targets) const {
    const std::vector<std::uint32_t> moved = numbers<std::uint32_t>(track["targets"]);
    const std::vector<float> values = numbers<float>(track["values"]);
    std::vector<double> weights(targets);
    for (std::size_t i = 0; i < moved.size(); ++i) weights.at(moved[i]) = values.at(sample * moved.size() + i);
    return weights;
  }

  [[nodiscard]] double gltf_degrees(const Json& of, const Json& motion, std::size_t sample, std::size_t vertex) const {
    const std::vector<double> weights = weights_at(motion["weights"][0], sample, of["targets"].size());
    const Json &targets = of["targets"], &shown = of["shown"][0];
    std::vector<Point> base = points(numbers<float>(of["positions"])), now = base;
    Point seen = at(numbers<float>(shown["normals"]), vertex);
    const auto each = [&](const Json& vectors, const char* name, const auto& use) {
      const std::vector<std::uint32_t> indices = numbers<std::uint32_t>(vectors["indices"]);
      const std::vector<float> values = numbers<float>(vectors[name]);
      for (std::size_t i = 0; 3 * i < values.size(); ++i)
        use(vectors["indices"].is_null() ? i : std::size_t{indices[i]}, at(values, i));
    };
    const std::vector<double> none(targets.size());
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const double w = weights[k];
      each(targets[k], "positions", [&](std::size_t v, const Point& delta) { now[v] = sum(now[v], delta, w); });
      each(shown["targets"][k], "deltas", [&](std::size_t v, const Point& delta) {
        if (v == vertex) seen = sum(seen, delta, w);
      });
    }
    const std::uint32_t element = numbers<std::uint32_t>(of["element"])[vertex];
    if (element == kNone) throw std::logic_error("the vertex has no right normal");
    Point from = unit(truth(of, base, none, element)), right = unit(truth(of, now, weights, element));
    const Point stored = unit(at(numbers<float>(of["normals"]), vertex));
    if (dot(from, stored) < 0) {
      from = scaled(from, -1);
      right = scaled(right, -1);
    }
    right = turned(from, stored, right);
    return angle(seen, right) * 180 / std::numbers::pi;
  }

  [[nodiscard]] std::vector<float> keyframe(const Json& list, std::size_t k) const {
    if (list[k].contains("type")) return numbers<float>(list[k]);
    std::vector<float> result = numbers<float>(list[0]);
    const std::vector<std::uint32_t> indices = numbers<std::uint32_t>(list[k]["indices"]);
    const std::vector<float> values = numbers<float>(list[k]["values"]);
    for (std::size_t i = 0; i < indices.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) result[3 * indices[i] + c] = values[3 * i + c];
    return result;
  }

  [[nodiscard]] double keyframe_degrees(const Json& of, const Json& motion, std::size_t sample,
                                        std::size_t vertex) const {
    const Json& keys = of["keyframes"];
    const std::uint32_t segment = numbers<std::uint32_t>(motion["segment"])[sample];
    if (segment == kNone) throw std::logic_error("the keyframes of the sample were left out");
    const std::vector<std::uint32_t> segments = numbers<std::uint32_t>(keys["segments"]);
    const double t = numbers<double>(motion["t"])[sample];
    const std::uint32_t element = numbers<std::uint32_t>(of["element"])[vertex];
    const std::array<std::uint32_t, 2> ends = {segments[2 * segment], segments[2 * segment + 1]};
    const std::vector<Point> first = points(keyframe(keys["positions"], 0)),
                             start = points(keyframe(keys["positions"], ends[0])),
                             end = points(keyframe(keys["positions"], ends[1]));
    std::vector<Point> now = start;
    for (std::size_t v = 0; v < now.size(); ++v) now[v] = sum(scaled(start[v], 1 - t), end[v], t);
    const std::array<Point, 2> geometry = {unit(normal(of, start, element)), unit(normal(of, end, element))};
    Point right = unit(normal(of, now, element)), seen = sum(scaled(geometry[0], 1 - t), geometry[1], t);
    if (!keys["normals"].is_null()) {
      std::array<Point, 2> stored, turns;
      const double most = angle(normal(of, first, element), at(keyframe(keys["normals"], 0), vertex));
      for (std::size_t i = 0; i < 2; ++i) {
        stored[i] = unit(at(keyframe(keys["normals"], ends[i]), vertex));
        turns[i] = turned(geometry[i], stored[i], right, most);
      }
      right = sum(scaled(turns[0], 1 - t), turns[1], t);
      seen = sum(scaled(stored[0], 1 - t), stored[1], t);
    }
    return angle(seen, right) * 180 / std::numbers::pi;
  }

  std::string bytes_;
  std::size_t arrays_ = 0;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_REPORT_FILE_H_
