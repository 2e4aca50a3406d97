#include "foucault/core/loaded_part.h"
#include "foucault/core/time.h"
#include "mrpt_part.h"

/// Reading and writing, by the part that speaks MRPT's classes.
namespace foucault::rawlog {
namespace {

const MrptPart& mrpt_part() {
  using Entry = decltype(&foucault_mrpt_part);
  static const Entry entry =
      foucault_mrpt_part != nullptr
          ? &foucault_mrpt_part
          : reinterpret_cast<Entry>(load_part("foucault_mrpt", "foucault_mrpt_part"));
  return *entry();
}

}  // namespace

void RawlogOptions::fields(ConfigFields& f) {
  constexpr double kLongestReorder = 1e6;
  f.text("imu_label", imu_label, {}, "sensor label of the IMU; empty: the first one");
  f.text("gnss_label", gnss_label, {},
         "sensor label of the GNSS receiver; empty: the first one with a position");
  f.text("reference_label", reference_label, {}, "sensor label of the reference trajectory");
  f.number("reorder_s", reorder_s, {0, kLongestReorder}, "records may come this late [s]");
  f.replaced("gnss_velocity", "aids.gnss_velocity (on | off), or aids.mode (none)");
}

RawlogSource::RawlogSource(const std::string& path, imu::SampleKind samples,
                           const RawlogOptions& options)
    : reading_(mrpt_part().reading(path, samples, options)) {}
RawlogSource::~RawlogSource() = default;
RawlogSource::RawlogSource(RawlogSource&&) noexcept = default;

std::optional<Measurement> RawlogSource::next() { return reading_->next(); }
const state::Mounting& RawlogSource::mounting() const { return reading_->mounting(); }
double RawlogSource::progress() const { return reading_->progress(); }
const Eigen::Vector3d& RawlogSource::lever_arm() const { return reading_->lever_arm(); }
const std::string& RawlogSource::imu_label() const { return reading_->imu_label(); }
const std::string& RawlogSource::gnss_label() const { return reading_->gnss_label(); }
const SourceCounts& RawlogSource::counts() const { return reading_->counts(); }
std::vector<state::Notice> RawlogSource::notices() const { return reading_->notices(); }
const std::optional<std::string>& RawlogSource::damage() const { return reading_->damage(); }

int64_t stamp(const Record& record) {
  return std::visit([](const auto& value) { return foucault::stamp(value); }, record);
}

RawlogWriter::RawlogWriter(const std::string& path, const state::Mounting& mounting,
                           WrittenValues values)
    : writing_(mrpt_part().writing(path, mounting, values)) {}
RawlogWriter::~RawlogWriter() = default;
RawlogWriter::RawlogWriter(RawlogWriter&&) noexcept = default;

void RawlogWriter::write(const RecordingNotes& notes) { writing_->write(notes); }
void RawlogWriter::write(const imu::ImuSample& sample) { writing_->write(sample); }
void RawlogWriter::write(const ImuIncrement& increment) { writing_->write(increment); }
void RawlogWriter::write(const GnssFix& fix) { writing_->write(fix); }
void RawlogWriter::write(const ReferencePose& pose) { writing_->write(pose); }
void RawlogWriter::write(const WheelSpeed& speed) { writing_->write(speed); }

void RawlogWriter::write(const Record& record) {
  std::visit([this](const auto& value) { writing_->write(value); }, record);
}

void RawlogWriter::write(const Measurement& measurement) {
  std::visit(
      [this](const auto& value) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(value)>, EpochRequest>) {
          writing_->write(value);
        }
      },
      measurement);
}

void RawlogWriter::finish() { writing_->finish(); }

RawlogInfo read_rawlog_info(const std::string& path, const std::function<void(double)>& progress) {
  return mrpt_part().info(path, progress);
}

void RecordingNotes::fields(ConfigFields& f) {
  f.text("lever_arm", lever_arm, {"not_told", "given", "unknown"},
         "whether the antenna's place was known when the log was made");
  f.section("imu", imu, "as section imu of the configuration");
}

RecordingNotes read_notes(const std::string& path) { return mrpt_part().notes(path); }

}  // namespace foucault::rawlog
