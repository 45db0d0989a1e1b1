#include "simd/targets.h"

#ifdef CHRONORMAL_HIGHWAY
#include <hwy/targets.h>
#endif

namespace chronormal::inline internal {

#ifdef CHRONORMAL_HIGHWAY

std::vector<std::int64_t> supported_targets() {
  std::vector<std::int64_t> targets;
  for (const auto target : hwy::SupportedAndGeneratedTargets()) targets.push_back(target);
  return targets;
}

std::string target_name(std::int64_t target) { return hwy::TargetName(target); }

std::int64_t current_target() {
  // If a test has chosen a target, `supported` has only the bit of this target. Otherwise the lowest bit of `supported`
  // is the best target.
  const std::int64_t supported = hwy::SupportedTargets() & HWY_TARGETS;
  return supported & -supported;
}

ScopedTarget::ScopedTarget(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

ScopedTarget::~ScopedTarget() {
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

#else

std::vector<std::int64_t> supported_targets() { return {current_target()}; }
std::string target_name(std::int64_t) { return "plain"; }
std::int64_t current_target() { return 1; }
ScopedTarget::ScopedTarget(std::int64_t) {}
ScopedTarget::~ScopedTarget() {}

#endif

}  // namespace chronormal::inline internal
