// Writes tracks into the file. Several channels may share a sampler. Some of these channels may drive other meshes, or
// values that are not weights. If such a channel needs the sampler, the sampler does not change, and each mesh gets a
// new sampler. Otherwise the first mesh changes the sampler, and each further mesh gets a new sampler.
#include "workflow/bake/write/write_tracks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "core/charconv.h"
#include "io/bytes/expansion.h"
#include "io/json/json_writer.h"

namespace chronormal::inline internal {
namespace {

std::string item(const std::string& list, std::size_t index) {
  return std::string(list).append("/").append(std::to_string(index));
}

std::size_t index_at(const GltfEdit& edit, const std::string& pointer) {
  const std::string text = edit.text(pointer);
  double value = 0;  // a double, since JSON may also write an index as 4.0
  const bool is_number = from_chars(text.data(), text.data() + text.size(), value).ec == std::errc{};
  return is_number ? static_cast<std::size_t>(value) : 0;
}

// Returns the number of items in an array of the file. `list` is the JSON pointer of the array.
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
  if (interpolation == GltfInterpolation::kStep) return "STEP";
  return interpolation == GltfInterpolation::kLinear ? "LINEAR" : "CUBICSPLINE";
}

// A sampler (the data of a track) of an animation, as the bake writes it.
struct Sampler {
  std::string input, output;  // indices of accessors, as text
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  bool has_new_input = false, is_converted = false;
};

// Returns the mesh whose weights a JSON pointer names. The pointer may name all weights or a single weight.
std::optional<std::size_t> mesh_of_weights(const GltfDocument& document, std::string_view rest) {
  const bool of_node = rest.starts_with("/nodes/");
  if (!of_node && !rest.starts_with("/meshes/")) return std::nullopt;
  rest.remove_prefix(rest.find('/', 1) + 1);
  std::size_t index = 0;
  const auto [stop, code] = from_chars(rest.data(), rest.data() + rest.size(), index);
  rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()));
  if (code != std::errc() || !rest.starts_with("/weights")) return std::nullopt;
  if (!of_node) return index;
  if (index >= document.nodes().size() || !document.nodes()[index].mesh) return std::nullopt;
  return *document.nodes()[index].mesh;
}

}  // namespace

std::optional<std::string> find_lone_weight(const GltfDocument& document, std::size_t mesh, const GltfEdit& edit) {
  for (std::size_t a = 0; a < document.animations().size(); ++a) {
    const GltfAnimation& animation = document.animations()[a];
    std::set<std::size_t> of_tracks;
    for (const GltfTrack& track : animation.tracks)
      if (!track.is_assembled) of_tracks.insert(track.channel);
    for (const GltfUnreadTrack& track : animation.unread) of_tracks.insert(track.channel);
    for (std::size_t c = 0; c < animation.channel_count; ++c) {
      const std::string channel = item(item("/animations", a) + "/channels", c);
      const std::string pointer = channel + "/target/extensions/KHR_animation_pointer/pointer";
      if (of_tracks.count(c) > 0 || !edit.has(pointer)) continue;
      const std::string text = edit.text(pointer);
      if (text.size() > 2 && mesh_of_weights(document, std::string_view(text).substr(1, text.size() - 2)) == mesh)
        return pointer;
    }
  }
  return std::nullopt;
}

std::optional<std::string> find_unread_track(const GltfDocument& document, std::size_t mesh) {
  const std::size_t targets = document.meshes()[mesh].target_count;
  for (std::size_t a = 0; a < document.animations().size(); ++a) {
    for (const GltfUnreadTrack& track : document.animations()[a].unread) {
      if (document.nodes()[track.node].mesh != mesh || targets == 0) continue;
      const Result<std::vector<float>> weights = document.unread_weights(track);
      if (!weights || weights.value().empty() || weights.value().size() % targets != 0)
        return item(item("/animations", a) + "/channels", track.channel);
    }
  }
  return std::nullopt;
}

