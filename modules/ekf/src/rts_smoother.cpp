#include "foucault/ekf/rts_smoother.h"

#include "foucault/ekf/rts.h"

namespace foucault {

std::unique_ptr<Estimator> make_rts_smoother(const ImuNoise& imu, const Layout& layout,
                                             const EkfOptions& options, Aligner aligner,
                                             const NavigationRunOptions& run_options, Sink& sink) {
  auto recorder = std::make_unique<RtsRecorder>(imu, layout, options);
  RtsRecorder& recording = *recorder;
  return std::make_unique<Smoother>(std::move(recorder), recording, std::move(aligner), run_options,
                                    sink);
}

}  // namespace foucault
