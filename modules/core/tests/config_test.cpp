#include "foucault/core/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>

#include "foucault/core/error.h"

namespace foucault {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class Window : public Configurable {
 public:
  double window_s = 20;
  std::optional<double> bias_tau_s;
  std::string robust = "none";

  void fields(ConfigFields& f) override {
    f.number("window_s", window_s, {0.1, 600}, "length of the window");
    f.optional_number("bias_tau_s", bias_tau_s, kPositive, "correlation time");
    f.text("robust", robust, {"none", "huber"}, "robust loss");
  }
};

class Everything : public Configurable {
 public:
  double number = 0.1;
  int64_t jobs = 2;
  bool enabled = true;
  std::string label = "REFERENCE";
  std::vector<double> shifts_s{0, 75};
  Eigen::Vector3d lever_arm = Eigen::Vector3d(0.1, -2, 1e-3);
  std::vector<std::string> methods{"ekf", "refined"};
  std::map<std::string, std::string> columns{{"time", "t [s]"}};
  Window fgo;

  void fields(ConfigFields& f) override {
    f.number("number", number, {}, "any number");
    f.integer("jobs", jobs, {1, 64}, "threads");
    f.flag("enabled", enabled, "whether");
    f.text("label", label, {}, "name of the sensor");
    f.numbers("shifts_s", shifts_s, kNotNegative, "shifts");
    f.vector3("lever_arm", lever_arm, "forward, right, down [m]");
    f.texts("methods", methods, "which to run");
    f.text_map("columns", columns, "names of columns");
    f.section("fgo", fgo, "factor graph");
  }
};

std::string load_error(const std::string& yaml) {
  Everything target;
  try {
    load_config_text(yaml, "trip.yaml", target);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "no error";
}

std::string set_error(const std::string& assignment) {
  Everything target;
  try {
    set_config(assignment, target);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "no error";
}

void expect_same_bits(double a, double b) {
  EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << a << " " << b;
}

void expect_equal(const Everything& a, const Everything& b) {
  expect_same_bits(a.number, b.number);
  EXPECT_EQ(a.jobs, b.jobs);
  EXPECT_EQ(a.enabled, b.enabled);
  EXPECT_EQ(a.label, b.label);
  ASSERT_EQ(a.shifts_s.size(), b.shifts_s.size());
  for (std::size_t i = 0; i < a.shifts_s.size(); ++i)
    expect_same_bits(a.shifts_s[i], b.shifts_s[i]);
  for (int i = 0; i < 3; ++i) expect_same_bits(a.lever_arm[i], b.lever_arm[i]);
  EXPECT_EQ(a.methods, b.methods);
  EXPECT_EQ(a.columns, b.columns);
  expect_same_bits(a.fgo.window_s, b.fgo.window_s);
  ASSERT_EQ(a.fgo.bias_tau_s.has_value(), b.fgo.bias_tau_s.has_value());
  if (a.fgo.bias_tau_s) expect_same_bits(*a.fgo.bias_tau_s, *b.fgo.bias_tau_s);
  EXPECT_EQ(a.fgo.robust, b.fgo.robust);
}

void expect_round_trip(Everything& config) {
  const std::string yaml = dump_config(config);
  SCOPED_TRACE(yaml);
  Everything back;
  load_config_text(yaml, "dump", back);
  expect_equal(back, config);
}

TEST(Config, ReadsEveryKindOfField) {
  Everything c;
  load_config_text(R"(
number: 1e-3
jobs: 8
enabled: false
label: "a: b"
shifts_s: [0, 37.5, 75]
lever_arm: [1, -2.5, 3]
methods: [rough]
columns: {time: stamp, gx: "w x"}
fgo:
  window_s: 30
  bias_tau_s: 3600
  robust: huber
)",
                   "trip.yaml", c);
  EXPECT_EQ(c.number, 1e-3);
  EXPECT_EQ(c.jobs, 8);
  EXPECT_FALSE(c.enabled);
  EXPECT_EQ(c.label, "a: b");
  EXPECT_THAT(c.shifts_s, testing::ElementsAre(0, 37.5, 75));
  EXPECT_EQ(c.lever_arm, Eigen::Vector3d(1, -2.5, 3));
  EXPECT_THAT(c.methods, testing::ElementsAre("rough"));
  EXPECT_THAT(c.columns,
              testing::ElementsAre(testing::Pair("gx", "w x"), testing::Pair("time", "stamp")));
  EXPECT_EQ(c.fgo.window_s, 30);
  EXPECT_EQ(c.fgo.bias_tau_s, 3600);
  EXPECT_EQ(c.fgo.robust, "huber");
}

TEST(Config, AbsentKeysKeepTheirValues) {
  Everything c;
  c.fgo.bias_tau_s = 100;
  load_config_text("fgo: {window_s: 5}", "trip.yaml", c);
  EXPECT_EQ(c.fgo.window_s, 5);
  EXPECT_EQ(c.fgo.bias_tau_s, 100);
  EXPECT_EQ(c.jobs, 2);
}

TEST(Config, EmptyInputChangesNothing) {
  for (const char* yaml : {"", "# only a comment\n", "fgo:\n"}) {
    Everything c;
    load_config_text(yaml, "trip.yaml", c);
    expect_equal(c, Everything());
  }
}

TEST(Config, NullClearsAnOptional) {
  Everything c;
  c.fgo.bias_tau_s = 100;
  load_config_text("fgo: {bias_tau_s: null}", "trip.yaml", c);
  EXPECT_FALSE(c.fgo.bias_tau_s);
  c.fgo.bias_tau_s = 100;
  set_config("fgo.bias_tau_s=null", c);
  EXPECT_FALSE(c.fgo.bias_tau_s);
}

TEST(Config, RoundTripsItsDefaults) {
  Everything c;
  expect_round_trip(c);
}

TEST(Config, RoundTripsEveryBitOfNumbers) {
  std::mt19937_64 rng{42};
  const auto any_finite = [&rng] {
    double value = 0;
    do {
      const uint64_t bits = rng();
      std::memcpy(&value, &bits, sizeof value);
    } while (!std::isfinite(value));
    return value;
  };
  for (int i = 0; i < 300; ++i) {
    Everything c;
    c.number = any_finite();
    c.lever_arm = {any_finite(), -0.0, 5e-324};
    c.shifts_s = {std::abs(any_finite()), 1.0 / 3, 1e22};
    c.fgo.bias_tau_s = 1e-300 + std::abs(any_finite());
    c.jobs = 64;
    expect_round_trip(c);
  }
}

TEST(Config, RoundTripsTextsThatLookLikeYaml) {
  for (const char* text : {"",
                           " ",
                           "a: b",
                           "# not a comment",
                           "- x",
                           "[1, 2]",
                           "{a: b}",
                           "'",
                           "\"",
                           "\\",
                           "null",
                           "~",
                           "true",
                           "no",
                           "20",
                           "1e-3",
                           ".inf",
                           "&a",
                           "*a",
                           "!tag",
                           "%",
                           "@",
                           "`",
                           "|",
                           ">",
                           "---",
                           "?",
                           "tab\there",
                           "line\nbreak",
                           "trailing ",
                           "Zürich ☃",
                           "C:\\logs\\trip.rawlog",
                           "a\r\nb"}) {
    Everything c;
    c.label = text;
    c.methods = {text, "plain"};
    c.columns = {{"key", text}};
    if (*text) c.columns[text] = "value";
    expect_round_trip(c);
  }
}

TEST(Config, RoundTripsEmptyContainers) {
  Everything c;
  c.shifts_s.clear();
  c.methods.clear();
  c.columns.clear();
  c.columns.emplace("", "empty key");
  expect_round_trip(c);
  c.columns.clear();
  expect_round_trip(c);
}

TEST(Config, UnknownKeyNamesPlaceAndNearest) {
  EXPECT_EQ(load_error("jobs: 1\nfgo:\n  windw_s: 3\n"),
            "trip.yaml:3: fgo.windw_s: is not a key; did you mean fgo.window_s?");
  EXPECT_EQ(load_error("enabeld: true"),
            "trip.yaml:1: enabeld: is not a key; did you mean enabled?");
  // The right name in the wrong section.
  EXPECT_EQ(load_error("window_s: 3"),
            "trip.yaml:1: window_s: is not a key; did you mean fgo.window_s?");
  EXPECT_EQ(load_error("fog: {window_s: 3}"), "trip.yaml:1: fog: is not a key; did you mean fgo?");
}

/// A file that is no configuration at all: an answer at once, and of a length that can be read.
TEST(Config, UnknownKeyOfAMegabyte) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string error = load_error("fgo:\n  ? " + std::string(1 << 20, 'w') + "\n  : 3\n");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_LT(error.size(), 200u) << error.substr(0, 200);
  EXPECT_EQ(error.rfind("trip.yaml:2: fgo.www", 0), 0u) << error.substr(0, 200);
}

TEST(Config, DuplicateKey) {
  EXPECT_EQ(load_error("fgo:\n  window_s: 3\n  robust: none\n  window_s: 3\n"),
            "trip.yaml:4: fgo.window_s: is given twice, first in line 2; remove one");
  EXPECT_THAT(load_error("columns: {a: b, a: c}"), HasSubstr("columns.a: is given twice"));
}

TEST(Config, WrongTypes) {
  EXPECT_EQ(load_error("\nnumber: fast"), "trip.yaml:2: number: expects a number, got 'fast'");
  EXPECT_EQ(load_error("number: \"20\""),
            "trip.yaml:1: number: expects a number, got the text '20'");
  EXPECT_EQ(load_error("number:"), "trip.yaml:1: number: expects a number, got nothing");
  EXPECT_EQ(load_error("number: 20 s"), "trip.yaml:1: number: expects a number, got '20 s'");
  EXPECT_EQ(load_error("number: [1]"), "trip.yaml:1: number: expects a number, got a list");
  EXPECT_EQ(load_error("jobs: 1.5"), "trip.yaml:1: jobs: expects a whole number, got '1.5'");
  EXPECT_EQ(load_error("enabled: 2"), "trip.yaml:1: enabled: expects true or false, got '2'");
  EXPECT_EQ(load_error("label: {a: b}"), "trip.yaml:1: label: expects a text, got a map");
  EXPECT_EQ(load_error("label:"), "trip.yaml:1: label: expects a text, got nothing");
  EXPECT_EQ(load_error("shifts_s: 3"),
            "trip.yaml:1: shifts_s: expects a list of numbers such as [0, 75], got '3'");
  EXPECT_EQ(load_error("shifts_s:\n- 3\n- x\n"),
            "trip.yaml:3: shifts_s: expects a number, got 'x'");
  EXPECT_THAT(load_error("lever_arm: [1, 2]"), HasSubstr("lever_arm: expects a list of three"));
  EXPECT_THAT(load_error("methods: ekf"), HasSubstr("methods: expects a list of texts"));
  EXPECT_THAT(load_error("columns: time"), HasSubstr("columns: expects a map"));
  EXPECT_EQ(load_error("columns: {a: [b]}"), "trip.yaml:1: columns.a: expects a text, got a list");
  EXPECT_EQ(load_error("fgo: 3"), "trip.yaml:1: fgo: expects keys with values, got '3'");
  EXPECT_EQ(load_error("- 3"), "trip.yaml:1: expects keys with values, got a list");
}

TEST(Config, OutOfRange) {
  EXPECT_EQ(load_error("fgo: {window_s: 0}"),
            "trip.yaml:1: fgo.window_s: must be in [0.1, 600], is 0");
  EXPECT_EQ(load_error("fgo: {bias_tau_s: 0}"),
            "trip.yaml:1: fgo.bias_tau_s: must be more than 0, is 0");
  EXPECT_EQ(load_error("shifts_s: [1, -1]"), "trip.yaml:1: shifts_s: must be at least 0, is -1");
  EXPECT_EQ(load_error("jobs: 65"), "trip.yaml:1: jobs: must be in [1, 64], is 65");
  EXPECT_THAT(load_error("jobs: 99999999999999999999"), HasSubstr("jobs: "));
  EXPECT_EQ(load_error("fgo: {robust: cauchy}"),
            "trip.yaml:1: fgo.robust: expects one of none, huber, got 'cauchy'");
}

TEST(Config, NotFinite) {
  for (const char* text : {"nan", "inf", "-inf", ".nan", ".inf", "-.inf", "1e999", "-1e999"}) {
    EXPECT_THAT(load_error(std::string("number: ") + text),
                AllOf(StartsWith("trip.yaml:1: number: "), HasSubstr("finite")))
        << text;
  }
}

TEST(Config, BrokenYamlNamesTheLine) {
  EXPECT_THAT(load_error("jobs: 1\nfgo: {window_s: 3\n"), StartsWith("trip.yaml:"));
  EXPECT_THAT(load_error("jobs: 1\nfgo: {window_s: 3\n"), HasSubstr("is not YAML"));
  EXPECT_THAT(load_error("a: b: c"), HasSubstr("trip.yaml:1: is not YAML"));
  EXPECT_THAT(load_error("jobs: 1\n---\njobs: 2\n"), HasSubstr("more than one"));
}

TEST(Config, MissingFileIsBadData) {
  Everything c;
  try {
    load_config("no/such/file.yaml", c);
    FAIL();
  } catch (const DataError& e) {
    EXPECT_THAT(e.what(), AllOf(StartsWith("no/such/file.yaml: "), HasSubstr("No such file")));
  }
  EXPECT_THROW(load_config(testing::TempDir(), c), DataError);
}

TEST(Config, LoadsAFile) {
  const std::string path = testing::TempDir() + "foucault_config_test.yaml";
  std::ofstream(path) << "\xEF\xBB\xBFjobs: 3\r\nfgo:\r\n  window_s: 7\r\n";
  Everything c;
  load_config(path, c);
  std::remove(path.c_str());
  EXPECT_EQ(c.jobs, 3);
  EXPECT_EQ(c.fgo.window_s, 7);
}

TEST(Config, SetAssignsOneValue) {
  Everything c;
  set_config("fgo.window_s=2.5e1", c);
  set_config("jobs = +4", c);
  set_config("shifts_s=[1, 2.5]", c);
  set_config("lever_arm=[1,2,3]", c);
  set_config("methods=[ekf]", c);
  set_config("columns.gx=w_x", c);
  set_config("enabled=false", c);
  EXPECT_EQ(c.fgo.window_s, 25);
  EXPECT_EQ(c.jobs, 4);
  EXPECT_THAT(c.shifts_s, testing::ElementsAre(1, 2.5));
  EXPECT_EQ(c.lever_arm, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(c.methods, testing::ElementsAre("ekf"));
  EXPECT_EQ(c.columns.size(), 2u);  // the other one stays
  EXPECT_EQ(c.columns["gx"], "w_x");
  EXPECT_FALSE(c.enabled);
}

TEST(Config, SetTakesTextAsItStands) {
  Everything c;
  for (const char* text : {"a: b", "#1", "x=y", "- z", "C:\\x", "null"}) {
    set_config(std::string("label=") + text, c);
    EXPECT_EQ(c.label, text);
  }
  set_config("label=\"\"", c);
  EXPECT_EQ(c.label, "");
  set_config("label='it''s'", c);
  EXPECT_EQ(c.label, "it's");
}

TEST(Config, SetErrorsNameTheOption) {
  EXPECT_EQ(set_error("fgo.windw_s=3"),
            "--set fgo.windw_s=3: fgo.windw_s: is not a key; did you mean fgo.window_s?");
  EXPECT_EQ(set_error("fgo.window_s=0"),
            "--set fgo.window_s=0: fgo.window_s: must be in [0.1, 600], is 0");
  EXPECT_EQ(set_error("fgo=3"), "--set fgo=3: fgo: expects keys with values, got '3'");
  EXPECT_EQ(set_error("jobs.x=3"), "--set jobs.x=3: jobs: expects a whole number, got a map");
  EXPECT_THAT(set_error("fgo.window_s"), HasSubstr("expects key=value"));
  EXPECT_THAT(set_error("=3"), HasSubstr("expects key=value"));
  EXPECT_THAT(set_error("jobs="), HasSubstr("no value"));
  EXPECT_THAT(set_error("number=nan"), HasSubstr("finite"));
  EXPECT_THAT(set_error("shifts_s=[1"), HasSubstr("is not YAML"));
}

/// yaml-cpp's own loader of several documents never ends with this.
TEST(Config, SomethingBehindTheFirstDocument) {
  for (const char* yaml : {"number: 1\n---\nnumber: 2\n", "{number: 1}\n, x\n", "[1]\n2\n"}) {
    Everything c;
    try {
      load_config_text(yaml, "a.yaml", c);
      ADD_FAILURE() << yaml;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("a.yaml"));
    }
  }
}

TEST(Config, MessagesAreOneLineWhateverTheyQuote) {
  Everything c;
  try {
    load_config_text("jobs: \"a\\nb\\x01\"\n", "a.yaml", c);
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "a.yaml:1: jobs: expects a whole number, got the text 'a b '");
  }
}

