// A vertex is judged by what its form adds up to in each pose, as each kind of host keeps the deltas. Poses are columns
// of weights side by side, so that a delta is added to many poses in one loop over memory.
#include "workflow/bake/judge/host_judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "analysis/quality/kernels/shown_angles.h"
#include "core/blocks.h"
#include "workflow/bake/judge/error_spread.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 32;
constexpr int kFineBits = 16;
constexpr std::size_t kMostRounded = 32;  // poses in which rounding is measured
constexpr auto kDegrees = static_cast<float>(kDegreesPerRadian);

bool is_rounding(const Host& host) { return host.normals == NormalRule::kClamped && host.bits < kFineBits; }

// Whether all hosts that do not round show the same of these deltas.
bool is_plain(const Vec3f& normal, std::span<const VertexColumns::Entry> entries) {
  const auto is_unit = [](const Vec3f& v) { return std::fabs(dot(v, v) - 1) < 1e-4F; };
  if (entries.empty()) return true;
  return is_unit(normal) && std::all_of(entries.begin(), entries.end(), [&](const VertexColumns::Entry& entry) {
           return max_abs(to_double(entry.delta)) <= 1 && is_unit(normal + entry.delta);
         });
}

// The weights of poses, for each column side by side, and between which poses it has any: where targets are judged
// alone, most columns have none in most poses.
class PoseWeights {
 public:
  explicit PoseWeights(const PoseList& poses)
      : poses_(poses.size()), active_(poses.empty() ? 0 : poses[0].size()), weights_(poses_ * active_.size()) {
    for (std::size_t p = 0; p < poses_; ++p) {
      for (std::size_t c = 0; c < active_.size(); ++c) {
        const auto weight = static_cast<float>(poses[p][c]);
        weights_[c * poses_ + p] = weight;
        if (weight == 0) continue;
        IndexRange& active = active_[c];
        if (active.count == 0) active.first = p;
        active.count = p + 1 - active.first;
      }
    }
  }

  // (poses)
  [[nodiscard]] const float* of(std::size_t column) const { return weights_.data() + column * poses_; }
  // Beyond these poses the column has no weight.
  [[nodiscard]] const IndexRange& active(std::size_t column) const { return active_[column]; }

 private:
  std::size_t poses_;
  std::vector<IndexRange> active_;
  std::vector<float> weights_;
};

// Sums of one vertex in many poses.
class Sums {
 public:
  void add_up(const Host& host, const Vec3f& normal, std::span<const VertexColumns::Entry> entries,
              const PoseWeights& weights, std::size_t first, std::size_t count) {
    const Vec3f base = kept_normal(host, normal);
    x_.assign(count, base.x);
    y_.assign(count, base.y);
    z_.assign(count, base.z);
    for (const auto& [column, delta] : entries) {
      const IndexRange& active = weights.active(column);
      const std::size_t begin = std::max(active.first, first), end = std::min(active.end(), first + count);
      if (begin >= end) continue;
      const Vec3f kept = kept_delta(host, normal, base, delta);
      const float* const w = weights.of(column) + first;
      for (std::size_t p = begin - first; p < end - first; ++p) {
        x_[p] += w[p] * kept.x;
        y_[p] += w[p] * kept.y;
        z_[p] += w[p] * kept.z;
      }
    }
  }

  // Makes of the sums what is seen of them.
  void carry(const SkinsInPoses::Vertex& carrying, SkinRule rule) {
    for (std::size_t p = 0; p < x_.size(); ++p) {
      const Vec3f seen = to_float(carrying.seen(rule, p, to_double(at(p))));
      x_[p] = seen.x;
      y_[p] = seen.y;
      z_[p] = seen.z;
    }
  }

