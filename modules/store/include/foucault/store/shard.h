#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace foucault::store {

/// A share of the work: number `index`, from 0, of `count` equal ones.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  /// First and one behind the last of `size` things.
  std::pair<std::size_t, std::size_t> range(std::size_t size) const {
    return {size * index / count, size * (index + 1) / count};
  }
};

/// A variable of the environment.
using Environment = std::function<std::optional<std::string>(const std::string& name)>;
Environment process_environment();

/// `3/8`: the third of eight. `auto`: as the engine says that started this process: a Slurm array,
/// Open MPI, PMI (MPICH, Intel MPI), tasks of srun, AWS Batch arrays; ranks of an engine inside of
/// an array are shares of its shares. `auto/8`: the index from the engine, for those that do not
/// tell how many there are (Kubernetes). Throws UsageError.
Shard parse_shard(const std::string& text, const Environment& environment);

}  // namespace foucault::store
