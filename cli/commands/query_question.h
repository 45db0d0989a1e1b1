/// A question of the command `query`. Each question has a file query_NAME.cpp with one function that describes it.
#ifndef CLI_COMMANDS_QUERY_QUESTION_H_
#define CLI_COMMANDS_QUERY_QUESTION_H_

#include <functional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/workflow/query.h"
#include "cli/options/options.h"

namespace chronormal::cli {

/// A function that answers a question for a motion. The last argument has no effect unless Question::takes_elements is
/// true.
using Ask =
    std::function<Result<QueryAnswer>(const Motion&, const QuerySpan&, const QueryProgress&, const ElementOptions&)>;

struct Question {
  std::string name, summary;
  std::vector<Option> options;  ///< options of this question only
  /// Parses the options before any input is read, and returns the function that answers. Errors: kUsage with an option
  /// as the place.
  std::function<Result<Ask>()> understand;
  bool takes_elements = false;  ///< false if the question is only about faces
};

[[nodiscard]] Question collapse_question();
[[nodiscard]] Question cones_question();
[[nodiscard]] Question contain_question();
[[nodiscard]] Question facing_question();
[[nodiscard]] Question shutter_question();

}  // namespace chronormal::cli

#endif  // CLI_COMMANDS_QUERY_QUESTION_H_
