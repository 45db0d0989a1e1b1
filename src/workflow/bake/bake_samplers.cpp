#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "workflow/bake/bake_mesh.h"

namespace chronormal {
namespace {

std::string item(const std::string& list, std::size_t index) {
  return std::string(list).append("/").append(std::to_string(index));
}

std::size_t index_at(const GltfEdit& edit, const std::string& pointer) {
  const std::string text = edit.text(pointer);
  double value = 0;  // 4.0 is an index too
  std::from_chars(text.data(), text.data() + text.size(), value);
  return static_cast<std::size_t>(value);
}

// How many items an array of the source has.
std::size_t size_of(const GltfEdit& edit, const std::string& list) {
  std::size_t beyond = 1;
  while (edit.has(item(list, beyond - 1))) beyond *= 2;
  std::size_t least = beyond / 2, most = beyond - 1;
  while (least < most) {
    const std::size_t middle = least + (most - least) / 2;
    if (edit.has(item(list, middle)))
      least = middle + 1;
    else
      most = middle;
  }
  return least;
}

std::string_view name_of(GltfInterpolation interpolation) {
  if (interpolation == GltfInterpolation::kStep) return "\"STEP\"";
  return interpolation == GltfInterpolation::kLinear ? "\"LINEAR\"" : "\"CUBICSPLINE\"";
}

// A sampler as it is written.
struct Sampler {
  std::string input, output;  // accessors
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  bool has_new_input = false, is_converted = false;
};

class TrackWriter {
 public:
  TrackWriter(const GltfDocument& document, const std::vector<MeshPlan>& plans, double tolerance, GltfEdit& edit,
              std::vector<BakedMesh*>& reports, std::size_t& converted)
      : document_(document),
        plans_(plans),
        tolerance_(tolerance),
        edit_(edit),
        converted_(converted),
        reports_(reports),
        errors_(plans.size(), 0.0) {
    for (std::size_t n = 0; n < plans.size(); ++n) {
      if (!plans[n].extras.empty()) plan_of_mesh_[plans[n].mesh] = n;
    }
  }

  Status run() {
    if (Status status = check_pointers(); !status) return status;
    if (plan_of_mesh_.empty()) return Success{};
    for (std::size_t a = 0; a < document_.animations().size(); ++a) {
      if (Status status = write_animation(a); !status) return status;
    }
    for (std::size_t n = 0; n < plans_.size(); ++n) reports_[n]->resampling_error += errors_[n] * kDegreesPerRadian;
    return Success{};
  }

 private:
  // The plan of the mesh that a track drives; nothing where it gets no extra targets.
  [[nodiscard]] const std::size_t* plan_of(const GltfTrack& track) const {
    const GltfNode& node = document_.nodes()[track.node];
    const auto found = node.mesh ? plan_of_mesh_.find(*node.mesh) : plan_of_mesh_.end();
    return found == plan_of_mesh_.end() ? nullptr : &found->second;
  }

  // Weights that an extension drives would lack the new ones.
  [[nodiscard]] Status check_pointers() const {
    bool is_used = false;
    for (const std::string& extension : document_.extensions()) is_used |= extension == "KHR_animation_pointer";
    if (!is_used) return Success{};
    for (std::size_t a = 0; a < document_.animations().size(); ++a) {
      for (std::size_t c = 0; c < document_.animations()[a].channel_count; ++c) {
        const std::string channel = item(item("/animations", a) + "/channels", c);
        const std::string pointer = channel + "/target/extensions/KHR_animation_pointer/pointer";
        if (edit_.has(pointer) && edit_.text(pointer).find("/weights") != std::string::npos) {
          return invalid_input(std::string(document_.name()).append(", ").append(pointer),
                               "weights that are driven by KHR_animation_pointer cannot be extended");
        }
      }
    }
    return Success{};
  }

