// What hosts keep of normals and deltas.
#include "chronormal/workflow/hosts.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace chronormal {
namespace {

// The nearest 16-bit float, halves away from zero.
float half(float value) noexcept {
  constexpr int kDigits = 11, kLeastExponent = -24;
  constexpr float kLargest = 65504;
  if (!std::isfinite(value) || value == 0) return value;
  int exponent = 0;
  std::frexp(value, &exponent);
  const int last = std::max(exponent - kDigits, kLeastExponent);  // 2^last is the step between neighbours
  const float rounded = std::ldexp(std::round(std::ldexp(value, -last)), last);
  return std::fabs(rounded) > kLargest ? std::copysign(INFINITY, value) : rounded;
}

Vec3f half(const Vec3f& v) noexcept { return {half(v.x), half(v.y), half(v.z)}; }

// Rounds to a signed integer of some bits that stands for [-1, 1], halves away from zero. In 9 to 15 bits it is kept in
// 16, its upper bits once more below it, so that 1 stays 1.
float clamped(float value, int bits) noexcept {
  const int wide = bits <= 8 ? 8 : 16;
  const int lack = wide - bits;
  const float size = std::round(std::fmin(std::fabs(value), 1.0F) * static_cast<float>((1 << (bits - 1)) - 1));
  const int small = std::isnan(value) ? 0 : static_cast<int>(size);
  const int kept = lack == 0 ? small : (small << lack) | (small >> (bits - 1 - lack));
  return std::copysign(static_cast<float>(kept) / static_cast<float>((1 << (wide - 1)) - 1), value);
}

Vec3f clamped(const Vec3f& v, int bits) noexcept {
  return {clamped(v.x, bits), clamped(v.y, bits), clamped(v.z, bits)};
}

struct Octahedral {
  double x = 0, y = 0;  // in [-1, 1]
};

Octahedral to_octahedral(const Vec3d& v) noexcept {
  const double size = std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
  const double x = v.x / size, y = v.y / size;
  if (v.z >= 0) return {x, y};
  return {std::copysign(1 - std::fabs(y), x), std::copysign(1 - std::fabs(x), y)};
}

Vec3d from_octahedral(const Octahedral& o) noexcept {
  const double z = 1 - std::fabs(o.x) - std::fabs(o.y), fold = std::fmax(-z, 0);
  return unit(Vec3d{o.x - std::copysign(fold, o.x), o.y - std::copysign(fold, o.y), z});
}

// The direction of a vector as two unsigned numbers that stand for [-1, 1] keep it, cut off below.
Vec3d through_unsigned_octahedral(const Vec3d& v, int bits) noexcept {
  if (v == Vec3d{} || !is_finite(v)) return v;
  const double most = std::ldexp(1, bits) - 1;
  const auto kept = [&](double value) { return 2 * std::floor((value / 2 + 0.5) * most) / most - 1; };
  const Octahedral o = to_octahedral(v);
  return from_octahedral({kept(o.x), kept(o.y)});
}

// The same of two signed numbers, rounded.
Vec3d through_signed_octahedral(const Vec3d& v, int bits) noexcept {
  if (v == Vec3d{} || !is_finite(v)) return v;
  const double most = std::ldexp(1, bits - 1) - 1;
  const Octahedral o = to_octahedral(v);
  return from_octahedral({std::round(o.x * most) / most, std::round(o.y * most) / most});
}

// The direction of a vector of any length as a host of unit normals keeps it.
Vec3f kept_direction(const Host& host, const Vec3f& v) noexcept {
  const Vec3d direction = unit(to_double(v));
  return to_float(host.bits == 32 ? direction : through_unsigned_octahedral(direction, host.bits));
}

// How many letters have to be put in, left out or replaced to make one word of the other.
std::size_t distance_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

Error no_such_host(std::string_view name) {
  constexpr std::size_t kNear = 2, kLongest = 32;
  std::string names;
  const Host* nearest = nullptr;
  std::size_t least = kNear + 1;
  for (const Host& host : kHosts) {
    names.append(host.name).append(", ");
    const std::size_t distance = name.size() > kLongest ? least : distance_between(name, host.name);
    if (distance < least) {
      least = distance;
      nearest = &host;
    }
  }
  std::string message = std::string("there is no host '").append(name) + "'";
  if (nearest != nullptr) message.append("; did you mean ").append(nearest->name).append("?");
  return Error{ErrorCode::kUsage, "", message.append("; there are ").append(names).append("and all")};
}

}  // namespace

Result<std::vector<Host>> find_hosts(std::string_view names) {
  if (names == "all") return std::vector<Host>(kHosts.begin(), kHosts.end());
  std::vector<Host> hosts;
  for (std::size_t first = 0; first <= names.size();) {
    const std::size_t end = std::min(names.find(',', first), names.size());
    const std::string_view name = names.substr(first, end - first);
    const auto* const found =
        std::find_if(kHosts.begin(), kHosts.end(), [&](const Host& host) { return host.name == name; });
    if (found == kHosts.end()) return no_such_host(name);
    if (std::find(hosts.begin(), hosts.end(), *found) == hosts.end()) hosts.push_back(*found);
    first = end + 1;
  }
  return hosts;
}

Vec3f kept_normal(const Host& host, const Vec3f& normal) noexcept {
  switch (host.normals) {
    case NormalRule::kSum:
      return normal;
    case NormalRule::kUnit:
      return kept_direction(host, normal);
    case NormalRule::kClamped:
      return clamped(host.octahedral_base ? to_float(through_signed_octahedral(to_double(normal), host.bits)) : normal,
                     host.bits);
  }
  return normal;
}

Vec3f kept_delta(const Host& host, const Vec3f& normal, const Vec3f& delta) noexcept {
  switch (host.normals) {
    case NormalRule::kSum:
      return host.keeps_halves() ? half(delta) : delta;
    case NormalRule::kUnit:
      return kept_direction(host, normal + delta) - kept_direction(host, normal);
    case NormalRule::kClamped:
      return clamped(delta, host.bits);
  }
  return delta;
}

void drop_weights(const Host& host, std::span<double> weights) noexcept {
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const bool is_beyond = host.most_targets > 0 && k >= host.most_targets;
    if (is_beyond || std::fabs(weights[k]) <= host.least_weight) weights[k] = 0;
  }
}

Vec3f HostSum::normal() const noexcept { return to_float(unit(to_double(halves_ ? normal_ + half(sum_) : sum_))); }

}  // namespace chronormal
