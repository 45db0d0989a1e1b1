// Checks that LaTeX accepts the tables of `compare --table latex`, whatever characters the names of the inputs have.

#include <gtest/gtest.h>

#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::latex_test {
namespace {

constexpr const char* kDocument = R"(\documentclass{article}
\textwidth=35cm \paperwidth=42cm
\begin{document}
\input{tables}
Tables~\ref{tab:quality} and~\ref{tab:cost}.
\end{document}
)";

TEST(Latex, both_tables_compile_for_one_motion_and_for_several) {
  const test::TemporaryFolder folder;
  folder.write("paper.tex", kDocument);
  const std::string name = "50% of $x_1 & {#2} ~^\\ \"<|>\" \xC3\xA4\xE2\x82\xAC?.npz";
  folder.write("name", name);
  const std::string program(kProgram);
  const auto run = [&](const std::string& command) {
    const ProcessResult result = run_shell(command, folder.path());
    EXPECT_EQ(result.exit_code, 0) << command << "\n" << result.out << result.err;
    return result.out;
  };
  run(program + " convert --sample soup -o plain.npz && mv plain.npz \"$(cat name)\"");
  const std::string schemes =
      "linear,quadratic,cubic,polynomial,slerp,decasteljau:4,quaternion:matrix,quaternion:optimal,circle:timed,"
      "recompute";
  for (const std::string& inputs : {std::string("--sample twist"), std::string("--each --sample twist --sample bend"),
                                    std::string("--each --sample twist \"$(cat name)\"")}) {
    run(program + " compare " + inputs + " --samples 3 --schemes " + schemes + " --table latex --force -o tables.tex");
    const std::string latex = "pdflatex -halt-on-error -interaction=nonstopmode paper";
    run(latex);
    const std::string log = run(latex);  // LaTeX needs two runs to number the tables
    EXPECT_EQ(log.find("undefined"), std::string::npos) << log;
    EXPECT_EQ(log.find("Overfull"), std::string::npos) << log;
    EXPECT_EQ(log.find("Missing character"), std::string::npos) << log;
    EXPECT_NE(log.find("Output written on paper.pdf"), std::string::npos) << log;
  }
}

}  // namespace
}  // namespace chronormal::latex_test
