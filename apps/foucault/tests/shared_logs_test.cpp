#include "jobs/shared_logs.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_source.h"
#include "jobs/simulation_job.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

/// A log of 60 s with a reference and wheels.
class SharedLogsTest : public testing::Test {
 protected:
  SharedLogsTest() {
    Console console(true);
    SimulationSettings trip;
    trip.scenario.duration_s = 60;
    trip.scenario.wheel_rate_hz = 10;
    write_simulation(trip, log_, console);
  }

  std::unique_ptr<state::Source> open(SharedLogs& logs) {
    return logs.open(log_, settings_, remarks_);
  }

  test::TestFolder folder_;
  std::string log_ = folder_ / "trip.rawlog";
  Settings settings_;
  std::shared_ptr<evaluation::SourceRemarks> remarks_ =
      std::make_shared<evaluation::SourceRemarks>();
};

std::string described(const Measurement& measurement) {
  std::ostringstream text;
  text.precision(17);
  text << measurement.index() << ' ' << stamp(measurement);
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) {
    text << ' ' << increment->dtheta_b.transpose() << ' ' << increment->dvel_b.transpose();
  } else if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    text << ' ' << fix->antenna.latitude << ' ' << fix->position_covariance;
  } else if (const auto* speed = std::get_if<WheelSpeed>(&measurement)) {
    text << ' ' << speed->forward;
  } else if (const auto* pose = std::get_if<ReferencePose>(&measurement)) {
    text << ' ' << pose->position.latitude << ' ' << pose->q_n_v->coeffs().transpose();
  }
  return text.str();
}

std::vector<std::string> all_of(state::Source& source) {
  std::vector<std::string> all;
  while (const std::optional<Measurement> m = source.next()) all.push_back(described(*m));
  return all;
}

TEST_F(SharedLogsTest, AreReadOnceForAll) {
  rawlog::RawlogSource alone(log_, settings_.imu.sample_kind(), settings_.rawlog);
  const std::vector<std::string> expected = all_of(alone);
  ASSERT_GT(expected.size(), 12'000u);
  SharedLogs logs;
  const auto first = open(logs), second = open(logs);
  for (int i = 0; i < 7000; ++i) EXPECT_EQ(described(*first->next()), expected[i]);
  EXPECT_EQ(all_of(*second), expected);
  EXPECT_EQ(second->progress(), 1);
  EXPECT_EQ(all_of(*first).size(), expected.size() - 7000);
  std::filesystem::remove(log_);
  EXPECT_EQ(all_of(*open(logs)), expected);
}

TEST_F(SharedLogsTest, ThatAreTooLongAreReadAgain) {
  SharedLogs logs(1000);
  EXPECT_EQ(all_of(*open(logs)), all_of(*open(logs)));
  std::filesystem::remove(log_);
  EXPECT_THROW(open(logs), DataError);
}

TEST_F(SharedLogsTest, OtherSettingsAreAnotherReading) {
  SharedLogs logs;
  const std::vector<std::string> all = all_of(*open(logs));
  settings_.rawlog.fix_delay_s = 0.1;
  EXPECT_NE(all_of(*open(logs)), all);
}

TEST_F(SharedLogsTest, SayWhereTheyBreakOffToEveryone) {
  std::filesystem::resize_file(log_, std::filesystem::file_size(log_) * 2 / 3);
  SharedLogs logs;
  for (int i = 0; i < 2; ++i) {
    *remarks_ = {};
    all_of(*open(logs));
    ASSERT_TRUE(remarks_->damage);
    EXPECT_THAT(*remarks_->damage, testing::HasSubstr("is truncated"));
  }
}

}  // namespace
}  // namespace foucault::app