  // Writes the angles to the right normals in degrees; negative where one is not known.
  void angles_to(std::span<const Vec3f> right, std::span<float> degrees) {
    across_.resize(right.size());
    along_.resize(right.size());
    angles_.resize(right.size());
    for (std::size_t p = 0; p < right.size(); ++p) {
      const Vec3f shown = at(p), aside = cross(shown, right[p]);
      across_[p] = static_cast<double>(std::sqrt(dot(aside, aside)));
      along_[p] = static_cast<double>(dot(shown, right[p]));
    }
    upper_angles(across_, along_, angles_);
    for (std::size_t p = 0; p < right.size(); ++p) {
      const float angle = kDegrees * static_cast<float>(angles_[p]);
      degrees[p] = right[p] == Vec3f{} ? -1 : (at(p) == Vec3f{} || !std::isfinite(angle)) ? 180 : angle;
    }
  }

 private:
  [[nodiscard]] Vec3f at(std::size_t p) const { return {x_[p], y_[p], z_[p]}; }

  std::vector<float> x_, y_, z_;
  std::vector<double> across_, along_, angles_;
};

// The errors of the stored forms and of the chosen ones, in each kind of host.
struct GatheredPairs {
  GatheredPairs(std::size_t kinds, std::size_t vertices) {
    for (std::size_t kind = 0; kind < kinds; ++kind) {
      before.emplace_back(vertices);
      after.emplace_back(vertices);
    }
  }

  // errors has those of the stored form at all poses, and then those of the chosen one.
  void add(std::size_t vertex, std::size_t kind, std::span<const float> errors) {
    const std::span<const float> then = errors.first(errors.size() / 2), now = errors.last(errors.size() / 2);
    before[kind].add(vertex, then, then);
    after[kind].add(vertex, now, then);
  }

  std::deque<GatheredErrors> before, after;  // they cannot be moved
};

// Notes the vertices that make mixed poses worse than before, as a whole: all that grew in the mean, where that did;
// and those that grew into the upper half of what 99.9 % were below, since other poses would find more of them. Where
// 99.9 % are now below that half, there is room for these, but not for what grew beyond what 99.9 % were below. Where
// there are now no more of these than before, a vertex that is nearer in the mean may be farther off at worst, as long
// as it is not the worst of all.
void note_what_makes_worse(const GatheredErrors& before, const GatheredErrors& after, double tolerance,
                           std::vector<char>& noted) {
  const ShownErrors then = before.spread().errors(), now = after.spread().errors();
  const double high = std::fmax(now.most > then.most / 2 ? then.most / 2 : then.most, tolerance);
  for (std::size_t n = 0; n < noted.size(); ++n) {
    const bool is_farther = after.sum[n] > before.sum[n];
    const auto worst = static_cast<double>(after.worst[n]);
    const bool grew = after.worst[n] > before.worst[n] && worst > high;
    const bool has_room = now.most <= then.most && !is_farther && worst <= then.worst;
    if ((grew && !has_room) || (now.mean > then.mean && is_farther)) noted[n] = 1;
  }
}

// The columns of the form that each vertex has.
VertexColumns chosen_form(std::span<const VertexColumns> forms, std::span<const std::uint8_t> choice) {
  VertexColumns result;
  result.first.push_back(0);
  for (std::size_t n = 0; n < choice.size(); ++n) {
    const auto entries = forms[choice[n]].of(n);
    result.entries.insert(result.entries.end(), entries.begin(), entries.end());
    result.first.push_back(result.entries.size());
  }
  return result;
}

}  // namespace

Host judged_as(Host host) {
  host.bits = host.normals == NormalRule::kClamped ? kFineBits : 32;
  host.octahedral_base = false;
  return host;
}

bool shows_alike(const Host& a, const Host& b) {
  return a.normals == b.normals && a.bits == b.bits && a.by_frame == b.by_frame &&
         a.octahedral_base == b.octahedral_base;
}

HostJudge::HostJudge(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                     std::span<const std::uint32_t> element_of_vertex, const std::vector<bool>& is_new,
                     std::span<const Host> hosts, std::vector<bool> is_binding, double tolerance)
    : rights_(rights),
      vertices_(vertices),
      element_of_vertex_(element_of_vertex),
      is_new_(is_new),
      hosts_(hosts.begin(), hosts.end()),
      is_binding_(std::move(is_binding)),
      tolerance_(tolerance) {}

