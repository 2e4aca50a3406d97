#pragma once

namespace foucault::benchmarks {

/// "rawlog": a record of a gzip-compressed rawlog to a measurement.
void register_reading();

}  // namespace foucault::benchmarks