namespace {

// Returns an error if KHR_animation_pointer drives single weights, or the weights of a mesh without a node. The weights
// of correction targets could not be animated in such a file. Neither could those of a track that cannot be extended.
Status check_pointers(const GltfDocument& document, std::span<const GrownMesh> meshes, const GltfEdit& edit) {
  for (const GrownMesh& mesh : meshes) {
    if (const std::optional<std::string> unread = find_unread_track(document, mesh.mesh))
      return invalid_input(std::string(document.name()).append(", ").append(*unread),
                           "the weights that this channel drives cannot be read, so they cannot be extended to "
                           "correction targets; remove the channel, or use another --encode");
    const std::optional<std::string> pointer = find_lone_weight(document, mesh.mesh, edit);
    if (!pointer) continue;
    return invalid_input(std::string(document.name()).append(", ").append(*pointer),
                         "KHR_animation_pointer drives a single weight, so the animation cannot drive correction "
                         "targets; let it drive all weights, or use another --encode");
  }
  return Success{};
}

// Returns the samplers of an animation that channels use for values other than the weights of nodes.
std::set<std::size_t> samplers_of_others(const GltfDocument& document, const GltfEdit& edit, std::size_t a) {
  const GltfAnimation& animation = document.animations()[a];
  std::set<std::size_t> of_weights, samplers;
  for (const GltfTrack& track : animation.tracks) of_weights.insert(track.channel);
  for (std::size_t c = 0; c < animation.channel_count; ++c) {
    const std::string sampler = item(item("/animations", a) + "/channels", c) + "/sampler";
    if (of_weights.count(c) == 0 && edit.has(sampler)) samplers.insert(index_at(edit, sampler));
  }
  return samplers;
}

class TrackWriter {
 public:
  TrackWriter(const GltfDocument& document, std::span<const GrownMesh> meshes, double tolerance, GltfEdit& edit)
      : document_(document), meshes_(meshes), tolerance_(tolerance), edit_(edit) {
    written_.errors.resize(meshes.size());
    written_.bytes.resize(meshes.size());
    for (std::size_t n = 0; n < meshes.size(); ++n) place_of_mesh_[meshes[n].mesh] = n;
  }

  Status write_animation(std::size_t a) {
    const GltfAnimation& animation = document_.animations()[a];
    const std::string pointer = item("/animations", a);
    std::map<std::size_t, std::vector<std::size_t>> tracks_of_sampler;
    for (std::size_t t = 0; t < animation.tracks.size(); ++t) {
      const std::string channel = item(pointer + "/channels", animation.tracks[t].channel);
      tracks_of_sampler[index_at(edit_, channel + "/sampler")].push_back(t);
    }
    const std::set<std::size_t> of_others = samplers_of_others(document_, edit_, a);
    std::size_t appended = 0;
    for (const auto& [sampler, tracks] : tracks_of_sampler) {
      std::map<std::size_t, std::vector<std::size_t>> tracks_of_mesh;
      bool is_needed = of_others.count(sampler) > 0;
      for (const std::size_t t : tracks) {
        const std::size_t* place = mesh_driven_by(animation.tracks[t].node);
        if (place == nullptr)
          is_needed = true;
        else
          tracks_of_mesh[*place].push_back(t);
      }
      for (const auto& [place, of_mesh] : tracks_of_mesh) {
        Result<Sampler> extended = extended_sampler(a, of_mesh.front(), sampler, place);
        if (!extended) return extended.error();
        if (!is_needed) {
          replace(item(pointer + "/samplers", sampler), extended.value());
        } else {
          if (appended == 0) appended = size_of(edit_, pointer + "/samplers");
          append(pointer + "/samplers", extended.value());
          for (const std::size_t t : of_mesh) {
            edit_.set(item(pointer + "/channels", animation.tracks[t].channel) + "/sampler", std::to_string(appended));
          }
          ++appended;
        }
        is_needed = true;
      }
    }
    for (const GltfUnreadTrack& track : animation.unread) {
      if (Status status = widen(track, a, appended); !status) return status;
    }
    return Success{};
  }

  [[nodiscard]] WrittenTracks written() && { return std::move(written_); }

 private:
  // Returns the index in meshes_ of the mesh that a track of a node drives. Returns nullptr if the mesh is not in
  // meshes_.
  [[nodiscard]] const std::size_t* mesh_driven_by(std::size_t index) const {
    const GltfNode& node = document_.nodes()[index];
    const auto found = node.mesh ? place_of_mesh_.find(*node.mesh) : place_of_mesh_.end();
    return found == place_of_mesh_.end() ? nullptr : &found->second;
  }

