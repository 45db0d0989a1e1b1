#include "chronormal/schemes/scheme.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/charconv.h"
#include "core/nearest.h"
#include "schemes/kernels/curve_kernels.h"
#include "schemes/makers.h"

namespace chronormal {
namespace {

constexpr std::array kDescriptions = {
    SchemeDescription{"recompute", "the normal computed from the positions at t, in float32"},
    SchemeDescription{"polynomial", "the exact normal, a quadratic polynomial in t, scaled to length 1"},
    SchemeDescription{"rational", "the exact normal, divided by its length, which a polynomial in t gives squared"},
    SchemeDescription{"linear", "straight line between the unit normals at both ends"},
    SchemeDescription{"quadratic", "parabola through 3 exact unit normals"},
    SchemeDescription{"cubic", "cubic through 4 exact unit normals"},
    SchemeDescription{"lagrange:K",
                      "polynomial of degree K through K + 1 exact unit normals, K = 1 to 64 (from about "
                      "K = 16 on, float32 limits the accuracy)"},
    SchemeDescription{
        "linear:scaled",
        "straight line between the normals at both ends, the length of one chosen for the smallest error"},
    SchemeDescription{"slerp", "shortest arc between the unit normals at both ends"},
    SchemeDescription{"decasteljau:K",
                      "de Casteljau's algorithm on the sphere, with K exact normals, K = 2 to 32 (default 4)"},
    SchemeDescription{"quaternion:matrix",
                      "quaternion slerp between frames that the matrix M of the paper gives (docs/theory.md)"},
    SchemeDescription{"quaternion:edge",
                      "quaternion slerp between frames whose tangent is along the first edge of the face"},
    SchemeDescription{"quaternion:polar", "quaternion slerp between frames that a polar decomposition gives"},
    SchemeDescription{"quaternion:random:SEED", "quaternion slerp between random frames (the default of SEED is 1)"},
    SchemeDescription{"quaternion:optimal", "quaternion slerp between the frames that give the smallest average error"},
    SchemeDescription{"circle",
                      "circle through the normals at both ends and the exact normal at t = 1/2, at constant speed"},
    SchemeDescription{
        "circle:timed",
        "circle through the normals at both ends and the exact normal at t = 1/2, which it reaches at t = 1/2"},
};

// The two parts of a scheme's name, "family:parameter". The parameter is empty if there is no colon.
struct Name {
  std::string_view family, parameter;

  explicit Name(std::string_view name) {
    const std::size_t colon = name.find(':');
    family = name.substr(0, colon);
    if (colon != std::string_view::npos) parameter = name.substr(colon + 1);
  }
};

std::optional<std::uint64_t> number_in(std::string_view text, std::uint64_t smallest, std::uint64_t largest) {
  std::uint64_t value = 0;
  const auto [end, error] = from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < smallest || value > largest)
    return std::nullopt;
  return value;
}

Error unknown_scheme(std::string_view name) {
  std::string list;
  std::vector<std::string> names;
  for (const SchemeDescription& description : kDescriptions) {
    list.append(list.empty() ? "" : ", ").append(description.name);
    names.emplace_back(description.name);
  }
  const std::string nearest = nearest_name(name, names);
  return {ErrorCode::kUsage, "",
          "there is no scheme '" + std::string(name) +
              (nearest.empty() ? "'; choose one of " : "'; did you mean " + nearest + "? Choose one of ") + list};
}

Error wrong_parameter(std::string_view name, std::string_view what, std::uint64_t smallest, std::uint64_t largest) {
  return {ErrorCode::kUsage, "",
          "scheme '" + std::string(name) + "': " + std::string(what) + " must be a whole number from " +
              std::to_string(smallest) + " to " + std::to_string(largest)};
}

}  // namespace

std::span<const SchemeDescription> scheme_descriptions() noexcept { return kDescriptions; }

Result<std::unique_ptr<Scheme>> make_scheme(std::string_view name) {
  using Made = std::unique_ptr<Scheme>;
  struct Plain {
    std::string_view name;
    Made (*make)();
  };
  static constexpr Plain kPlain[] = {
      {"recompute", make_recompute},
      {"polynomial", make_polynomial},
      {"rational", make_rational},
      {"linear", [] { return make_lagrange(1); }},
      {"quadratic", [] { return make_lagrange(2); }},
      {"cubic", [] { return make_lagrange(3); }},
      {"linear:scaled", make_scaled_linear},
      {"slerp", make_slerp},
      {"decasteljau", [] { return make_de_casteljau(4); }},
      {"quaternion:matrix", make_quaternion_matrix},
      {"quaternion:edge", make_quaternion_edge},
      {"quaternion:polar", make_quaternion_polar},
      {"quaternion:random", [] { return make_quaternion_random(1); }},
      {"quaternion:optimal", make_quaternion_optimal},
      {"circle", make_circle},
      {"circle:timed", make_timed_circle},
  };
  for (const Plain& plain : kPlain) {
    if (plain.name == name) return plain.make();
  }

  const Name parts(name);
  if (parts.family == "lagrange") {
    const auto degree = number_in(parts.parameter, 1, kMaxLagrangeDegree);
    if (!degree) return wrong_parameter(name, "the degree", 1, kMaxLagrangeDegree);
    return make_lagrange(static_cast<std::size_t>(*degree));
  }
  if (parts.family == "decasteljau") {
    const auto count = number_in(parts.parameter, 2, kMaxDeCasteljauNormals);
    if (!count) return wrong_parameter(name, "the number of normals", 2, kMaxDeCasteljauNormals);
    return make_de_casteljau(static_cast<std::size_t>(*count));
  }
  if (parts.family == "quaternion" && parts.parameter.substr(0, 7) == "random:") {
    constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
    const auto seed = number_in(parts.parameter.substr(7), 0, kLargest);
    if (!seed) return wrong_parameter(name, "the seed", 0, kLargest);
    return make_quaternion_random(*seed);
  }
  return unknown_scheme(name);
}

}  // namespace chronormal