/// A dump writes what is no character of Unicode as U+FFFD: it would not read as what it was.
TEST(Config, TextsAreUtf8) {
  EXPECT_THAT(load_error("label: d\xe4ten.csv"), StartsWith("trip.yaml:1: label: is not UTF-8"));
  EXPECT_THAT(load_error("columns: {\xe1: 1, \xe0\xa5: two}"), HasSubstr("is not UTF-8"));
  for (const char* wrong : {"\x80", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                            "\xf5\x80\x80\x80", "\xe2\x82", "\xff"}) {
    EXPECT_THAT(load_error(std::string("label: \"") + wrong + "\""), HasSubstr("UTF-8"));
  }
  EXPECT_EQ(load_error("label: \"d\xc3\xa4ten \xe2\x82\xac \xf0\x9f\x9a\x97\""), "no error");
}

TEST(Config, DumpIsReadable) {
  Everything c;
  EXPECT_EQ(dump_config(c),
            "number: 0.1\n"
            "jobs: 2\n"
            "enabled: true\n"
            "label: \"REFERENCE\"\n"
            "shifts_s: [0, 75]\n"
            "lever_arm: [0.1, -2, 0.001]\n"
            "methods: [\"ekf\", refined]\n"
            "columns:\n"
            "  time: \"t [s]\"\n"
            "fgo:\n"
            "  window_s: 20\n"
            "  robust: none\n");
}

TEST(Config, DescribeAlignsKeysDefaultsAndHelp) {
  Everything c;
  const std::string table = describe_config(c);
  EXPECT_THAT(table,
              HasSubstr("fgo.window_s    20                length of the window (from 0.1 to "
                        "600)\n"));
  EXPECT_THAT(table, HasSubstr("fgo.bias_tau_s  -                 correlation time (> 0)\n"));
  EXPECT_THAT(table, HasSubstr("fgo.robust      none              robust loss (none, huber)\n"));
  EXPECT_THAT(table, HasSubstr("shifts_s        [0, 75]           shifts (>= 0)\n"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 12);
}

}  // namespace
}  // namespace foucault