  // Widens each row of a track that cannot be read by zeros, for the correction targets. Otherwise a viewer that plays
  // the track would find the rows of later keys in other places. `appended` is the index of the next new sampler, or 0.
  Status widen(const GltfUnreadTrack& track, std::size_t a, std::size_t& appended) {
    const std::size_t* const place = mesh_driven_by(track.node);
    if (place == nullptr) return Success{};
    const Result<std::vector<float>> values = document_.unread_weights(track);
    if (!values) return values.error();
    const std::size_t targets = document_.meshes()[meshes_[*place].mesh].target_count,
                      width = targets + meshes_[*place].drivers.size(), rows = values.value().size() / targets;
    const std::string pointer = item("/animations", a), list = pointer + "/samplers";
    const std::uint64_t bytes = std::uint64_t{sizeof(float)} * rows * width;
    if (Status status = document_.expansion().check(edit_.added_bytes() + bytes, document_.name() + ", " + pointer);
        !status)
      return status;
    std::vector<float> wide(rows * width);
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(values.value().begin() + static_cast<std::ptrdiff_t>(row * targets), targets,
                  wide.begin() + static_cast<std::ptrdiff_t>(row * width));
    written_.bytes[*place] += sizeof(float) * rows * (width - targets);
    const std::string output = std::to_string(edit_.add_scalars(wide, {false, true}));
    const auto sampler_of = [&](std::size_t channel) { return item(pointer + "/channels", channel) + "/sampler"; };
    const std::size_t sampler = index_at(edit_, sampler_of(track.channel));
    std::size_t users = 0;
    for (std::size_t c = 0; c < document_.animations()[a].channel_count; ++c)
      users += edit_.has(sampler_of(c)) && index_at(edit_, sampler_of(c)) == sampler ? 1U : 0U;
    if (users == 1) {
      edit_.set(item(list, sampler) + "/output", output);
      return Success{};
    }
    if (appended == 0) appended = size_of(edit_, list);
    edit_.append(list, edit_.text(item(list, sampler)));
    edit_.set(item(list, appended) + "/output", output);
    edit_.set(sampler_of(track.channel), std::to_string(appended++));
    return Success{};
  }

  Result<Sampler> extended_sampler(std::size_t a, std::size_t t, std::size_t sampler, std::size_t place) {
    const GltfTrack& track = document_.animations()[a].tracks[t];
    const auto [found, is_new] = samplers_.try_emplace({a, track.same_keys_as, place});
    if (is_new) {
      Result<GltfKeys> keys = document_.keys(a, t);
      if (!keys) return keys.error();
      const WeightTrack weights{track.interpolation, std::move(keys).value(),
                                document_.meshes()[meshes_[place].mesh].target_count};
      const std::uint64_t bytes_per_key = kBytesPerWeight * (weights.targets + meshes_[place].drivers.size());
      const Expansion expansion = document_.expansion();
      const std::uint64_t added = edit_.added_bytes();
      const std::uint64_t room = (expansion.most() - std::min(expansion.most(), added)) / bytes_per_key;
      const auto most_keys =
          static_cast<std::size_t>(std::min<std::uint64_t>(room, std::numeric_limits<std::size_t>::max()));
      const double tolerance = meshes_[place].keeps_kind ? std::numeric_limits<double>::infinity() : tolerance_;
      const ExtendedTrack extended =
          meshes_[place].drivers.extended({a, track.same_keys_as}, weights, tolerance, most_keys);
      if (extended.keys > most_keys)
        return expansion
            .check(edit_.added_bytes() + bytes_per_key * extended.keys, item(document_.name() + ", /animations", a))
            .error();
      written_.errors[place] = std::fmax(written_.errors[place], extended.error);
      const std::size_t before =
          (track.interpolation == GltfInterpolation::kCubicSpline ? 3 : 1) * weights.targets * weights.size();
      written_.bytes[place] += sizeof(float) * (extended.values.size() + extended.times.size() - before);
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
    written_.converted += result.is_converted ? 1 : 0;
    return result;
  }

  void replace(const std::string& pointer, const Sampler& sampler) {
    edit_.set(pointer + "/output", sampler.output);
    if (sampler.has_new_input) edit_.set(pointer + "/input", sampler.input);
    if (sampler.is_converted) edit_.set(pointer + "/interpolation", quote_json(name_of(sampler.interpolation)));
  }
  void append(const std::string& list, const Sampler& sampler) {
    JsonObject object;
    object.add("input", sampler.input).add("output", sampler.output);
    edit_.append(list, object.add("interpolation", quote_json(name_of(sampler.interpolation))).text());
  }

  const GltfDocument& document_;
  std::span<const GrownMesh> meshes_;
  double tolerance_;
  GltfEdit& edit_;
  WrittenTracks written_;
  std::map<std::size_t, std::size_t> place_of_mesh_;  // for the index of a mesh, its index in meshes_
  // The samplers that were written, keyed by the index of the animation, the index of its first track with the same
  // keys, and the index of the mesh in meshes_.
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, Sampler> samplers_;
};

}  // namespace

Result<WrittenTracks> write_tracks(const GltfDocument& document, std::span<const GrownMesh> meshes, double tolerance,
                                   GltfEdit& edit) {
  if (Status status = check_pointers(document, meshes, edit); !status) return status.error();
  TrackWriter writer(document, meshes, tolerance, edit);
  for (std::size_t a = 0; a < document.animations().size() && !meshes.empty(); ++a) {
    if (Status status = writer.write_animation(a); !status) return status.error();
  }
  return std::move(writer).written();
}

}  // namespace chronormal::inline internal