std::vector<float> HostJudge::worst(const VertexColumns& form, const PoseList& poses) const {
  std::vector<float> result(vertices_.size(), 0.0F);
  const PoseWeights weights(poses);
  rights_.for_each(vertices_, poses, [&](std::size_t n, std::size_t first, std::span<const Vec3f> right) {
    thread_local Sums sums;
    thread_local std::vector<float> errors;
    sums.add_up(Host{}, to_float(rights_.stored(vertices_[n])), form.of(n), weights, first, right.size());
    errors.resize(right.size());
    sums.angles_to(right, errors);
    for (const float error : errors) result[n] = std::fmax(result[n], error);
  });
  return result;
}

bool HostJudge::is_alike(const PoseSet& set, const Host& a, const Host& b) {
  return shows_alike(a, b) && (a.skins == b.skins || !any_skinned(set.poses));
}

std::vector<HostJudge::Kind> HostJudge::kinds_of(const PoseSet& set) const {
  std::vector<Kind> kinds;
  for (const std::size_t h : set.hosts) {
    const Host host = judged_as(hosts_[h]);
    const auto known =
        std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) { return is_alike(set, k.host, host); });
    if (known == kinds.end())
      kinds.push_back({host, is_binding_[h]});
    else
      known->is_binding = known->is_binding || is_binding_[h];
  }
  return kinds;
}

// Calls visit(n, kind, errors) for batches of poses and all kinds of hosts; errors are those of each form, (forms,
// poses).
template <class Visit>
void HostJudge::compare(std::span<const VertexColumns> forms, const PoseSet& set, std::span<const Kind> kinds,
                        const Visit& visit) const {
  const PoseList poses = weights_of(set.poses);
  const PoseWeights weights(poses);
  const SkinsInPoses skins(set.poses);
  std::vector<std::uint32_t> some;
  for (const std::uint32_t n : set.numbers) some.push_back(vertices_[n]);
  const std::span<const std::uint32_t> vertices = some.empty() ? vertices_ : some;
  // (forms, vertices)
  std::vector<char> are_plain(forms.size() * vertices.size());
  parallel_each(are_plain.size(), kBlock, [&](std::size_t i) {
    const std::size_t at = i % vertices.size();
    const auto entries = forms[i / vertices.size()].of(some.empty() ? at : set.numbers[at]);
    are_plain[i] = is_plain(to_float(rights_.stored(vertices[at])), entries) ? 1 : 0;
  });
  rights_.for_each(vertices, poses, [&](std::size_t at, std::size_t first, std::span<const Vec3f> right) {
    thread_local Sums sums;
    thread_local std::vector<float> errors;
    thread_local std::vector<Vec3f> is_right;
    const std::size_t n = some.empty() ? at : set.numbers[at];
    const Vec3f normal = to_float(rights_.stored(vertices_[n]));
    errors.resize(forms.size() * right.size());
    const SkinsInPoses::Vertex carrying(skins, vertices_[n], first, right.size());
    is_right.assign(right.begin(), right.end());
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      const SkinRule rule = kinds[kind].host.skins;
      const bool carries_as_before = !skins.any() || (kind > 0 && rule == kinds[kind - 1].host.skins);
      if (!carries_as_before)
        for (std::size_t p = 0; p < right.size(); ++p)
          is_right[p] = to_float(carrying.seen(rule, p, to_double(right[p])));
      for (std::size_t f = 0; f < forms.size(); ++f) {
        // Where these show what the kind before showed, it has been added up.
        const bool is_known = kind > 0 && carries_as_before && !is_rounding(kinds[kind].host) &&
                              !is_rounding(kinds[kind - 1].host) && are_plain[f * vertices.size() + at] != 0;
        if (is_known) continue;
        sums.add_up(kinds[kind].host, normal, forms[f].of(n), weights, first, right.size());
        if (skins.any()) sums.carry(carrying, rule);
        sums.angles_to(is_right, std::span(errors).subspan(f * right.size(), right.size()));
      }
      visit(n, kind, std::span<const float>(errors));
    }
  });
}

