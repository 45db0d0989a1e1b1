#include "cli/commands/compare_blend.h"

#include <utility>

namespace chronormal::cli {
namespace {

// Checks the options as far as possible without the input.
Status check(const InputOptions& input, bool elements_given, const BlendArguments& arguments) {
  if (*arguments.rows < 1 || *arguments.rows > kMostBlendRows)
    return misuse("--blend", "it must be a whole number from 1 to 10,000: how many weight vectors");
  if (arguments.active == std::size_t{0}) return misuse("--active", "it must be a whole number of 1 or more");
  if (!input.animation.empty() && arguments.active)
    return misuse("--active", "an animation says itself which targets are active");
  if (!input.animation.empty() && elements_given)
    return misuse("--animation", "with --blend it goes with the normals that the file stores: leave out --elements");
  return Success{};
}

// Adds the option as the place to an error of the library.
Error blamed(Error error, const std::string& option) {
  if (error.code == ErrorCode::kUsage && error.place.empty()) error.place = option;
  return error;
}

}  // namespace

std::vector<Option> BlendArguments::table() {
  return {{"--blend N", &rows,
           "blend shapes: compare deltas of normals, which viewers add up, with exact normals at\n"
           "N random sets of weights, or at N moments of an --animation"},
          {"--active N",
           &active,
           "how many targets are active at once (default 1, 2, 4, 8, 16, all)",
           {.needs = "--blend"}},
          {"--seed N", &seed, "the seed of the random weights (default 1)", {.needs = "--blend"}}};
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

  Result<Input> opened = open_input("compare", input, progress);
  if (!opened) return opened.error();
  if (opened.value().document() != nullptr && !elements_given) {
    if (input.world)
      return misuse("--world", "the normals that a file stores are in the space of its meshes: say which --elements");
    if (elements.crease_angle != 180 || elements.no_weld)
      return misuse("--elements", "the file says which normals there are, unless this does");
    options.progress = progress.callback("comparing");
    Result<BlendComparison> compared = compare_blends(*opened.value().document(), options);
    progress.clear();
    if (!compared) return blamed(compared.error(), input.animation.empty() ? option : "--animation");
    return NamedBlendComparison{opened.value().name(), input.animation, std::move(compared).value()};
  }

  const Result<const Motion*> motion = opened.value().motion();
  if (!motion) return motion.error();
  if (motion.value()->kind != MotionKind::kTargets)
    return misuse("--blend", "the input is a sequence: it goes with blend shapes, as of --base FILE or a glTF file");
  ElementArguments wanted = elements;
  wanted.usual = "vertices";
  const Result<ElementOptions> understood = wanted.options();
  if (!understood) return understood.error();
  options.elements = understood.value();
  options.progress = progress.callback("comparing");
  Result<BlendComparison> compared = compare_blends(*motion.value(), options);
  progress.clear();
  if (!compared) return blamed(compared.error(), option);
  return NamedBlendComparison{opened.value().name(), {}, std::move(compared).value()};
}

}  // namespace chronormal::cli
