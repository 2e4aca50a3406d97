#include "program.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include "support/test_folder.h"
#include "texts/manual.h"

namespace foucault::app {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

CommandEntry tree() { return Program().tree(); }

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> all;
  for (std::string word; stream >> word;) all.push_back(word);
  return all;
}

std::vector<std::string> names_of(const CommandEntry& command) {
  std::vector<std::string> names;
  for (const OptionEntry& option : command.options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

/// What the program says of a command line that is wrong.
std::string complaint(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "foucault");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  Program program;
  testing::internal::CaptureStderr();
  try {
    program.run(static_cast<int>(argv.size()), argv.data());
    ADD_FAILURE() << "nothing was wrong";
  } catch (const CLI::ParseError& error) {
    EXPECT_EQ(program.answer(error), 2);
  } catch (const std::exception& error) {
    testing::internal::GetCapturedStderr();
    return error.what();
  }
  return testing::internal::GetCapturedStderr();
}

TEST(CommandTree, HasCommandsAndTheirCommands) {
  std::set<std::string> names;
  const CommandEntry program = tree();
  for (const CommandEntry* command : with_subcommands(program)) names.insert(command->name);
  EXPECT_THAT(names, IsSupersetOf({"foucault", "foucault run", "foucault import csv",
                                   "foucault lab faults", "foucault help"}));
  for (const CommandEntry* command : with_subcommands(program)) {
    EXPECT_FALSE(command->summary.empty()) << command->name;
    for (const OptionEntry& option : command->options) {
      EXPECT_FALSE(option.help.empty())
          << command->name << " " << testing::PrintToString(option.names);
    }
  }
}

TEST(Manual, NamesEveryCommandAndOption) {
  const CommandEntry program = tree();
  std::string page = man_page(program, "1.2.3");
  EXPECT_THAT(page, HasSubstr("foucault 1.2.3"));
  page.erase(std::remove(page.begin(), page.end(), '\\'), page.end());
  for (const CommandEntry* command : with_subcommands(program)) {
    const std::size_t begin = command->name == "foucault"
                                  ? page.find(".SH OPTIONS")
                                  : page.find(".SS \"" + command->name + "\"");
    ASSERT_NE(begin, std::string::npos) << command->name;
    const std::string section = page.substr(begin, page.find("\n.S", begin) - begin);
    for (const std::string& name : names_of(*command)) {
      EXPECT_THAT(section, HasSubstr("fB" + name + "fR")) << command->name;
    }
  }
}

TEST(Manual, HidesWhatTheBuildUses) {
  EXPECT_EQ(man_page(tree(), "").find("generate"), std::string::npos);
}

/// What bash offers where `typed` ends.
std::vector<std::string> offered_by_bash(const std::string& script, const std::string& typed) {
  const test::TestFolder folder;
  folder.write("completion", script);
  const std::string last = typed.back() == ' ' ? "''" : "";
  folder.write("ask", "cd '" + folder.path().string() +
                          "'\nsource ./completion\n"
                          "COMP_WORDS=(" +
                          typed + last +
                          ")\n"
                          "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                          "_foucault\n"
                          "printf '%s\\n' \"${COMPREPLY[@]}\" > offered\n");
  EXPECT_EQ(std::system(("bash " + (folder / "ask")).c_str()), 0) << typed;
  return words(folder.text("offered"));
}

TEST(BashCompletion, OffersEveryCommandAndOption) {
  const CommandEntry program = tree();
  const std::string script = bash_completion(program);
  for (const CommandEntry* command : with_subcommands(program)) {
    if (command->name == "foucault help") continue;  // see below
    std::vector<std::string> commands;
    for (const CommandEntry& sub : command->commands) commands.push_back(last_word(sub));
    EXPECT_EQ(offered_by_bash(script, command->name + " "), commands);
    EXPECT_EQ(offered_by_bash(script, command->name + " -"), names_of(*command));
  }
  EXPECT_THAT(offered_by_bash(script, "foucault help import c"), testing::ElementsAre("csv"));
  EXPECT_THAT(offered_by_bash(script, "foucault run trip.rawlog --meth"),
              testing::ElementsAre("--method"));
}

TEST(BashCompletion, OffersWhatAnOptionCanBe) {
  const std::string script = bash_completion(tree());
  EXPECT_EQ(offered_by_bash(script, "foucault run trip.rawlog --method r"),
            (std::vector<std::string>{"rts", "refined", "rough"}));
  EXPECT_THAT(offered_by_bash(script, "foucault simulate --fault imu_gap"),
              testing::ElementsAre("imu_gap_sample", "imu_gap_3s", "imu_gap_60s"));
  EXPECT_THAT(offered_by_bash(script, "foucault run --out "), testing::ElementsAre());
}

TEST(ZshCompletion, KnowsEveryCommandAndOption) {
  const CommandEntry program = tree();
  const std::string script = zsh_completion(program);
  for (const CommandEntry* command : with_subcommands(program)) {
    std::string function = "\n_" + command->name + "() {";
    std::replace(function.begin() + 2, function.end() - 3, ' ', '_');
    const std::size_t begin = script.find(function);
    ASSERT_NE(begin, std::string::npos) << function;
    const std::string body = script.substr(begin, script.find("\n}", begin) - begin);
    for (const std::string& name : names_of(*command)) {
      EXPECT_THAT(body, HasSubstr("'*" + name + "[")) << command->name;
    }
    for (const CommandEntry& sub : command->commands) {
      EXPECT_THAT(body, HasSubstr("    " + last_word(sub) + ") _")) << command->name;
    }
  }
  EXPECT_THAT(script, HasSubstr(":(batch rts ekf refined rough full)'"));
}

/// Lines of examples, those that go on behind a backslash in one.
std::vector<std::string> examples(std::string notes) {
  for (std::size_t at; (at = notes.find("\\\n")) != std::string::npos;) notes.erase(at, 2);
  std::vector<std::string> lines;
  std::istringstream stream(notes);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind("  ", 0) == 0 && line.find("foucault ") != std::string::npos) {
      lines.push_back(line.substr(line.rfind("foucault ")));
    }
  }
  return lines;
}

