#pragma once

#include "mrpt_part.h"

/// Entries of the part that speaks MRPT's classes.
namespace foucault::rawlog {

std::unique_ptr<LogReading> mrpt_reading(const std::string& path, imu::SampleKind samples,
                                         const RawlogOptions& options);
std::unique_ptr<LogWriting> mrpt_writing(const std::string& path, const state::Mounting& mounting,
                                         WrittenValues values);
RawlogInfo mrpt_info(const std::string& path, const std::function<void(double)>& progress);
RecordingNotes mrpt_notes(const std::string& path);

}  // namespace foucault::rawlog