  Status write_animation(std::size_t a) {
    const GltfAnimation& animation = document_.animations()[a];
    const std::string pointer = item("/animations", a);
    std::map<std::size_t, std::vector<std::size_t>> tracks_of_sampler;
    for (std::size_t t = 0; t < animation.tracks.size(); ++t) {
      const std::string channel = item(pointer + "/channels", animation.tracks[t].channel);
      tracks_of_sampler[index_at(edit_, channel + "/sampler")].push_back(t);
    }
    const std::set<std::size_t> of_others = samplers_of_others(a);
    std::size_t appended = 0;
    for (const auto& [sampler, tracks] : tracks_of_sampler) {
      // The sampler stays as it is where another channel needs that; else the first mesh takes it over.
      std::map<std::size_t, std::vector<std::size_t>> tracks_of_plan;
      bool is_needed = of_others.count(sampler) > 0;
      for (const std::size_t t : tracks) {
        const std::size_t* plan = plan_of(animation.tracks[t]);
        if (plan == nullptr)
          is_needed = true;
        else
          tracks_of_plan[*plan].push_back(t);
      }
      for (const auto& [plan, of_plan] : tracks_of_plan) {
        Result<Sampler> extended = extended_sampler(a, of_plan.front(), sampler, plan);
        if (!extended) return extended.error();
        if (!is_needed) {
          replace(item(pointer + "/samplers", sampler), extended.value());
        } else {
          if (appended == 0) appended = size_of(edit_, pointer + "/samplers");
          append(pointer + "/samplers", extended.value());
          for (const std::size_t t : of_plan) {
            edit_.set(item(pointer + "/channels", animation.tracks[t].channel) + "/sampler", std::to_string(appended));
          }
          ++appended;
        }
        is_needed = true;
      }
    }
    return Success{};
  }

  // The samplers of channels that drive something else than weights of nodes.
  [[nodiscard]] std::set<std::size_t> samplers_of_others(std::size_t a) const {
    const GltfAnimation& animation = document_.animations()[a];
    std::set<std::size_t> of_weights, samplers;
    for (const GltfTrack& track : animation.tracks) of_weights.insert(track.channel);
    for (std::size_t c = 0; c < animation.channel_count; ++c) {
      const std::string sampler = item(item("/animations", a) + "/channels", c) + "/sampler";
      if (of_weights.count(c) == 0 && edit_.has(sampler)) samplers.insert(index_at(edit_, sampler));
    }
    return samplers;
  }

  Result<Sampler> extended_sampler(std::size_t a, std::size_t t, std::size_t sampler, std::size_t plan) {
    const GltfTrack& track = document_.animations()[a].tracks[t];
    const auto [found, is_new] = samplers_.try_emplace({a, track.same_keys_as, plan});
    if (is_new) {
      Result<GltfKeys> keys = document_.keys(a, t);
      if (!keys) return keys.error();
      const WeightTrack weights{track.interpolation, std::move(keys).value(),
                                document_.meshes()[plans_[plan].mesh].target_count};
      const ExtendedTrack extended = extended_track(weights, plans_[plan].extras, tolerance_ / kDegreesPerRadian);
      errors_[plan] = std::fmax(errors_[plan], extended.error);
      Sampler& result = found->second;
      result.interpolation = extended.interpolation;
      result.is_converted = extended.interpolation != track.interpolation;
      result.has_new_input = !extended.times.empty();
      if (result.has_new_input) result.input = std::to_string(edit_.add_scalars(extended.times, {true, true}));
      result.output = std::to_string(edit_.add_scalars(extended.values, {false, true}));
    }
    Sampler result = found->second;
    if (!result.has_new_input)
      result.input = edit_.text(item(item("/animations", a) + "/samplers", sampler) + "/input");
    converted_ += result.is_converted ? 1 : 0;
    return result;
  }

  void replace(const std::string& pointer, const Sampler& sampler) {
    edit_.set(pointer + "/output", sampler.output);
    if (sampler.has_new_input) edit_.set(pointer + "/input", sampler.input);
    if (sampler.is_converted) edit_.set(pointer + "/interpolation", std::string(name_of(sampler.interpolation)));
  }
  void append(const std::string& list, const Sampler& sampler) {
    std::string text = "{\"input\":";
    text.append(sampler.input).append(",\"output\":").append(sampler.output).append(",\"interpolation\":");
    edit_.append(list, text.append(name_of(sampler.interpolation)).append("}"));
  }

  const GltfDocument& document_;
  const std::vector<MeshPlan>& plans_;
  double tolerance_;
  GltfEdit& edit_;
  std::size_t& converted_;
  std::vector<BakedMesh*>& reports_;
  std::vector<double> errors_;  // of each plan, radians
  std::map<std::size_t, std::size_t> plan_of_mesh_;
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, Sampler> samplers_;  // by animation, keys, plan
};

}  // namespace

Status write_tracks(const GltfDocument& document, const std::vector<MeshPlan>& plans, double tolerance, GltfEdit& edit,
                    std::vector<BakedMesh*>& reports, std::size_t& converted) {
  return TrackWriter(document, plans, tolerance, edit, reports, converted).run();
}

}  // namespace chronormal