std::vector<std::uint8_t> HostJudge::choose(std::span<const VertexColumns> forms, std::span<const PoseSet> sets,
                                            FormPreference preference) const {
  const std::size_t count = vertices_.size(), form_count = forms.size();
  std::vector<char> is_harmful(count * form_count, 0);
  std::vector<float> squares(count * form_count, 0.0F);
  const bool prefers_last = preference == FormPreference::kLast;
  for (const PoseSet& set : sets) {
    const bool is_mixed = set.kind != PoseSet::Kind::kFile;
    if (is_mixed && preference == FormPreference::kNearestInFile) continue;
    std::vector<Kind> kinds = kinds_of(set);
    kinds.erase(std::remove_if(kinds.begin(), kinds.end(), [](const Kind& kind) { return !kind.is_binding; }),
                kinds.end());
    compare(forms, set, kinds, [&](std::size_t n, std::size_t, std::span<const float> errors) {
      const std::size_t poses = errors.size() / form_count;
      for (std::size_t f = 0; f < form_count; ++f) {
        for (std::size_t p = 0; p < poses; ++p) {
          const float before = errors[p], after = errors[f * poses + p];
          if (before < 0) continue;
          squares[n * form_count + f] += after * after;
          if (!is_mixed && is_harmed(before, after)) {
            is_harmful[n * form_count + f] = 1;
          }
        }
      }
    });
  }
  // The vertices of an element choose together.
  std::vector<char> harmful_element;
  std::vector<double> of_element;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t at = element_of_vertex_[vertices_[n]] * form_count;
    if (of_element.size() < at + form_count) {
      of_element.resize(at + form_count, 0.0);
      harmful_element.resize(at + form_count, 0);
    }
    for (std::size_t f = 0; f < form_count; ++f) {
      of_element[at + f] += static_cast<double>(squares[n * form_count + f]);
      const bool is_no_choice = is_new_[vertices_[n]] ? f == 0 : is_harmful[n * form_count + f] != 0;
      if (is_no_choice) harmful_element[at + f] = 1;
    }
  }
  std::vector<std::uint8_t> choice(count, 0);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t at = element_of_vertex_[vertices_[n]] * form_count;
    const std::size_t least = is_new_[vertices_[n]] ? 1 : 0;
    std::size_t best = least;
    for (std::size_t f = least + 1; f < form_count; ++f) {
      const std::size_t than = prefers_last ? least : best;
      if (harmful_element[at + f] == 0 && (of_element[at + f] < of_element[at + than] || (prefers_last && least > 0)))
        best = f;
    }
    choice[n] = static_cast<std::uint8_t>(best);
  }
  return choice;
}

