// Sets a fixed seed for property tests, so that a failure occurs again in the next run. RapidCheck reads the
// environment variable RC_PARAMS when the first property runs, and prints the seed. If the variable is already set,
// this file does not change it:
//     RC_PARAMS=seed=1234 build/dev/tests/test_curves --gtest_filter=...

#include <cstdlib>

namespace chronormal {
namespace {

[[maybe_unused]] const int kIsSet = setenv("RC_PARAMS", "seed=20261122", 0);

}  // namespace
}  // namespace chronormal
