#include "foucault/core/config.h"

#include "foucault/alignment/alignment.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/rawlog/rawlog_source.h"
#include "fuzzing.h"

namespace foucault::fuzz {
namespace {

/// One field of every kind.
class EveryKind : public Configurable {
 public:
  double number = 1;
  std::optional<double> optional_number;
  int64_t integer = 2;
  bool flag = true;
  std::string text = "text";
  std::string choice = "a";
  std::vector<double> numbers{1, 2};
  Eigen::Vector3d vector3{1, 2, 3};
  std::vector<std::string> texts{"x"};
  std::map<std::string, std::string> text_map{{"key", "value"}};

  void fields(ConfigFields& f) override {
    f.number("number", number, {-5, 5}, "");
    f.optional_number("optional_number", optional_number, kPositive, "");
    f.integer("integer", integer, kNotNegative, "");
    f.flag("flag", flag, "");
    f.text("text", text, {}, "");
    f.text("choice", choice, {"a", "b"}, "");
    f.numbers("numbers", numbers, {}, "");
    f.vector3("vector3", vector3, "");
    f.texts("texts", texts, "");
    f.text_map("text_map", text_map, "");
  }
};

class Root : public Configurable {
 public:
  EveryKind every_kind;
  imu::ImuOptions imu;
  alignment::AlignmentOptions alignment;
  diagnosis::GnssOptions gnss;
  navigation::GapOptions gaps;
  rawlog::RawlogOptions rawlog;

  void fields(ConfigFields& f) override {
    f.section("every_kind", every_kind, "");
    f.section("imu", imu, "");
    f.section("alignment", alignment, "");
    f.section("gnss", gnss, "");
    f.section("gaps", gaps, "");
    f.section("rawlog", rawlog, "");
  }
};

void check_round_trip(Root& root) {
  const std::string dumped = dump_config(root);
  Root again;
  load_config_text(dumped, "again", again);
  require(dump_config(again) == dumped, "a configuration that is written and read");
}

}  // namespace
}  // namespace foucault::fuzz

/// A configuration file, and its first line behind --set.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  const std::string text(text_of(data, size));
  Root from_file;
  if (contained([&] { load_config_text(text, "config.yaml", from_file); })) {
    check_round_trip(from_file);
    contained([&] { from_file.imu.noise(); });
  }
  Root from_assignment;
  const std::string line = text.substr(0, text.find('\n'));
  if (contained([&] { set_config(line, from_assignment); })) check_round_trip(from_assignment);
  return 0;
}
