/// Morphs that need no file: to try things on, and to publish figures that anyone can measure again.
#ifndef CHRONORMAL_IO_BUILTIN_MORPHS_H_
#define CHRONORMAL_IO_BUILTIN_MORPHS_H_

#include <span>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

struct BuiltinMorph {
  std::string_view name;
  std::string_view summary;  ///< one line
};

/// The morphs there are that are sequences, from mild to dramatic.
[[nodiscard]] std::span<const BuiltinMorph> builtin_morphs() noexcept;

/// Blend shapes, whose keyframes are targets over a base.
[[nodiscard]] std::span<const BuiltinMorph> builtin_blend_shapes() noexcept;

/// Makes one of either by name: the same positions on every call. Errors: kUsage with the names that there are.
[[nodiscard]] Result<Motion> make_builtin_morph(std::string_view name);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_BUILTIN_MORPHS_H_
