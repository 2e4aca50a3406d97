#include "program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "console.h"
#include "foucault/core/edit_distance.h"
#include "foucault/core/error.h"
#include "texts/manual.h"
#include "version.h"

namespace foucault::app {
namespace {

constexpr int kBadUsage = 2;

constexpr const char* kProgramExamples =
    "\nExamples:\n"
    "  foucault demo                                       a first look, with simulated data\n"
    "  foucault import i2nav --imu imu.txt --gnss rtk.pos --gps-week 2200 \\\n"
    "      --lever-arm 0.1,-0.3,-0.8 --out trip.rawlog     a recording into a rawlog\n"
    "  foucault info trip.rawlog                           what is in it\n"
    "  foucault run trip.rawlog --out trip                 process it; see trip/report/index.html\n"
    "\n'foucault help COMMAND' tells the options of a command, 'man foucault' those of all.\n"
    "Exit codes: 0 all right, 1 bad data, 2 wrong usage, 130 interrupted, 143 terminated.";

std::string join_arguments(int argc, char** argv) {
  std::string joined = "foucault";
  for (int i = 1; i < argc; ++i) joined += fmt::format(" {}", argv[i]);
  return joined;
}

std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name()
                                     : full_name(*app.get_parent()) + " " + app.get_name();
}

/// Long names of its options and of those that it takes over.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  if (app.get_fallthrough()) {
    for (std::string& name : option_names(*app.get_parent())) names.push_back(std::move(name));
  }
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

/// Of those known, if one is near: two letters are easily exchanged, half of a word is another.
std::string meant(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearest_text(word, known);
  const std::size_t farthest = std::max<std::size_t>(2, word.size() / 2);
  if (nearest.empty() || edit_distance(word, nearest) > farthest) return "";
  return fmt::format("; did you mean {}?", nearest);
}

}  // namespace

Program::Program() : app_("Foucault: post-processing of GNSS/IMU recordings", "foucault") {
  app_.set_version_flag("-V,--version", std::string("foucault ") + kVersion);
  app_.require_subcommand(1);
  add_generator();
  for (const Command& command : commands()) add(command);
  add_help();
  app_.footer(kProgramExamples);  // not before: subcommands would take it over
}

void Program::run(int argc, char** argv) {
  if (argc > 1) check_command(argv[1]);
  app_.parse(argc, argv);
  Console console(quiet_);
  Call call{console, join_arguments(argc, argv)};
  actions_.at(app_.get_subcommands().front())(call);
}

int Program::answer(const CLI::ParseError& error) const {
  if (error.get_exit_code() == 0) return app_.exit(error);
  print_error(fmt::format("{}; see '{} --help'", what_is_wrong(error), full_name(deepest())));
  return kBadUsage;
}

void Program::add(const Command& command) {
  CLI::App* sub = app_.add_subcommand(command.name, command.summary);
  sub->add_flag("-q,--quiet", quiet_, "Say only what goes wrong");
  actions_.emplace(sub, command.declare(*sub));
}

void Program::add_help() {
  CLI::App* help = app_.add_subcommand("help", "the options of a command, with examples");
  help->add_option("COMMAND", asked_, "Its words; without any, all commands are listed");
  help->footer("\nExamples:\n  foucault help run\n  foucault help import csv");
  actions_.emplace(help, [this](Call&) { throw HelpText(help_of(asked_)); });
}

/// Hidden: what the build writes into files that are installed.
void Program::add_generator() {
  const auto generate = [this](const std::string& what) {
    if (what == "man") throw HelpText(man_page(tree(), kVersion));
    throw HelpText(what == "bash" ? bash_completion(tree()) : zsh_completion(tree()));
  };
  app_.add_option_function<std::string>("--generate", generate)
      ->check(CLI::IsMember({"man", "bash", "zsh"}))
      ->trigger_on_parse()
      ->group("");
}

/// CLI11 would only say that a subcommand is missing.
void Program::check_command(const std::string& name) const {
  if (name.empty() || name.front() == '-') return;
  const std::vector<std::string> known = command_names(app_);
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  throw UsageError(fmt::format("unknown command '{}'{}; known: {}", name, meant(name, known),
                               fmt::join(known, ", ")));
}

std::string Program::help_of(const std::vector<std::string>& words) const {
  const CLI::App* app = &app_;
  for (const std::string& word : words) {
    const std::vector<std::string> known = command_names(*app);
    if (std::find(known.begin(), known.end(), word) == known.end()) {
      throw UsageError(fmt::format("'{}' has no command '{}'{}; see '{} --help'", full_name(*app),
                                   word, meant(word, known), full_name(*app)));
    }
    app = app->get_subcommand(word);
  }
  return app->get_formatter()->make_help(app, full_name(*app), CLI::AppFormatMode::Normal);
}

/// An option that is not known comes first: CLI11 would complain of those that are missing.
std::string Program::what_is_wrong(const CLI::ParseError& error) const {
  for (const std::string& word : app_.remaining(true)) {
    if (word.size() < 2 || word.front() != '-') continue;
    const std::string name = word.substr(0, word.find('='));
    return fmt::format("unknown option '{}'{}", name, meant(name, option_names(deepest())));
  }
  const std::string text = error.what();
  for (const CLI::Option* option : deepest().get_options()) {  // by its place, if it has one
    const std::string name = option->get_name() + " ";
    if (option->get_positional() && text.rfind(name, 0) == 0) {
      return option->get_name(true) + " " + text.substr(name.size());
    }
  }
  return text;
}

const CLI::App& Program::deepest() const {
  const CLI::App* app = &app_;
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return *app;
}

}  // namespace foucault::app
