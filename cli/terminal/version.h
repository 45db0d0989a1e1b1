/// The version of the program, set by the build system.
#ifndef CLI_TERMINAL_VERSION_H_
#define CLI_TERMINAL_VERSION_H_

namespace chronormal::cli {

inline constexpr const char* kVersion = CHRONORMAL_VERSION;

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_VERSION_H_
