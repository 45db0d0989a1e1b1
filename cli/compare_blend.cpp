#include "cli/compare_blend.h"

#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/sample.h"

namespace chronormal::cli {
namespace {

bool is_one_gltf_file(const InputOptions& input) {
  return input.base.empty() && input.files.size() == 1 && is_gltf_file(input.files.front());
}

// Whether the options say by themselves that it cannot be.
Status check(const InputOptions& input, bool elements_given, const BlendArguments& arguments) {
  if (*arguments.rows < 1 || *arguments.rows > kMostBlendRows)
    return misuse("--blend", "it must be a whole number from 1 to 10,000: how many weight vectors");
  if (arguments.active == std::size_t{0}) return misuse("--active", "it must be a whole number of 1 or more");
  if (!input.animation.empty() && arguments.active)
    return misuse("--active", "an animation says itself which targets are active");
  if (!input.animation.empty() && elements_given)
    return misuse("--animation", "with --blend it goes with the normals that the file stores: leave out --elements");
  if (is_one_gltf_file(input) && input.world && !elements_given)
    return misuse("--world", "the normals that a file stores are in the space of its meshes: say which --elements");
  return Success{};
}

// The message of the library, with the option that it is about.
Error blamed(Error error, const std::string& option) {
  if (error.code == ErrorCode::kUsage && error.place.empty()) error.place = option;
  return error;
}

}  // namespace

std::vector<Option> BlendArguments::table() {
  return {
      {"--blend N", &rows,
       "blend shapes: normal deltas of targets against exact normals at\n"
       "N random weight vectors, or N of an --animation"},
      {"--active N", &active, "only for this many targets at once (default 1, 2, 4, 8, 16, all)", {.needs = "--blend"}},
      {"--seed N", &seed, "of random weights (default 1)", {.needs = "--blend"}}};
}

Result<NamedBlendComparison> compare_blend_input(const InputOptions& input, const ElementArguments& elements,
                                                 const BlendArguments& arguments, Progress& progress) {
  const bool elements_given = elements.asked.has_value();
  if (const Status status = check(input, elements_given, arguments); !status) return status.error();
  if (const Status status = check_input(input); !status) return status.error();
  BlendCompareOptions options;
  options.rows = *arguments.rows;
  options.active = arguments.active.value_or(0);
  options.seed = arguments.seed;
  options.animation = input.animation;
  const std::string option = arguments.active ? "--active" : "--blend";

  if (is_one_gltf_file(input) && !elements_given) {
    if (elements.crease_angle != 180 || elements.no_weld)
      return misuse("--elements", "the file says which normals there are, unless this does");
    const Result<GltfDocument> document = GltfDocument::open(input.files.front(), {input.allow_external});
    if (!document) return document.error();
    options.progress = progress.callback("comparing");
    Result<BlendComparison> compared = compare_blends(document.value(), options);
    progress.clear();
    if (!compared) return blamed(compared.error(), input.animation.empty() ? option : "--animation");
    return NamedBlendComparison{input.files.front(), input.animation, std::move(compared).value()};
  }

  ElementArguments wanted = elements;
  wanted.usual = "vertices";
  const Result<ElementOptions> understood = wanted.options();
  if (!understood) return understood.error();
  options.elements = understood.value();
  if (!input.animation.empty())
    return misuse("--animation", "with --blend it goes with the normals that one glTF file stores");
  Result<NamedMotion> motion = read_input(input, progress);
  if (!motion) return motion.error();
  // Two keyframes are a target only where they come as one.
  const bool is_target = !input.base.empty() || is_one_gltf_file(input);
  if (!is_target && !(motion.value().motion.segments.size() > 1 && is_blend_shapes(motion.value().motion)))
    return misuse("--blend", "the input is a sequence: it goes with blend shapes, as of --base FILE or a glTF file");
  options.progress = progress.callback("comparing");
  Result<BlendComparison> compared = compare_blends(motion.value().motion, options);
  progress.clear();
  if (!compared) return blamed(compared.error(), option);
  return NamedBlendComparison{std::move(motion.value().name), {}, std::move(compared).value()};
}

}  // namespace chronormal::cli
