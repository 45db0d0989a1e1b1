#include "cli/commands/compare_truth.h"

#include <utility>

namespace chronormal::cli {

std::vector<Option> TruthArguments::table() {
  return {
      {"--truth N",
       &every,
       "keep only every Nth keyframe, and compare with the others\nThe keyframes that are left out show how the mesh "
       "really moved. Schemes and curved paths are compared with them. The input must be a sequence of keyframes",
       {.check = check_whole(2)}}};
}

Result<NamedTruthComparison> compare_input_with_truth(const InputOptions& input, const ElementArguments& elements,
                                                      const TruthArguments& arguments, std::vector<std::string> schemes,
                                                      Progress& progress) {
  const Result<ElementOptions> wanted = elements.options();
  if (!wanted) return wanted.error();
  InputOptions kept = input;
  kept.velocities = true;
  Result<Input> opened = open_input("compare", kept, progress);
  if (!opened) return opened.error();
  const Result<const Motion*> motion = opened.value().motion();
  if (!motion) return motion.error();
  TruthOptions options;
  options.every = *arguments.every;
  options.schemes = std::move(schemes);
  options.elements = wanted.value();
  options.progress = progress.callback("comparing");
  Result<TruthComparison> comparison = compare_with_truth(*motion.value(), options);
  progress.clear();
  if (!comparison) {
    Error error = comparison.error();
    if (error.code == ErrorCode::kUsage && error.place.empty()) error.place = "--truth";
    return error;
  }
  return NamedTruthComparison{opened.value().name(), std::move(comparison).value()};
}

}  // namespace chronormal::cli
