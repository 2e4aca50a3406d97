#include "texts/manual.h"

#include <fmt/format.h>

#include <sstream>

namespace foucault::app {
namespace {

std::string replaced(const std::string& text, const std::string& from, const std::string& to) {
  std::string out;
  std::size_t begin = 0;
  for (std::size_t at; (at = text.find(from, begin)) != std::string::npos; begin = at + from.size())
    out += text.substr(begin, at - begin) + to;
  return out + text.substr(begin);
}

/// A line that troff takes as text: no command, no escape, hyphens that can be copied.
std::string roff_line(const std::string& line) {
  std::string safe = replaced(replaced(line, "\\", "\\e"), "-", "\\-");
  if (!safe.empty() && (safe.front() == '.' || safe.front() == '\'')) safe.insert(0, "\\&");
  return safe + "\n";
}

/// Lines stay lines.
std::string roff_verbatim(const std::string& text) {
  std::string page = ".nf\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) page += roff_line(line);
  return page + ".fi\n";
}

/// Lines that are indented stay lines.
std::string roff_help(const std::string& text) {
  std::string page;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin != std::string::npos && begin > 0) page += ".br\n";
    page += begin == std::string::npos ? ".br\n" : roff_line(line.substr(begin));
  }
  return page;
}

std::string placeholder(const OptionEntry& option) {
  return option.positional.empty() ? option.argument : option.positional;
}

std::string names_line(const OptionEntry& option) {
  std::string line;
  for (const std::string& name : option.names) {
    line += fmt::format("{}\\fB{}\\fR", line.empty() ? "" : ", ", replaced(name, "-", "\\-"));
  }
  const std::string value = option.argument.empty() ? "" : placeholder(option);
  if (!value.empty()) line += fmt::format("{}\\fI{}\\fR", line.empty() ? "" : " ", value);
  return line + (option.repeats ? " ..." : "");
}

std::string synopsis(const CommandEntry& command) {
  std::string line = fmt::format("\\fB{}\\fR", command.name);
  if (!command.commands.empty()) line += " \\fICOMMAND\\fR";
  for (const OptionEntry& option : command.options) {
    if (option.positional.empty()) continue;
    const std::string value = option.positional + (option.repeats ? "..." : "");
    line += option.required ? " \\fI" + value + "\\fR" : " [\\fI" + value + "\\fR]";
  }
  return line + " [\\fIOPTIONS\\fR]\n";
}

std::string man_section(const CommandEntry& command) {
  std::string page = fmt::format(".SS \"{}\"\n{}.PP\n{}", command.name, synopsis(command),
                                 roff_line(command.summary + "."));
  for (const OptionEntry& option : command.options) {
    page += ".TP\n" + names_line(option) + "\n" + roff_help(option.help) +
            (option.required ? "Required.\n" : "");
  }
  if (command.notes.find_first_not_of('\n') != std::string::npos) {
    page += ".PP\n" + roff_verbatim(command.notes.substr(command.notes.find_first_not_of('\n')));
  }
  return page;
}

std::string option_words(const CommandEntry& command) {
  std::string words;
  for (const OptionEntry& option : command.options) {
    for (const std::string& name : option.names) words += " " + name;
  }
  return words;
}

std::string command_words(const CommandEntry& command) {
  std::string words;
  for (const CommandEntry& sub : command.commands) words += " " + last_word(sub);
  return words;
}

/// What an option can be, where its help has a line for each: "  batch: what that is".
std::string choices(const OptionEntry& option) {
  std::string words;
  std::istringstream lines(option.help);
  for (std::string line; std::getline(lines, line);) {
    const std::string word = line.substr(0, line.find(": "));
    if (word.rfind("  ", 0) == 0 && word.size() < line.size() &&
        word.find(' ', 2) == std::string::npos)
      words += word.substr(1);
  }
  return words;
}

/// In place of commands, behind the names of options that have choices.
std::string bash_choices(const CommandEntry& command) {
  std::string lines;
  for (const OptionEntry& option : command.options) {
    const std::string words = choices(option);
    if (words.empty()) continue;
    for (const std::string& name : option.names)
      lines += fmt::format("      [[ $previous == {} ]] && commands='{}'\n", name, words);
  }
  return lines;
}

/// In single quotes of a shell, and for _arguments.
std::string zsh_text(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  for (const char* special : {"\\", "[", "]", ":"}) {
    line = replaced(line, special, std::string("\\") + special);
  }
  return replaced(line, "'", "'\\''");
}