const CommandEntry* find(const std::vector<const CommandEntry*>& all, const std::string& name) {
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const CommandEntry* command) { return command->name == name; });
  return found == all.end() ? nullptr : *found;
}

/// The command that a line of an example calls.
const CommandEntry* called(const std::vector<const CommandEntry*>& all, const std::string& line) {
  const std::vector<std::string> typed = words(line);
  const std::string two = typed[0] + " " + typed[1];
  const CommandEntry* inner = typed.size() > 2 ? find(all, two + " " + typed[2]) : nullptr;
  return inner != nullptr ? inner : find(all, two);
}

TEST(Help, OfEveryCommandHasExamplesOfItsOwn) {
  const CommandEntry program = tree();
  const std::vector<const CommandEntry*> all = with_subcommands(program);
  for (const CommandEntry* command : all) {
    const std::vector<std::string> lines = examples(command->notes);
    EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
      return line.rfind(command->name, 0) == 0;
    })) << command->name;
  }
}

TEST(Help, ExamplesHaveOptionsThatExist) {
  const CommandEntry program = tree();
  const std::vector<const CommandEntry*> all = with_subcommands(program);
  for (const CommandEntry* command : all) {
    for (const std::string& line : examples(command->notes)) {
      const CommandEntry* used = called(all, line);
      ASSERT_NE(used, nullptr) << line;
      const std::vector<std::string> known = names_of(*used);
      for (const std::string& word : words(line)) {
        if (word[0] != '-' || std::isdigit(word[1]) != 0) continue;
        EXPECT_EQ(std::count(known.begin(), known.end(), word), 1) << line << ": " << word;
      }
    }
  }
}

TEST(Options, ShortNamesStandBesideLongOnes) {
  const CommandEntry program = tree();
  for (const CommandEntry* command : with_subcommands(program)) {
    const std::vector<std::string> names = names_of(*command);
    for (const auto& [brief, in_full] : {std::pair("-o", "--out"), std::pair("-w", "--overwrite"),
                                         std::pair("-i", "--input"), std::pair("-q", "--quiet")}) {
      EXPECT_EQ(std::count(names.begin(), names.end(), brief),
                std::count(names.begin(), names.end(), in_full))
          << command->name << " " << in_full;
    }
  }
  EXPECT_THAT(names_of(*find(with_subcommands(program), "foucault run")),
              IsSupersetOf({"-i", "-o", "-q", "-w"}));
}

TEST(Options, MistypedOnesAreNamedWithTheNearest) {
  EXPECT_THAT(complaint({"run", "trip.rawlog", "--outt", "trip"}),
              HasSubstr("unknown option '--outt'; did you mean --out?; see 'foucault run --help'"));
  EXPECT_THAT(complaint({"run", "trip.rawlog", "--methd=ekf", "--out", "trip"}),
              HasSubstr("'--methd'; did you mean --method?"));
  EXPECT_THAT(complaint({"import", "csv", "--maping", "a.yaml"}),
              HasSubstr("'--maping'; did you mean --mapping?"));
  EXPECT_THAT(complaint({"import", "csv", "--quite"}), HasSubstr("did you mean --quiet?"));
}

TEST(Options, MissingOnesAreNamedAsTheyAreTyped) {
  EXPECT_THAT(complaint({"run", "--out", "trip"}), HasSubstr("LOG is required"));
  EXPECT_THAT(complaint({"run", "trip.rawlog"}), HasSubstr("--out is required"));
}

TEST(Commands, MistypedOnesAreNamedWithTheNearest) {
  EXPECT_THAT(complaint({"rnu"}), HasSubstr("unknown command 'rnu'; did you mean run?"));
  EXPECT_THAT(complaint({"help", "import", "cvs"}), HasSubstr("did you mean csv?"));
  EXPECT_THAT(complaint({"help", "nothing"}), Not(HasSubstr("did you mean")));
  EXPECT_THAT(complaint({"--outt", "trip"}), Not(HasSubstr("did you mean")));
}

TEST(Commands, HelpIsThatOfTheCommand) {
  EXPECT_THAT(complaint({"help", "import", "csv"}), HasSubstr("Usage: foucault import csv"));
  EXPECT_THAT(complaint({"help"}), HasSubstr("Usage: foucault [OPTIONS] SUBCOMMAND"));
}

}  // namespace
}  // namespace foucault::app
