#include "foucault/store/shard.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>

#include "foucault/core/error.h"

namespace foucault::store {
namespace {

constexpr std::size_t kMostShards = 1'000'000;

std::optional<std::size_t> whole_number(const std::string& text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::size_t> number(const Environment& environment, const char* name) {
  const std::optional<std::string> text = environment(name);
  return text ? whole_number(*text) : std::nullopt;
}

std::optional<Shard> ranked(const Environment& environment, const char* rank, const char* size) {
  const std::optional<std::size_t> index = number(environment, rank);
  const std::optional<std::size_t> count = number(environment, size);
  if (!index || !count || *index >= *count) return std::nullopt;
  return Shard{*index, *count};
}

/// Some tasks of an array may be missing, as in `--array=3,7`: shares are only where to begin.
std::optional<Shard> slurm_array(const Environment& environment) {
  const auto id = number(environment, "SLURM_ARRAY_TASK_ID");
  const auto count = number(environment, "SLURM_ARRAY_TASK_COUNT");
  if (!id || !count || *count == 0) return std::nullopt;
  const std::size_t first = number(environment, "SLURM_ARRAY_TASK_MIN").value_or(0);
  const std::size_t step = number(environment, "SLURM_ARRAY_TASK_STEP").value_or(1);
  if (*id < first || step == 0) return std::nullopt;
  return Shard{(*id - first) / step % *count, *count};
}

/// The tasks of srun; the script of a batch job is no task, though it is told their number.
std::optional<Shard> slurm_step(const Environment& environment) {
  if (!number(environment, "SLURM_STEP_ID")) return std::nullopt;
  return ranked(environment, "SLURM_PROCID", "SLURM_STEP_NUM_TASKS");
}

std::optional<Shard> of_array(const Environment& environment) {
  if (const auto shard = slurm_array(environment)) return shard;
  return ranked(environment, "AWS_BATCH_JOB_ARRAY_INDEX", "AWS_BATCH_JOB_ARRAY_SIZE");
}

std::optional<Shard> of_ranks(const Environment& environment) {
  if (const auto shard = ranked(environment, "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE")) {
    return shard;
  }
  if (const auto shard = ranked(environment, "PMI_RANK", "PMI_SIZE")) return shard;
  return slurm_step(environment);
}

Shard automatic(const Environment& environment) {
  const std::optional<Shard> array = of_array(environment);
  const std::optional<Shard> rank = of_ranks(environment);
  if (array && rank) {
    return {array->index * rank->count + rank->index, array->count * rank->count};
  }
  if (array) return *array;
  if (rank) return *rank;
  throw UsageError(
      "--shard auto: no Slurm array, MPI, srun or AWS array has started this; give --shard i/n, or "
      "--shard auto/n where the engine tells only the index");
}

Shard automatic_of(std::size_t count, const Environment& environment) {
  for (const char* name : {"JOB_COMPLETION_INDEX", "AWS_BATCH_JOB_ARRAY_INDEX",
                           "SLURM_ARRAY_TASK_ID", "OMPI_COMM_WORLD_RANK", "PMI_RANK"}) {
    if (const auto index = number(environment, name)) return {*index % count, count};
  }
  throw UsageError(fmt::format(
      "--shard auto/{}: nothing tells the index (JOB_COMPLETION_INDEX, AWS_BATCH_JOB_ARRAY_INDEX, "
      "SLURM_ARRAY_TASK_ID, OMPI_COMM_WORLD_RANK, PMI_RANK); give --shard i/{}",
      count, count));
}

}  // namespace

Environment process_environment() {
  return [](const std::string& name) -> std::optional<std::string> {
    const char* value = std::getenv(name.c_str());
    if (value == nullptr) return std::nullopt;
    return std::string(value);
  };
}

Shard parse_shard(const std::string& text, const Environment& environment) {
  if (text == "auto") return automatic(environment);
  const std::size_t slash = text.find('/');
  const std::string index_text = text.substr(0, slash);
  const std::optional<std::size_t> count =
      slash == std::string::npos ? std::nullopt : whole_number(text.substr(slash + 1));
  if (count && *count > 0 && *count <= kMostShards) {
    if (index_text == "auto") return automatic_of(*count, environment);
    const std::optional<std::size_t> index = whole_number(index_text);
    if (index && *index >= 1 && *index <= *count) return {*index - 1, *count};
  }
  throw UsageError(
      fmt::format("--shard '{}': give i/n, such as 1/8 to 8/8, auto, or auto/n", text));
}

}  // namespace foucault::store