std::string zsh_option(const OptionEntry& option) {
  std::string lines;
  const std::string words = choices(option);
  const std::string values = words.empty() ? "_files" : "(" + words.substr(1) + ")";
  const std::string value = option.argument.empty() ? "" : ":" + placeholder(option) + ":" + values;
  for (const std::string& name : option.names) {
    lines += fmt::format(" \\\n    '*{}[{}]{}'", name, zsh_text(option.help), value);
  }
  return lines;
}

std::string zsh_function_name(const CommandEntry& command) {
  return "_" + replaced(command.name, " ", "_");
}

/// One function a command: it offers its options, and hands on to the functions of its commands.
std::string zsh_function(const CommandEntry& command) {
  std::string text = fmt::format("{}() {{\n  _arguments -S", zsh_function_name(command)) +
                     (command.commands.empty() ? "" : " -C");
  for (const OptionEntry& option : command.options) text += zsh_option(option);
  if (command.commands.empty()) return text + " \\\n    '*:file:_files'\n}\n\n";
  text += " \\\n    '1:command:((";
  for (const CommandEntry& sub : command.commands) {
    text += fmt::format("{}\\:\"{}\" ", last_word(sub), zsh_text(sub.summary));
  }
  text += "))' \\\n    '*::argument:->argument'\n  [[ $state == argument ]] || return\n";
  text += "  case $words[1] in\n";
  for (const CommandEntry& sub : command.commands) {
    text += fmt::format("    {}) {} ;;\n", last_word(sub), zsh_function_name(sub));
  }
  return text + "  esac\n}\n\n";
}

}  // namespace

std::string man_page(const CommandEntry& program, const std::string& version) {
  std::string page =
      fmt::format(".TH FOUCAULT 1 \"\" \"foucault {}\" \"User Commands\"\n", version) +
      ".SH NAME\nfoucault \\- post\\-processing of GNSS/IMU recordings\n"
      ".SH SYNOPSIS\n" +
      synopsis(program) + ".SH DESCRIPTION\n" +
      "A recording of a GNSS receiver and an IMU (an MRPT rawlog, or what\n"
      "\\fBfoucault import\\fR makes one of) becomes position, velocity and attitude with\n"
      "their standard deviations, and a report that shows whether to believe them.\n"
      ".SH OPTIONS\n";
  for (const OptionEntry& option : program.options)
    page += ".TP\n" + names_line(option) + "\n" + roff_help(option.help);
  page += ".SH COMMANDS\n";
  const std::vector<const CommandEntry*> all = with_subcommands(program);
  for (std::size_t i = 1; i < all.size(); ++i) page += man_section(*all[i]);
  const std::size_t notes = program.notes.find_first_not_of('\n');
  return page + ".SH NOTES\n" + roff_verbatim(program.notes.substr(notes));
}

std::string bash_completion(const CommandEntry& program) {
  std::string text =
      "# Completion of foucault for bash.\n"
      "_foucault() {\n"
      "  local current=\"${COMP_WORDS[COMP_CWORD]}\" previous=\"${COMP_WORDS[COMP_CWORD - 1]}\"\n"
      "  local command=foucault commands options i\n"
      "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
      "    [[ ${COMP_WORDS[i]} == help ]] && continue\n"
      "    case \"$command ${COMP_WORDS[i]}\" in\n";
  const std::vector<const CommandEntry*> all = with_subcommands(program);
  for (std::size_t i = 1; i < all.size(); ++i)
    text += fmt::format("      '{0}') command='{0}' ;;\n", all[i]->name);
  text += "    esac\n  done\n  case \"$command\" in\n";
  for (const CommandEntry* command : all) {
    text += fmt::format("    '{}')\n      commands='{}'\n      options='{}'\n{}      ;;\n",
                        command->name, command_words(*command), option_words(*command),
                        bash_choices(*command));
  }
  return text +
         "  esac\n"
         "  [[ $current == -* ]] && commands=$options\n"
         "  COMPREPLY=($(compgen -W \"$commands\" -- \"$current\")) # none: names of files\n"
         "}\n"
         "complete -o bashdefault -o default -F _foucault foucault\n";
}

std::string zsh_completion(const CommandEntry& program) {
  std::string text = "#compdef foucault\n# Completion of foucault for zsh.\n\n";
  for (const CommandEntry* command : with_subcommands(program)) text += zsh_function(*command);
  return text + "_foucault \"$@\"\n";
}

}  // namespace foucault::app