std::vector<HostChange> HostJudge::settle(std::span<const VertexColumns> forms, std::span<const PoseSet> sets,
                                          std::vector<std::uint8_t>& choice, bool mixed_count) const {
  constexpr int kMostRounds = 6;
  struct Errors {
    ErrorSpread before, after;
  };
  std::array<std::vector<Errors>, kPoseKinds> of_hosts;
  of_hosts.fill(std::vector<Errors>(hosts_.size()));
  // Measures poses of the file, or all others, and returns to the stored form what does harm there.
  const auto measure = [&](bool of_file) {
    std::vector<char> noted(vertices_.size(), 0);
    const std::array<VertexColumns, 2> both = {forms[0], chosen_form(forms, choice)};
    for (std::size_t kind = 0; kind < kPoseKinds; ++kind)
      if ((static_cast<PoseSet::Kind>(kind) == PoseSet::Kind::kFile) == of_file)
        of_hosts[kind].assign(hosts_.size(), Errors());
    for (const PoseSet& set : sets) {
      if ((set.kind == PoseSet::Kind::kFile) != of_file) continue;
      const std::vector<Kind> kinds = kinds_of(set);
      GatheredPairs gathered(kinds.size(), vertices_.size());
      compare(both, set, kinds, [&](std::size_t n, std::size_t kind, std::span<const float> errors) {
        if (is_new_[vertices_[n]]) return;
        gathered.add(n, kind, errors);
        const std::span<const float> then = errors.first(errors.size() / 2), now = errors.last(errors.size() / 2);
        if (!of_file || !kinds[kind].is_binding) return;
        for (std::size_t p = 0; p < then.size(); ++p)
          if (is_harmed(then[p], now[p])) noted[n] = 1;
      });
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        if (!of_file && mixed_count && kinds[kind].is_binding)
          note_what_makes_worse(gathered.before[kind], gathered.after[kind], tolerance_, noted);
        const ErrorSpread then = gathered.before[kind].spread(), now = gathered.after[kind].spread();
        for (const std::size_t h : set.hosts) {
          if (!is_alike(set, judged_as(hosts_[h]), kinds[kind].host)) continue;
          Errors& errors = of_hosts[static_cast<std::size_t>(set.kind)][h];
          errors.before.add(then);
          errors.after.add(now);
        }
      }
    }
    return return_to_stored(noted, choice);
  };
  // What is judged pose by pose comes first: it may be all that made the mixed poses worse. What is stored does no
  // harm, so that one look at those of the file is enough, but for the figures.
  bool any_returned = measure(true);
  for (int round = 0; round < kMostRounds && measure(false); ++round) any_returned = true;
  if (any_returned) (void)measure(true);
  // What a compressor rounds is measured too, at some of the poses of the file.
  const std::array<VertexColumns, 2> both = {forms[0], chosen_form(forms, choice)};
  std::vector<Errors>& of_file = of_hosts[static_cast<std::size_t>(PoseSet::Kind::kFile)];
  for (std::size_t h = 0; h < hosts_.size(); ++h)
    if (is_rounding(hosts_[h])) of_file[h] = Errors();
  for (const PoseSet& set : sets) {
    if (set.kind != PoseSet::Kind::kFile) continue;
    std::vector<Kind> kinds;
    for (const std::size_t h : set.hosts)
      if (is_rounding(hosts_[h])) kinds.push_back({hosts_[h], false});
    PoseSet some{set.kind, set.hosts, {}, set.numbers};
    const std::size_t count = std::min(kMostRounded, set.poses.size());
    for (std::size_t n = 0; n < count; ++n) some.poses.push_back(set.poses[n * set.poses.size() / count]);
    GatheredPairs gathered(kinds.size(), vertices_.size());
    compare(both, some, kinds, [&](std::size_t n, std::size_t kind, std::span<const float> errors) {
      if (!is_new_[vertices_[n]]) gathered.add(n, kind, errors);
    });
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      for (const std::size_t h : set.hosts) {
        if (!(hosts_[h] == kinds[kind].host)) continue;
        of_file[h].before.add(gathered.before[kind].spread());
        of_file[h].after.add(gathered.after[kind].spread());
      }
    }
  }
  std::vector<HostChange> changes(hosts_.size());
  for (std::size_t h = 0; h < hosts_.size(); ++h) {
    changes[h].host = std::string(hosts_[h].name);
    for (std::size_t kind = 0; kind < kPoseKinds; ++kind)
      changes[h].poses[kind] = {of_hosts[kind][h].before.errors(), of_hosts[kind][h].after.errors()};
  }
  return changes;
}

bool HostJudge::is_harmed(float before, float after) const noexcept {
  return before >= 0 && static_cast<double>(after) > std::fmax(static_cast<double>(before) + kHarmless, tolerance_);
}

bool HostJudge::return_to_stored(const std::vector<char>& noted, std::vector<std::uint8_t>& choice) const {
  std::vector<bool> elements;
  for (std::size_t n = 0; n < noted.size(); ++n) {
    if (noted[n] == 0) continue;
    const std::uint32_t e = element_of_vertex_[vertices_[n]];
    if (elements.size() <= e) elements.resize(e + 1);
    elements[e] = true;
  }
  bool any = false;
  for (std::size_t n = 0; n < choice.size(); ++n) {
    const std::uint32_t e = element_of_vertex_[vertices_[n]];
    if (choice[n] == 0 || is_new_[vertices_[n]] || e >= elements.size() || !elements[e]) continue;
    choice[n] = 0;
    any = true;
  }
  return any;
}

}  // namespace chronormal::inline internal
