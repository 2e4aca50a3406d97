#include "foucault/evaluation/outage.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

constexpr int64_t kFirstFix = 1'646'881'782'300'000'000;

int64_t after_first(double seconds) { return kFirstFix + nanoseconds(seconds); }

OutageOptions paper_options() {
  OutageOptions options;
  options.first_s = 500;
  options.length_s = 60;
  options.period_s = 150;
  return options;
}

/// Index of the outage at a time after the first fix, or -1.
int64_t index_at(const OutageSchedule& schedule, double seconds) {
  const std::optional<Outage> outage = schedule.at(kFirstFix, after_first(seconds));
  return outage ? outage->index : -1;
}

TEST(OutageSchedule, Periodic) {
  const OutageSchedule schedule(paper_options(), 0);
  EXPECT_EQ(index_at(schedule, -10), -1);
  EXPECT_EQ(index_at(schedule, 0), -1);
  EXPECT_EQ(index_at(schedule, 499), -1);
  EXPECT_EQ(index_at(schedule, 500), -1);  // the last one used
  EXPECT_EQ(index_at(schedule, 500.25), 0);
  EXPECT_EQ(index_at(schedule, 560), 0);
  EXPECT_EQ(index_at(schedule, 560.25), -1);
  EXPECT_EQ(index_at(schedule, 650), -1);
  EXPECT_EQ(index_at(schedule, 651), 1);
  EXPECT_EQ(index_at(schedule, 500 + 150 * 100 + 30), 100);
}

TEST(OutageSchedule, KnowsBeginAndEnd) {
  const Outage outage = *OutageSchedule(paper_options(), 75).at(kFirstFix, after_first(730));
  EXPECT_EQ(outage.index, 1);
  EXPECT_EQ(outage.begin_ns, after_first(725));
  EXPECT_EQ(outage.end_ns, after_first(785));
}

TEST(OutageSchedule, ForgivesStampsThatAreNotRound) {
  const OutageSchedule schedule(paper_options(), 0);
  for (const double jitter : {-0.002, 0.002}) {
    EXPECT_EQ(index_at(schedule, 500 + jitter), -1);
    EXPECT_EQ(index_at(schedule, 501 + jitter), 0);
    EXPECT_EQ(index_at(schedule, 560 + jitter), 0);
    EXPECT_EQ(index_at(schedule, 561 + jitter), -1);
    EXPECT_EQ(index_at(schedule, 650 + jitter), -1);
  }
}

TEST(OutageSchedule, List) {
  OutageOptions options;
  options.length_s = 15;
  options.starts_s = {200, 100};
  const OutageSchedule schedule(options, 1);
  EXPECT_EQ(index_at(schedule, 101), -1);
  EXPECT_EQ(index_at(schedule, 102), 0);
  EXPECT_EQ(index_at(schedule, 116), 0);
  EXPECT_EQ(index_at(schedule, 117), -1);
  EXPECT_EQ(index_at(schedule, 202), 1);
  EXPECT_EQ(index_at(schedule, 350), -1);
}

TEST(OutageSchedule, NoneByDefault) { EXPECT_EQ(index_at(OutageSchedule(), 600), -1); }

TEST(OutageSchedule, OverlapIsAnError) {
  OutageOptions options = paper_options();
  options.period_s = 60;
  EXPECT_THROW(OutageSchedule(options, 0), UsageError);
  options.starts_s = {100, 130};
  EXPECT_THROW(OutageSchedule(options, 0), UsageError);
}

TEST(OutageOptions, ReadFromConfig) {
  OutageOptions options;
  load_config_text("{first_s: 85, length_s: 15, period_s: 45, shifts_s: [0]}", "c.yaml", options);
  EXPECT_EQ(options.first_s, 85);
  EXPECT_EQ(options.shifts_s.size(), 1u);
  EXPECT_THROW(load_config_text("{length_s: 0}", "c.yaml", options), UsageError);
}

class ListSource : public state::Source {
 public:
  explicit ListSource(std::vector<Measurement> measurements)
      : measurements_(std::move(measurements)) {
    mounting_.q_v_b = Eigen::Quaterniond(0, 1, 0, 0);
  }
  std::optional<Measurement> next() override {
    if (next_ == measurements_.size()) return std::nullopt;
    return measurements_[next_++];
  }
  const state::Mounting& mounting() const override { return mounting_; }
  double progress() const override {
    return static_cast<double>(next_) / static_cast<double>(measurements_.size());
  }

 private:
  std::vector<Measurement> measurements_;
  std::size_t next_ = 0;
  state::Mounting mounting_;
};

GnssFix fix_at(double seconds) {
  GnssFix fix;
  fix.t_ns = after_first(seconds);
  fix.antenna.height = seconds;
  return fix;
}

TEST(OutageSource, PutsRequestsInThePlaceOfFixes) {
  OutageOptions options;
  options.first_s = 1;
  options.length_s = 2;
  options.period_s = 5;
  std::vector<Measurement> input;
  for (int t = 0; t <= 8; ++t) {
    input.push_back(fix_at(t));
    ReferencePose pose;
    pose.t_ns = after_first(t);
    input.push_back(pose);
    ImuIncrement increment;
    increment.t_begin_ns = after_first(t - 1);
    increment.t_end_ns = after_first(t);
    input.push_back(increment);
  }
  std::vector<std::pair<int64_t, double>> withheld;
  OutageSource source(std::make_unique<ListSource>(input), OutageSchedule(options, 0),
                      [&](const Outage& outage, const GnssFix& fix) {
                        withheld.emplace_back(outage.index, fix.antenna.height);
                      });
  EXPECT_EQ(source.mounting().q_v_b.x(), 1);
  EXPECT_FALSE(source.outage_at(after_first(2)));

  std::string kinds;
  std::size_t i = 0;
  while (const std::optional<Measurement> m = source.next()) {
    EXPECT_EQ(stamp(*m), stamp(input[i++]));
    kinds += std::string("grwpi")[m->index()];
  }
  // g fix, r request, p reference, i increment: fixes at 2, 3, 7 and 8 are gone.
  EXPECT_EQ(kinds,
            "gpi"
            "gpi"
            "rpi"
            "rpi"
            "gpi"
            "gpi"
            "gpi"
            "rpi"
            "rpi");
  EXPECT_EQ(withheld, (std::vector<std::pair<int64_t, double>>{{0, 2}, {0, 3}, {1, 7}, {1, 8}}));
  EXPECT_EQ(source.progress(), 1);
  EXPECT_EQ(source.last_fix_ns(), after_first(8));
  EXPECT_EQ(source.outage_at(after_first(2.5))->index, 0);
}

}  // namespace
}  // namespace foucault::evaluation
