// Sets a fixed seed for property tests, so that a failure is repeated in the next run. RapidCheck reads the environment
// variable RC_PARAMS before it runs the first property, and prints the seed. If the variable is already set, it remains
// as it is:
//     RC_PARAMS=seed=1234 build/dev/tests/test_curves --gtest_filter=...

#include <cstdlib>

namespace chronormal {
namespace {

[[maybe_unused]] const int kIsSet = setenv("RC_PARAMS", "seed=20261122", 0);

}  // namespace
}  // namespace chronormal
