#include "cli/commands/compare_blend.h"

#include <utility>

namespace chronormal::cli {
namespace {

// Checks the options as far as this is possible before the input is read.
Status check(const InputOptions& input, bool elements_given, const BlendArguments& arguments) {
  if (*arguments.rows < 1 || *arguments.rows > kMostBlendRows)
    return misuse("--blend", "the number of poses must be a whole number from 1 to 10,000");
  if (arguments.active == std::size_t{0})
    return misuse("--active", "the number of targets must be a whole number of at least 1");
  if (!input.animation.empty() && arguments.active)
    return misuse("--active",
                  "--active cannot be used with --animation, whose weights decide which targets are active; leave one "
                  "of the two out");
  if (!input.animation.empty() && elements_given)
    return misuse("--animation",
                  "with --animation, --blend can only compare the stored normals of the file; leave --elements out");
  return Success{};
}

// Completes a usage error of the library that names no place: `option` becomes its place.
Error blamed(Error error, const std::string& option) {
  if (error.code == ErrorCode::kUsage && error.place.empty()) error.place = option;
  return error;
}

}  // namespace

std::vector<Option> BlendArguments::table() {
  return {{"--blend N", &rows,
           "compare normals of blend shapes in N random poses\nThe normals that viewers get by adding up deltas are "
           "compared with exact normals. With --animation, the poses are those at N moments of the animation"},
          {"--active N",
           &active,
           "let N targets be active at once in each pose of --blend\nBy default, 1, 2, 4, 8, 16 and all targets are "
           "active, one number after the other",
           {.needs = "--blend", .rare = true}},
          {"--seed N",
           &seed,
           "set the seed of the random poses of --blend\nThe default is 1",
           {.needs = "--blend", .rare = true}}};
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
      return misuse("--world",
                    "the stored normals of the file can only be compared in the space of each mesh; leave --world out, "
                    "or compute normals with --elements");
    if (elements.crease_angle != 180 || elements.no_weld)
      return misuse("--elements",
                    "--crease and --no-weld do not apply to the stored normals of the file; leave both options out, or "
                    "compute normals with --elements");
    options.progress = progress.callback("comparing");
    Result<BlendComparison> compared = compare_blends(*opened.value().document(), options);
    progress.clear();
    if (!compared) return blamed(compared.error(), input.animation.empty() ? option : "--animation");
    return NamedBlendComparison{opened.value().name(), input.animation, std::move(compared).value()};
  }

  const Result<const Motion*> motion = opened.value().motion();
  if (!motion) return motion.error();
  if (motion.value()->kind != MotionKind::kTargets)
    return misuse("--blend",
                  "--blend is only for blend shapes, and the input is a sequence of keyframes; leave --blend out");
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
